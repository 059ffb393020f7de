#include "harness/rendering/fuzz/read_structured_model.h"

#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <string>

#include "harness/base/atomic_file.h"
#include "harness/base/error.h"
#include "harness/rendering/model.h"
#include "harness/rendering/scene_file.h"
#include "harness/testing/damaged_json.h"

namespace touchstone::rendering::fuzz {
namespace {

const nlohmann::json& model_file() {
  static const auto json = nlohmann::json::parse(R"({"schema": "touchstone-model/1", "renderer": "god-object",
    "parameters": {"stiffness_N_per_m": 500, "damping_N_s_per_m": 2},
    "effects": [{"name": "coulomb-friction", "parameters": {"mu_static": 0.3, "mu_dynamic": 0.2}},
                {"name": "stiffness-field", "parameters": {"x_low_m": 0, "x_high_m": 1, "columns": 4, "rows": 4, "c_00_00": 0.1}}],
    "instrument": [{"name": "time-lag", "parameters": {"lag_s": 0.01}}]})");
  return json;
}

const nlohmann::json& scene_file() {
  static const auto json = nlohmann::json::parse(R"({"schema": "touchstone-scene/1", "bodies": [
    {"name": "floor", "mesh": "tetrahedron.obj"},
    {"name": "block", "mesh": "tetrahedron.obj", "unit": "mm", "two_sided": true,
     "pose": {"p_m": [0.1, 0, 0], "q_wxyz": [1, 0, 0, 0]}},
    {"name": "belt", "mesh": "tetrahedron.obj", "poses": "belt.csv"},
    {"name": "wall", "mesh": "tetrahedron.obj", "keyframes": [
     {"t_s": 0, "p_m": [0.2, 0, 0]}, {"t_s": 2, "p_m": [0.1, 0, 0], "q_wxyz": [1, 0, 0, 0]}]}]})");
  return json;
}

// The files that the scene names, written once by each process.
const std::filesystem::path& folder_of_scene() {
  static const std::filesystem::path folder = [] {
    const auto made = std::filesystem::temp_directory_path() / ("touchstone-fuzz-scene-" + std::to_string(::getpid()));
    std::filesystem::create_directories(made);
    write_file(made / "tetrahedron.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n");
    write_file(made / "belt.csv",
               "t_s,x_m,y_m,z_m,qw,qx,qy,qz\n0,0,0,0,1,0,0,0\n1,0.1,0,0,1,0,0,0\n2,0.2,0,0,1,0,0,0\n");
    std::atexit([] {
      std::error_code ignored;
      std::filesystem::remove_all(folder_of_scene(), ignored);
    });
    return made;
  }();
  return folder;
}

bool reads_model(const std::string& text) {
  try {
    const Model model = parse_model(text, "fuzz");
    const std::string again = model_to_json(model);
    if (model_to_json(parse_model(again, "fuzz, written again")) != again) std::abort();
    return true;
  } catch (const BadData&) {
    return false;
  }
}

bool reads_scene(const std::string& text) {
  try {
    const SceneFile scene = parse_scene(text, "fuzz", folder_of_scene(), SceneFiles::own_folder);
    if (scene.bodies.empty()) std::abort();
    return true;
  } catch (const BadData&) {
    return false;
  }
}

}  // namespace

Read read_structured_model(const std::uint8_t* data, std::size_t size) {
  testing::Choices choices({data, size});
  const bool scene = choices.below(2) == 1;
  if (size == 0) return {reads_model(testing::as_text(model_file())), reads_scene(testing::as_text(scene_file()))};
  const std::string text = testing::as_text(testing::damaged_json(scene ? scene_file() : model_file(), choices));
  return scene ? Read{false, reads_scene(text)} : Read{reads_model(text), false};
}

}  // namespace touchstone::rendering::fuzz
