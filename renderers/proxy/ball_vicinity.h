// Which triangles a ball can meet while it rolls over a given one: found when the ball first comes onto it and kept, so
// that a step over a smooth surface asks a handful of triangles, however fine the mesh is, and nothing is found for the
// many triangles of a fine mesh that no ball comes to.
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

#include <array>
#include <cstdint>
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

  // `mesh` must outlive this, which is one thread's.
  BallVicinity(const ContactMesh& mesh, double radius_m);

  // Either list in the order of its indices, without the triangle itself; they stand until the next call. Takes no
  // memory from the heap. Asks the tree where the triangle was not asked about before, or so many others were since
  // that it has lost its place.
  [[nodiscard]] Of of(std::int32_t triangle) noexcept {
    std::uint16_t& place = places_[static_cast<std::size_t>(triangle)];
    if (entries_[place].triangle != triangle) {
      place = next_;
      next_ = static_cast<std::uint16_t>((next_ + 1U) % entries_.size());
      list(triangle, entries_[place]);
    }
    const Entry& entry = entries_[place];
    const std::span<const std::int32_t> all(entry.listed.data(), entry.all);
    return {all.first(entry.on_face), all.subspan(entry.on_face), static_cast<double>(entry.spread_m)};
  }
  [[nodiscard]] std::size_t memory_bytes() const noexcept {
    return entries_.capacity() * sizeof(Entry) + places_.capacity() * sizeof(std::uint16_t) +
           proposed_.capacity() * sizeof(std::int32_t);
  }

 private:
  // More than a smooth surface has; where there are more, the tree is asked for the ball's neighbourhood.
  static constexpr std::size_t most_listed = 48;
  struct Entry {
    std::int32_t triangle = -1;
    float spread_m = -1.0F;
    std::uint16_t on_face = 0;
    std::uint16_t all = 0;
    std::array<std::int32_t, most_listed> listed{};
  };
  void list(std::int32_t triangle, Entry& entry) noexcept;
  // The spread for which what is listed is complete, < 0 where it is not.
  double list_within_reach(std::int32_t triangle, Entry& entry) noexcept;
  // All that may come within `reach` of `middle`; false where they are more than may be listed for sure. `x` are the
  // corners of P, `most` is how close what is listed comes to it.
  bool propose(std::int32_t triangle, const std::array<Vec3, 3>& x, const Vec3& middle, double reach,
               double most) noexcept;

  const ContactMesh* mesh_;
  double radius_m_;
  std::vector<Entry> entries_;
  std::vector<std::uint16_t> places_;  // by triangle: which entry is its own, if that says so, too
  std::uint16_t next_ = 0;             // to be given away: the oldest
  std::vector<std::int32_t> proposed_;
};

}  // namespace touchstone::renderers
