#include <fmt/format.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include "apps/plugin_flags.h"
#include "arrays.h"
#include "harness/recording/recording_file.h"
#include "harness/rendering/replay.h"
#include "harness/surface/embree_surface.h"
#include "harness/surface/mesh_file.h"
#include "harness/surface/mesh_repair.h"
#include "module.h"
#include "renderers/catalogue.h"

namespace touchstone::python {
using recording::Loaded;
using rendering::Model;
using surface::TriangleMesh;

namespace {

// A renderer over an object, ready for positions.
struct Bench {
  std::shared_ptr<const surface::Surface> surface;
  std::unique_ptr<rendering::Renderer> renderer;
};

// `plugins` run in this process.
Bench make_bench(Model model, const TriangleMesh& mesh, bool both_sides, const std::vector<std::string>& plugins) {
  apps::PluginFlags flags;
  flags.libraries = plugins;
  flags.in_process = true;
  const plugin::Plugins loaded = flags.load();
  loaded.provide(model);
  renderers::find_renderer(model);
  Bench bench;
  bench.surface = make_embree_surface(both_sides ? two_sided(mesh) : mesh);
  bench.renderer = renderers::make_renderer(model, bench.surface);
  return bench;
}

std::shared_ptr<Loaded<recording::RenderedTrajectory>> replay_in_memory(
    const Model& model, const TriangleMesh& mesh, const Loaded<recording::InTrajectory>& trajectory, bool time_steps,
    bool both_sides, const std::vector<std::string>& plugins) {
  return LongWork::call([&] {
    const Bench bench = make_bench(model, mesh, both_sides, plugins);
    auto out = std::make_shared<Loaded<recording::RenderedTrajectory>>();
    out->value = replay(*bench.renderer, trajectory.value, time_steps);
    return out;
  });
}

py::dict measure(const Model& model, const TriangleMesh& mesh, const Loaded<recording::InTrajectory>& trajectory,
                 bool both_sides, const std::vector<std::string>& plugins) {
  const rendering::ReplayTiming timing = LongWork::call([&] {
    const Bench bench = make_bench(model, mesh, both_sides, plugins);
    return measure_steps(*bench.renderer, [&] { return rendering::tip_source(trajectory.value.motion); });
  });
  py::dict out;
  out["steps"] = timing.steps;
  out["mean_us"] = timing.mean_us;
  out["median_us"] = timing.median_us;
  out["p99_us"] = timing.p99_us;
  out["p999_us"] = timing.p999_us;
  out["max_us"] = timing.max_us;
  return out;
}

}  // namespace

void bind_rendering(py::module_& module) {
  py::class_<Model, std::shared_ptr<Model>>(module, "Model",
                                            "A renderer with its parameters, contact effects and instrument entries: "
                                            "what a model file (touchstone-model/1) says.")
      .def_static(
          "parse",
          [](const std::string& text, const std::string& source) {
            return std::make_shared<Model>(rendering::parse_model(text, source));
          },
          py::arg("text"), py::arg("source") = "model", "The model of a model file's text (JSON).")
      .def_static(
          "load",
          [](const std::filesystem::path& path) { return std::make_shared<Model>(rendering::load_model(path)); },
          py::arg("path"), "Reads a model file.")
      .def(
          "to_json", [](const Model& self) { return model_to_json(self); }, "The text of its model file.")
      .def_readonly("renderer", &Model::renderer, "The renderer's name.")
      .def_readonly("parameters", &Model::parameters, "Those that are set; names carry their units.");
  module.def("replay", &replay_in_memory, py::arg("model"), py::arg("mesh"), py::arg("trajectory"),
             py::arg("time_steps"), py::arg("two_sided"), py::arg("plugins"));
  module.def("measure_steps", &measure, py::arg("model"), py::arg("mesh"), py::arg("trajectory"), py::arg("two_sided"),
             py::arg("plugins"));
}

}  // namespace touchstone::python
