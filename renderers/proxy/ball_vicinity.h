// Which triangles a ball can meet while it rolls over a given one: found once for a mesh and a radius, so that a step
// over a smooth surface asks a handful of triangles, however fine the mesh is.
//
// A ball of radius r that rests on the face of triangle T has its centre in P, which is T moved by r along its normal.
// Only triangles that come closer to P than r can push it off T. All others are out of the question for every place on
// T: on a convex surface all of them, on a concave one nearly all but the neighbours of T. A ball that rests on an edge
// or a corner of T is within some distance of P (the spread, r times the difference of the unit normals there), and can
// meet only what comes closer to P than r plus that. What is listed is decided by lower bounds of the distance between
// P and a triangle, from tangents: the distance from a convex set is a convex function. So a list may have a triangle
// too many, never one too few. The set of all places of a ball's centre that touches a body is its offset surface
// (configuration-space obstacle, T. Lozano-Perez, IEEE Transactions on Computers C-32, 1983); culling neighbours by
// bounds of their normals and heights is P. Volino and N. Magnenat-Thalmann, Computer Graphics Forum 13(3), 1994, here
// with the ball's radius in it.
#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "renderers/mesh_traversal/contact_mesh.h"

namespace touchstone::renderers {

class BallVicinity {
 public:
  struct Of {
    std::span<const std::int32_t> on_face;  // complete for centres in P
    std::span<const std::int32_t> beside;   // with on_face complete for centres within spread_m of P
    double spread_m = -1.0;                 // < 0: neither is complete
  };

  // While it lives, vicinities made on its thread list each triangle when it is asked about first, and not all of them
  // when they are made: for a renderer that goes over one recording and is gone, of which a search for missing effects
  // makes thousands, each of another radius or place. The lists are the same. Asking then takes memory from the heap:
  // not for a servo loop. `mesh` must outlive such a vicinity, which is one thread's.
  class OnDemand {
   public:
    OnDemand() noexcept : before_(wanted_) { wanted_ = true; }
    ~OnDemand() { wanted_ = before_; }
    OnDemand(const OnDemand&) = delete;
    OnDemand& operator=(const OnDemand&) = delete;

   private:
    friend class BallVicinity;
    bool before_;
    static thread_local bool wanted_;
  };

  // The tree of `mesh` is asked once for each triangle, on all cores.
  BallVicinity(const ContactMesh& mesh, double radius_m);

  // Either list in the order of its indices, without the triangle itself.
  [[nodiscard]] Of of(std::int32_t triangle) const noexcept {
    if (on_demand_ != nullptr && listed_already_[static_cast<std::size_t>(triangle)] == 0) list_now(triangle);
    const Entry& entry = entries_[static_cast<std::size_t>(triangle)];
    const std::span all(listed_.data() + entry.first, static_cast<std::size_t>(entry.all));
    return {all.first(entry.on_face), all.subspan(entry.on_face), static_cast<double>(entry.spread_m)};
  }
  [[nodiscard]] std::size_t memory_bytes() const noexcept {
    return entries_.capacity() * sizeof(Entry) + listed_.capacity() * sizeof(std::int32_t);
  }

 private:
  struct Entry {
    std::uint32_t first = 0;
    float spread_m = -1.0F;
    std::uint16_t on_face = 0;
    std::uint16_t all = 0;
  };
  void list_all(const ContactMesh& mesh, double radius_m);
  void list_now(std::int32_t triangle) const noexcept;

  mutable std::vector<Entry> entries_;
  mutable std::vector<std::int32_t> listed_;
  const ContactMesh* on_demand_ = nullptr;
  double radius_m_ = 0.0;
  mutable std::vector<std::uint8_t> listed_already_;  // by triangle, on demand alone
};

}  // namespace touchstone::renderers
