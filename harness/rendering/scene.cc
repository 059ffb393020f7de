#include "harness/rendering/scene.h"

#include <fmt/format.h>

#include "harness/base/error.h"

namespace touchstone::rendering {
using surface::TriangleMesh;

TriangleMesh joined_mesh(const BodyScene& scene) {
  TriangleMesh joined;
  joined.source = scene.source;
  for (const SceneBody& body : scene.bodies) {
    if (body.surface_B->mesh() == nullptr)
      throw BadData(fmt::format("{}: the body {} has no triangles", scene.source, body.name));
    const TriangleMesh& mesh = *body.surface_B->mesh();
    const BodyPose pose = body.pose.first();
    const auto offset = static_cast<std::int32_t>(joined.vertices_W_m.size());
    for (const Vec3& v : mesh.vertices_W_m) joined.vertices_W_m.push_back(pose.to_W(v));
    for (const auto& [a, b, c] : mesh.triangles) joined.triangles.push_back({a + offset, b + offset, c + offset});
  }
  return joined;
}

}  // namespace touchstone::rendering
