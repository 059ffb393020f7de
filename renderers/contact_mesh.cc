#include "renderers/contact_mesh.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <mutex>

#include "harness/base/error.h"
#include "renderers/mesh_regularity.h"

namespace touchstone {
namespace {

std::size_t at(std::int32_t i) { return static_cast<std::size_t>(i); }

const TriangleMesh& triangles_of(const Surface& surface) {
  if (surface.mesh() == nullptr)
    throw BadData("this renderer constrains by triangles and cannot run on an analytic surface");
  return *surface.mesh();
}

}  // namespace

ContactMesh::ContactMesh(const Surface& surface)
    : mesh_(&triangles_of(surface)), topology_(make_topology(*mesh_)), tree_(std::make_unique<TriangleTree>(*mesh_)) {
  extent_ = surface.bounds().diagonal().norm();
  const std::size_t count = mesh_->triangle_count();
  facets_.resize(count);
  const std::vector<bool> regular = regular_triangles(*mesh_, topology_, *tree_);
  for (std::size_t t = 0; t < count; ++t) {
    Facet& facet = facets_[t];
    facet.corner = mesh_->triangles[t];
    facet.neighbour = topology_.neighbours[t];
    facet.origin = vertex(facet.corner[0]);
    facet.n = topology_.face_normals[t];
    facet.regular = regular[t];
    for (std::size_t e = 0; e < 3; ++e) {
      const Vec3 along = vertex(facet.corner[(e + 1) % 3]) - vertex(facet.corner[e]);
      facet.inward[e] = facet.n.cross(along).normalized();
      magnitude_ = std::max(magnitude_, vertex(facet.corner[e]).cwiseAbs().maxCoeff());
    }
    facet.inset = facet.inward[1].dot(vertex(facet.corner[1]) - facet.origin);
  }
  for (std::size_t t = 0; t < count; ++t) {
    Facet& facet = facets_[t];
    for (std::size_t e = 0; e < 3; ++e) {
      facet.valley[e] = false;
      if (facet.neighbour[e] < 0) continue;
      const Facet& other = facets_[at(facet.neighbour[e])];
      // By the free corner that reaches farther, asked the same way from both sides, so that both agree.
      const auto reach = [&](const Facet& plane, const Facet& from) {
        double far = 0.0;
        for (const std::int32_t corner : from.corner) {
          const double height = plane.height(vertex(corner));
          if (std::find(plane.corner.begin(), plane.corner.end(), corner) == plane.corner.end()) far = height;
        }
        return far;
      };
      const double there = reach(facet, other);
      const double here = reach(other, facet);
      facet.valley[e] = (std::abs(there) > std::abs(here) ? there : here) > 0.0;
    }
  }
}

std::size_t ContactMesh::edge_towards(std::int32_t triangle, std::int32_t neighbour, std::int32_t from) const noexcept {
  const Facet& here = facet(triangle);
  // Two triangles may share two edges: the one that starts at `from` is meant.
  for (std::size_t e = 0; e < 3; ++e) {
    if (here.neighbour[e] == neighbour && here.corner[e] == from) return e;
  }
  return 0;
}

std::shared_ptr<const ContactMesh> contact_mesh(const std::shared_ptr<const Surface>& surface) {
  // Kept with its surface, so that the address cannot come to mean another one.
  struct Kept {
    explicit Kept(std::shared_ptr<const Surface> over) : surface(std::move(over)), mesh(*surface) {}
    std::shared_ptr<const Surface> surface;
    ContactMesh mesh;
  };
  static std::mutex mutex;
  static std::map<const Surface*, std::weak_ptr<const Kept>> known;
  const std::lock_guard lock(mutex);
  std::erase_if(known, [](const auto& item) { return item.second.expired(); });
  std::shared_ptr<const Kept> kept = known[surface.get()].lock();
  if (!kept) {
    kept = std::make_shared<const Kept>(surface);
    known[surface.get()] = kept;
  }
  return {kept, &kept->mesh};
}

}  // namespace touchstone
