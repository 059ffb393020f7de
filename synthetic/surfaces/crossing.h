// The first crossing of a segment with a solid whose signed distance is exact, from candidate parameters at which its
// side may change.
#pragma once

#include <array>
#include <cstddef>
#include <optional>

#include "harness/surface/surface.h"

namespace touchstone::synthetic {

// Parameters along the segment at which a primitive that bounds the solid is met; collecting more than needed does no
// harm, missing one does. A fixed array: queries do not allocate.
// NOLINTNEXTLINE(cppcoreguidelines-pro-type-member-init): 1.3 kB, of which a query reads what it wrote
class CrossingCandidates {
 public:
  static constexpr std::size_t capacity = 160;
  void offer(double fraction) noexcept {
    if (fraction >= 0.0 && fraction <= 1.0 && count_ < capacity) fractions_[count_++] = fraction;
  }
  // The real roots in [0, 1] of c0 + c1 t + c2 t^2 and, by interval exclusion, of the quartic.
  void offer_quadratic(double c0, double c1, double c2) noexcept;
  void offer_quartic(const std::array<double, 5>& c) noexcept;
  // The side of the solid is constant between neighbouring candidates: probes each gap once and returns the first
  // candidate over which it changes, refined by Newton's method on the signed distance to its rounding. A segment that
  // starts on the surface (distance exactly 0) starts outside.
  [[nodiscard]] std::optional<surface::Crossing> first(const surface::Surface& solid, const Vec3& a_W_m,
                                                       const Vec3& b_W_m) noexcept;

 private:
  std::array<double, capacity> fractions_;
  std::size_t count_ = 0;
};

}  // namespace touchstone::synthetic
