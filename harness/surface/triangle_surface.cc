#include "harness/surface/triangle_surface.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>

#include "harness/base/error.h"
#include "harness/base/huge_pages.h"
#include "harness/base/in_parallel.h"
#include "harness/surface/mesh_file.h"

namespace touchstone::surface {
namespace {

const TriangleMesh& checked(const TriangleMesh& mesh) {
  if (mesh.triangles.empty())
    throw BadData(fmt::format("{}: has no triangles; a surface needs at least one", mesh.source));
  const auto count = static_cast<std::int32_t>(mesh.vertices_W_m.size());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    for (const std::int32_t corner : mesh.triangles[t]) {
      if (corner < 0 || corner >= count)
        throw BadData(fmt::format("{}: triangle {}: the vertex index {} is out of range: there are {} vertices",
                                  mesh.source, t, corner, count));
      if (!mesh.vertices_W_m[static_cast<std::size_t>(corner)].allFinite())
        throw BadData(fmt::format("{}: triangle {}: vertex {} is not finite", mesh.source, t, corner));
    }
  }
  return mesh;
}

}  // namespace

TriangleSurface::TriangleSurface(const TriangleMesh& mesh, const std::function<void(const TriangleMesh&)>& beside)
    : mesh_(weld_coincident_vertices(checked(mesh))) {
  for (const auto& triangle : mesh_.triangles) {
    for (const std::int32_t corner : triangle) bounds_.extend(mesh_.vertices_W_m[static_cast<std::size_t>(corner)]);
  }
  if (!(bounds_.sizes().maxCoeff() > 0.0))
    throw BadData(fmt::format("{}: all triangles lie in one point", mesh.source));
  // Half of making topology waits for no other thread's help: time for whatever else is to be made.
  in_parallel(
      2,
      [&](std::size_t which) {
        if (which == 1 && beside) beside(mesh_);
        if (which != 0) return;
        topology_ = make_topology(mesh_);
        make_facets();
      },
      1);
}

void TriangleSurface::make_facets() {
  reserve_in_huge_pages(facets_, mesh_.triangles.size());
  facets_.resize(mesh_.triangles.size());
  in_parallel(facets_.size(), [&](std::size_t t) {
    Facet& facet = facets_[t];
    for (std::size_t i = 0; i < 3; ++i)
      facet.corners[i] = mesh_.vertices_W_m[static_cast<std::size_t>(mesh_.triangles[t][i])];
    facet.normal = topology_.face_normals[t];
  });
}

SurfacePoint TriangleSurface::finish(const Vec3& q, std::int32_t triangle, const TriangleClosest& closest) const {
  const auto t = static_cast<std::size_t>(triangle);
  SurfacePoint point;
  point.p_W_m = q + closest.from_query;
  point.triangle = triangle;
  point.feature = closest.feature;
  switch (closest.feature) {
    case Feature::vertex:
      point.n_W = topology_.vertex_normals[static_cast<std::size_t>(mesh_.triangles[t][closest.index])];
      point.p_W_m = mesh_.vertices_W_m[static_cast<std::size_t>(mesh_.triangles[t][closest.index])];
      break;
    case Feature::edge:
      point.n_W = topology_.edge_normal(t, closest.index);
      break;
    default:
      point.n_W = topology_.face_normals[t];
  }
  point.distance_m = std::sqrt(closest.squared_distance);
  // from_query points from q to the surface: along the normal when q is inside.
  point.signed_distance_m = closest.from_query.dot(point.n_W) > 0.0 ? -point.distance_m : point.distance_m;
  return point;
}

Crossing TriangleSurface::finish(const Vec3& a, const Vec3& b, std::int32_t triangle,
                                 const TriangleCrossing& crossing) const {
  Crossing out;
  out.fraction = crossing.fraction;
  out.p_W_m = a + crossing.fraction * (b - a);
  out.n_W = topology_.face_normals[static_cast<std::size_t>(triangle)];
  out.entering = crossing.entering;
  out.triangle = triangle;
  return out;
}

SurfacePoint TriangleSurface::no_point(const Vec3& q) {
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  return {q * nan, Vec3::Constant(nan), nan, nan, -1, Feature::face};
}

}  // namespace touchstone::surface
