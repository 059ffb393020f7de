#include "experiments/mesh_family.h"

#include <fmt/format.h>

#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>
#include <OpenMesh/Tools/Decimater/DecimaterT.hh>
#include <OpenMesh/Tools/Decimater/ModNormalFlippingT.hh>
#include <OpenMesh/Tools/Decimater/ModQuadricT.hh>
#include <OpenMesh/Tools/Decimater/Observer.hh>

#include "harness/base/error.h"
#include "harness/base/progress.h"

namespace touchstone::experiments {
using surface::TriangleMesh;

namespace {

struct Traits : OpenMesh::DefaultTraits {
  using Point = OpenMesh::Vec3d;
  using Normal = OpenMesh::Vec3d;
};
using Mesh = OpenMesh::TriMesh_ArrayKernelT<Traits>;

// By how much a triangle may turn in one collapse.
constexpr float largest_turn_deg = 30.0F;

// Seconds of a fine mesh are thousands of collapses.
class StopsIfAsked final : public OpenMesh::Decimater::Observer {
 public:
  StopsIfAsked() : Observer(1000) {}
  void notify(std::size_t /*collapses*/) override { stop_if_asked(); }
};

Mesh to_open_mesh(const TriangleMesh& mesh) {
  Mesh result;
  std::vector<Mesh::VertexHandle> handles;
  for (const Vec3& v : mesh.vertices_W_m) handles.push_back(result.add_vertex({v.x(), v.y(), v.z()}));
  for (const auto& [a, b, c] : mesh.triangles) {
    result.add_face(handles[static_cast<std::size_t>(a)], handles[static_cast<std::size_t>(b)],
                    handles[static_cast<std::size_t>(c)]);
  }
  // Kept beyond the decimater's life, for removing what it deletes.
  result.request_vertex_status();
  result.request_halfedge_status();
  result.request_edge_status();
  result.request_face_status();
  result.request_face_normals();
  result.update_face_normals();
  return result;
}

TriangleMesh from_open_mesh(Mesh mesh, const std::string& source) {
  mesh.garbage_collection();
  TriangleMesh result;
  result.source = fmt::format("{}, decimated to {} triangles", source, mesh.n_faces());
  for (const auto v : mesh.vertices()) {
    const auto& p = mesh.point(v);
    result.vertices_W_m.emplace_back(p[0], p[1], p[2]);
  }
  for (const auto f : mesh.faces()) {
    std::array<std::int32_t, 3> corners{};
    std::size_t i = 0;
    for (const auto v : mesh.fv_range(f)) corners[i++] = v.idx();
    result.triangles.push_back(corners);
  }
  return result;
}

}  // namespace

std::vector<TriangleMesh> decimated_family(const TriangleMesh& fine, const std::vector<std::size_t>& targets) {
  std::vector<TriangleMesh> family;
  for (const std::size_t target : targets) {
    Mesh mesh = to_open_mesh(fine);
    if (target < fine.triangle_count()) {
      OpenMesh::Decimater::DecimaterT<Mesh> decimater(mesh);
      OpenMesh::Decimater::ModQuadricT<Mesh>::Handle quadric;
      decimater.add(quadric);
      decimater.module(quadric).unset_max_err();
      // Without it a collapse may turn triangles over: a fold, into whose neck a proxy falls and stays.
      OpenMesh::Decimater::ModNormalFlippingT<Mesh>::Handle no_folds;
      decimater.add(no_folds);
      decimater.module(no_folds).set_max_normal_deviation(largest_turn_deg);
      StopsIfAsked stops_if_asked;
      decimater.set_observer(&stops_if_asked);
      decimater.initialize();
      decimater.decimate_to_faces(0, target);
    }
    family.push_back(from_open_mesh(std::move(mesh), fine.source));
    if (family.back().triangle_count() > target + 1) {
      throw BadData(fmt::format("{}: cannot be decimated to {} triangles, it stops at {}", fine.source, target,
                                family.back().triangle_count()));
    }
  }
  return family;
}

}  // namespace touchstone::experiments
