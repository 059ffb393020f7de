#include "renderers/mesh_traversal/contact_mesh.h"

#include <fmt/format.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <mutex>

#include "harness/base/error.h"
#include "harness/base/huge_pages.h"
#include "harness/base/in_parallel.h"
#include "renderers/mesh_traversal/mesh_regularity.h"

namespace touchstone::renderers {
using surface::Surface;

namespace {

const surface::TriangleMesh& triangles_of(const Surface& surface) {
  if (surface.mesh() == nullptr)
    throw BadData("this renderer constrains by triangles and cannot run on an analytic surface");
  return *surface.mesh();
}

}  // namespace

ContactMesh::ContactMesh(const Surface& surface)
    : mesh_(&triangles_of(surface)),
      own_topology_(surface.topology() ? nullptr : std::make_unique<surface::MeshTopology>(make_topology(*mesh_))),
      own_tree_(surface.tree() ? nullptr : std::make_unique<surface::TriangleTree>(*mesh_)),
      topology_(own_topology_ ? own_topology_.get() : surface.topology()),
      tree_(own_tree_ ? own_tree_.get() : surface.tree()) {
  extent_ = surface.bounds().diagonal().norm();
  const std::size_t count = mesh_->triangle_count();
  std::vector<bool> regular;
  // The search for crossings, half of which waits for memory, and the records side by side.
  in_parallel(
      2,
      [&](std::size_t which) {
        if (which == 0) regular = regular_triangles(*mesh_, *topology_, *tree_);
        if (which == 1) make_facets();
      },
      1);
  in_parallel(count, [&](std::size_t t) { facets_[t].regular = regular[t]; });
}

void ContactMesh::make_facets() {
  const std::size_t count = mesh_->triangle_count();
  reserve_in_huge_pages(facets_, count);
  facets_.resize(count);
  in_parallel(count, [&](std::size_t t) {
    Facet& facet = facets_[t];
    facet.corner = mesh_->triangles[t];
    facet.neighbour = topology_->neighbours[t];
    facet.origin = vertex(facet.corner[0]);
    facet.n = topology_->face_normals[t];
    for (std::size_t e = 0; e < 3; ++e) {
      const Vec3 along = vertex(facet.corner[(e + 1) % 3]) - vertex(facet.corner[e]);
      facet.inward[e] = facet.n.cross(along).normalized();
    }
    facet.inset = facet.inward[1].dot(vertex(facet.corner[1]) - facet.origin);
  });
  double area = 0.0;
  for (const auto& triangle : mesh_->triangles) {
    for (const std::int32_t corner : triangle) magnitude_ = std::max(magnitude_, vertex(corner).cwiseAbs().maxCoeff());
    const Vec3& first = vertex(triangle[0]);
    area += 0.5 * (vertex(triangle[1]) - first).cross(vertex(triangle[2]) - first).norm();
  }
  mean_area_ = area / static_cast<double>(count);
  in_parallel(count, [&](std::size_t t) {
    Facet& facet = facets_[t];
    for (std::size_t e = 0; e < 3; ++e) {
      facet.valley[e] = false;
      if (facet.neighbour[e] < 0) continue;
      const Facet& other = facets_[surface::at(facet.neighbour[e])];
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
  });
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
  // Each surface's has a lock of its own: different ones are made at the same time.
  struct Slot {
    std::mutex mutex;
    std::weak_ptr<const Kept> kept;
  };
  static std::mutex mutex;
  static std::map<const Surface*, std::shared_ptr<Slot>> known;
  std::shared_ptr<Slot> slot;
  {
    const std::lock_guard lock(mutex);
    std::erase_if(known, [](const auto& item) {
      if (item.second.use_count() > 1) return false;
      // Its last user may have written it a moment ago: the lock orders that before this look at it.
      const std::lock_guard own(item.second->mutex);
      return item.second->kept.expired();
    });
    auto& place = known[surface.get()];
    if (!place) place = std::make_shared<Slot>();
    slot = place;
  }
  const std::lock_guard lock(slot->mutex);
  std::shared_ptr<const Kept> kept = slot->kept.lock();
  if (!kept) {
    // In isolation: while this thread waits for its helpers it must not take up a task that wants the same lock.
    tbb::this_task_arena::isolate([&] { kept = std::make_shared<const Kept>(surface); });
    slot->kept = kept;
  }
  return {kept, &kept->mesh};
}

}  // namespace touchstone::renderers
