// A scene file names the bodies of a scene and says where each is over time. Format: "touchstone-scene/1" (JSON).
//   {"schema": "touchstone-scene/1",
//    "bodies": [
//     {"name": "floor", "mesh": "floor.obj"},                                       at rest, B is W
//     {"name": "block", "mesh": "block.stl", "unit": "mm",
//      "pose": {"p_m": [0.1, 0, 0], "q_wxyz": [1, 0, 0, 0]}},                       at rest elsewhere
//     {"name": "belt", "mesh": "belt.obj", "poses": "belt.csv"},                    recorded poses
//     {"name": "wall", "mesh": "wall.obj", "keyframes": [
//      {"t_s": 0, "p_m": [0.2, 0, 0]}, {"t_s": 2, "p_m": [0.1, 0, 0], "q_wxyz": [1, 0, 0, 0]}]}]}
// "two_sided": true makes a sheet of a body, which stops the tip from either side; a run starts in free space then.
// Files are relative to the scene file's folder. Where q_wxyz is not given the body is not turned; it is made a unit
// quaternion. Between poses and keyframes: pose_track.h.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "harness/rendering/pose_track.h"
#include "harness/rendering/scene.h"
#include "harness/surface/triangle_mesh.h"

namespace touchstone::rendering {

// A body of the file, with its mesh read.
struct SceneFileBody {
  std::string name;
  surface::TriangleMesh mesh_B;
  PoseTrack pose;
  bool two_sided = false;
};

struct SceneFile {
  std::vector<SceneFileBody> bodies;
  std::string source;

  // Over Embree's surfaces; with both sides of every triangle of sheets, or of all bodies.
  [[nodiscard]] BodyScene scene(bool all_two_sided = false) const;
  // Every length times `scale`, the bodies' motion `speed` times as fast.
  void rescale(double scale, double speed);
};

// Whether a scene may name files outside of its own folder.
enum class SceneFiles : std::uint8_t { own_folder, anywhere };

// Throw BadData with file, place and value for anything unknown, missing or out of order: names must differ, a body has
// at most one of pose, poses and keyframes.
SceneFile load_scene(const std::filesystem::path& path);
SceneFile parse_scene(std::string_view text, std::string_view source, const std::filesystem::path& folder,
                      SceneFiles files = SceneFiles::anywhere);

}  // namespace touchstone::rendering
