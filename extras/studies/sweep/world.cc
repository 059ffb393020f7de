#include "sweep/world.h"

#include <fmt/format.h>

#include <mutex>
#include <new>
#include <nlohmann/json.hpp>

#include "harness/base/error.h"
#include "harness/base/json_reader.h"
#include "harness/golden/case_runner.h"
#include "harness/rendering/model.h"
#include "harness/rendering/replay.h"
#include "harness/surface/embree_surface.h"
#include "shared_cache.h"

namespace touchstone::sweep {
using recording::InTrajectory;
using runs::SweepCase;
using runs::SweepDesign;

namespace {

// About 400 bytes each with all structures: 1.6 gigabytes.
constexpr std::uint64_t most_triangles = 4'000'000;
// What a surface takes however small, in triangles: no more than four thousand are kept.
constexpr std::uint64_t of_a_scene = 1000;
constexpr std::uint64_t most_samples = 20'000'000;

struct SharedSurface {
  std::shared_ptr<const surface::Surface> surface;
  std::uint64_t triangles = 0;
  std::unique_ptr<const surface::Surface> exact;  // nullptr for a mesh from a file

  // The first renderer of each kind stays: with it live the structures that those after it share.
  std::unique_ptr<rendering::Renderer> make(const rendering::Catalogue& catalogue, const rendering::Model& model) {
    auto renderer = catalogue.make(model, surface);
    const std::lock_guard lock(mutex);
    if (!keepers.contains(model.renderer)) keepers.emplace(model.renderer, catalogue.make(model, surface));
    return renderer;
  }
  std::mutex mutex;
  std::map<std::string, std::unique_ptr<rendering::Renderer>> keepers;
};

}  // namespace

struct SweepWorld::State {
  State(const golden::Catalogues& known, const SweepDesign& wanted) : catalogues(known), design(&wanted) {}

  void run(SweepOutcome& outcome) {
    const SweepCase& one = outcome.one;
    const std::string source = fmt::format("case {}", one.number);
    const nlohmann::json document = parse_json(one.document, source);
    JsonObject root(document, source, "");
    const double scale = positive(root, "scale");
    const double speed = positive(root, "speed");
    // Parts that cases may share: equal text, equal structure.
    const auto text_of = [&](std::initializer_list<const char*> keys) {
      std::string text;
      for (const char* const key : keys) text += document[key].dump() + "\n";
      return text;
    };
    const auto world = surfaces.get(text_of({"surface", "scale"}), [&] { return make_surface(root, scale); });
    const auto trajectory = trajectories.get(text_of({"trajectory", "scale", "speed"}), [&] {
      return std::make_shared<InTrajectory>(golden::case_trajectory(
          catalogues.generators,
          read_case_trajectory(root.object("trajectory"), design->folder(), golden::CaseFiles::anywhere), scale,
          speed));
    });
    const rendering::Model model =
        rendering::parse_model(document["model"].dump(), source + ": /model", design->folder());
    const auto renderer = world->make(catalogues.renderers, model);
    const recording::RenderedTrajectory rendered = replay(*renderer, *trajectory);
    outcome.summary = golden::summarise(rendered);
    if (design->truth())
      outcome.exact = world->exact ? exact_error(catalogues, *world->exact, scale, model, rendered) : std::nullopt;
  }

  [[nodiscard]] std::shared_ptr<SharedSurface> make_surface(JsonObject& root, double scale) const {
    auto made = std::make_shared<SharedSurface>();
    const golden::CaseSurface wanted =
        read_case_surface(root.object("surface"), design->folder(), golden::CaseFiles::anywhere);
    made->surface = surface::make_embree_surface(golden::case_mesh(catalogues.generators, wanted, scale));
    made->triangles = made->surface->mesh()->triangle_count();
    if (!wanted.generator.empty() && design->truth())
      made->exact = catalogues.generators.surface(wanted.generator, wanted.parameters);
    return made;
  }

  static double positive(JsonObject& root, const char* key) {
    const double value = root.number(key);
    if (!(value > 0.0)) root.fail_at(key, fmt::format("a number above 0 was expected, got {}", value));
    return value;
  }

  golden::Catalogues catalogues;
  const SweepDesign* design;
  runs::SharedCache<SharedSurface> surfaces{most_triangles,
                                            [](const SharedSurface& s) { return s.triangles + of_a_scene; }};
  runs::SharedCache<InTrajectory> trajectories{most_samples, [](const InTrajectory& t) { return t.size() + 1; }};
};

runs::DesignParts sweep_parts() {
  constexpr auto files = golden::CaseFiles::anywhere;
  return {
      "touchstone-sweep/1",
      {{"surface", "surfaces", [](JsonObject one, const auto& folder) { read_case_surface(one, folder, files); }, 0},
       {"trajectory", "trajectories",
        [](JsonObject one, const auto& folder) { read_case_trajectory(one, folder, files); }, 1},
       {"model", "models",
        [](const JsonObject& model, const auto& folder) {
          rendering::parse_model(model.text_of_all(), model.source() + ": " + model.place(), folder);
        },
        2}},
      {"scale", "speed"},
      "trajectory",
      true};
}

SweepWorld::SweepWorld(const golden::Catalogues& catalogues, const SweepDesign& design)
    : state_(std::make_unique<State>(catalogues, design)) {}
SweepWorld::~SweepWorld() = default;

std::uint64_t SweepWorld::surfaces_made() const { return state_->surfaces.made(); }

SweepOutcome SweepWorld::run(std::uint64_t number) {
  SweepOutcome outcome;
  outcome.one.number = number;
  try {
    outcome.one = state_->design->at(number);
    state_->run(outcome);
  } catch (const std::bad_alloc&) {
    outcome.error = "out of memory";
  } catch (const std::exception& error) {
    outcome.error = error.what();
  }
  return outcome;
}

}  // namespace touchstone::sweep
