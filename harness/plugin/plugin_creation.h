// What a plug-in's renderer is made of: the C structures of <touchstone/plugin2.h> and all that they point to. It stays
// where it is for as long as the renderer lives.
#pragma once

#include <touchstone/plugin2.h>

#include <memory>
#include <string>
#include <vector>

#include "harness/base/rooms.h"
#include "harness/plugin/plugin_description.h"
#include "harness/rendering/parameters.h"
#include "harness/surface/triangle_mesh.h"

namespace touchstone::plugin {

class PluginCreation {
 public:
  // One body, at rest with its frame that of the world. `index` is the description's.
  PluginCreation(const PluginDescription& description, std::uint32_t index, const Parameters& parameters,
                 std::shared_ptr<const TriangleMesh> object_W);
  PluginCreation(const PluginCreation&) = delete;
  PluginCreation& operator=(const PluginCreation&) = delete;

  // `tool` without its mesh, which is the other.
  void set_tool(const touchstone2_tool& tool, std::shared_ptr<const TriangleMesh> mesh_T);

  [[nodiscard]] const touchstone2_creation& creation() const noexcept { return creation_; }

 private:
  std::shared_ptr<const TriangleMesh> object_W_;
  std::string model_;
  std::vector<double> parameters_;
  touchstone2_body body_{};
  std::shared_ptr<const TriangleMesh> tool_mesh_T_;
  touchstone2_tool tool_{};
  touchstone2_creation creation_{};
};

inline constexpr touchstone2_pose kIdentityPose{{0.0, 0.0, 0.0}, {1.0, 0.0, 0.0, 0.0}};

inline void copy(const Vec3& from, double (&to)[3]) noexcept {
  for (int i = 0; i < 3; ++i) to[i] = from[i];
}
inline Vec3 vector_of(const double (&values)[3]) noexcept { return {values[0], values[1], values[2]}; }
inline touchstone2_pose pose_of(const Vec3& p_W_m, const Quat& q) noexcept {
  return {{p_W_m.x(), p_W_m.y(), p_W_m.z()}, {q.w(), q.x(), q.y(), q.z()}};
}

}  // namespace touchstone::plugin
