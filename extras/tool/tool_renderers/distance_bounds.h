// Signed distances of moving points to an object that stands still, asked for only where the last answer no longer
// tells. A signed distance changes by at most the way that its point goes: s(p) lies within |p - q| of s(q). At 1 kHz a
// tool moves by micrometres, so that what is far from the object is asked for every many steps, and decisions are those
// of an answer asked for each time (Quinlan, Efficient Distance Computation between Non-Convex Objects, 1994,
// prunes by the same bound in space).
//
// Of an open mesh the sign jumps where no surface is crossed: there every answer is asked for. The same happens where
// bodies of one mesh overlap; an answer may then depend on where the point was before, but not on what was before
// forget().
#pragma once

#include <cmath>
#include <limits>
#include <memory>
#include <vector>

#include "harness/surface/mesh_topology.h"
#include "harness/surface/surface.h"

namespace touchstone::tool_renderers {

class DistanceBounds {
 public:
  DistanceBounds(std::shared_ptr<const surface::Surface> object, std::size_t points)
      : object_(std::move(object)),
        last_(points),
        holds_(object_->topology() != nullptr && object_->topology()->closed()) {}

  void forget() noexcept {
    for (Last& last : last_) last = {};
  }

  enum class Side : std::uint8_t { beyond, within, unknown };
  // Where point `i`, now at p, lies: at a signed distance above r, at most r, or to be asked for.
  [[nodiscard]] Side side(std::size_t i, const Vec3& p, double r) const noexcept {
    const Last& last = last_[i];
    const double way = (p - last.p_W_m).norm() + roundings * (p.norm() + std::abs(last.signed_distance_m));
    if (last.signed_distance_m - way > r) return Side::beyond;
    if (last.signed_distance_m + way < r) return Side::within;
    return Side::unknown;  // NaN, too: nothing is known yet
  }
  // Asks and remembers.
  surface::SurfacePoint ask(std::size_t i, const Vec3& p) noexcept {
    const surface::SurfacePoint near = object_->closest(p);
    if (holds_) last_[i] = {p, near.signed_distance_m};
    return near;
  }
  [[nodiscard]] std::size_t memory_bytes() const noexcept { return last_.capacity() * sizeof(Last); }

 private:
  // What a distance is off by, in parts of the coordinates.
  static constexpr double roundings = 64.0 * std::numeric_limits<double>::epsilon();
  struct Last {
    Vec3 p_W_m = Vec3::Constant(std::numeric_limits<double>::quiet_NaN());
    double signed_distance_m = std::numeric_limits<double>::quiet_NaN();
  };
  std::shared_ptr<const surface::Surface> object_;
  std::vector<Last> last_;
  bool holds_;
};

}  // namespace touchstone::tool_renderers
