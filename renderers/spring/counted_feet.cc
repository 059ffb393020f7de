#include "renderers/spring/counted_feet.h"

#include "harness/base/error.h"
#include "harness/surface/closest_on_triangle.h"

namespace touchstone::renderers {
using surface::Feature;

namespace {

const surface::TriangleMesh& counted_triangles_of(const surface::Surface& surface) {
  if (surface.mesh() == nullptr)
    throw BadData("operations are counted on triangles only: an analytic surface's own arithmetic is not counted");
  return *surface.mesh();
}

}  // namespace

CountedFeet::CountedFeet(const surface::Surface& surface)
    : mesh_(std::make_shared<const surface::TriangleMesh>(counted_triangles_of(surface))),
      topology_(make_topology(*mesh_)),
      tree_(*mesh_) {
  facets_.reserve(mesh_->triangles.size());
  for (std::size_t t = 0; t < mesh_->triangles.size(); ++t) {
    Facet facet;
    for (std::size_t i = 0; i < 3; ++i)
      facet.corners[i] = mesh_->vertices_W_m[static_cast<std::size_t>(mesh_->triangles[t][i])].cast<Counted>();
    facet.normal = topology_.face_normals[t].cast<Counted>();
    facets_.push_back(facet);
  }
}

Vec3Of<Counted> CountedFeet::normal_at(std::size_t triangle, Feature feature, std::size_t index) const {
  if (feature == Feature::vertex)
    return topology_.vertex_normals[static_cast<std::size_t>(mesh_->triangles[triangle][index])].cast<Counted>();
  const Vec3Of<Counted>& own = facets_[triangle].normal;
  if (feature == Feature::face) return own;
  // As MeshTopology::edge_normal.
  const std::int32_t neighbour = topology_.neighbours[triangle][index];
  if (neighbour < 0) return own;
  const Vec3Of<Counted> sum = own + facets_[static_cast<std::size_t>(neighbour)].normal;
  const Counted length = sqrt(squared_norm(sum));
  return length > Counted(8.0 * std::numeric_limits<double>::epsilon()) ? Vec3Of<Counted>(sum / length) : own;
}

Foot<Counted> CountedFeet::closest(const Vec3Of<Counted>& p_W_m) const {
  surface::TriangleClosestOf<Counted> best{};
  std::int32_t nearest = -1;
  tree_.nearest<Counted>(p_W_m, [&](std::int32_t t) {
    const Facet& facet = facets_[static_cast<std::size_t>(t)];
    const auto here = surface::closest_on_triangle_of<Counted>(facet.corners, facet.normal, p_W_m);
    // Of equally close triangles the one with the smaller index.
    if (nearest < 0 || here.squared_distance < best.squared_distance ||
        (t < nearest && here.squared_distance == best.squared_distance)) {
      best = here;
      nearest = t;
    }
    return best.squared_distance;
  });
  const auto t = static_cast<std::size_t>(nearest);
  Foot<Counted> foot;
  foot.p_W_m =
      best.feature == Feature::vertex ? facets_[t].corners[best.index] : Vec3Of<Counted>(p_W_m + best.from_query);
  foot.n_W = normal_at(t, best.feature, best.index);
  const Counted distance = sqrt(best.squared_distance);
  const bool inside =
      dot(best.from_query, foot.n_W) > Counted(0.0) && !on_rim(topology_, *mesh_, t, best.feature, best.index);
  foot.signed_distance_m = inside ? -distance : distance;
  foot.smooth = best.feature == Feature::face;
  return foot;
}

}  // namespace touchstone::renderers
