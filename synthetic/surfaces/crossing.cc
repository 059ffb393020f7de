#include "synthetic/surfaces/crossing.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "synthetic/surfaces/roots.h"

namespace touchstone::synthetic {

void CrossingCandidates::offer_quadratic(double c0, double c1, double c2) noexcept {
  const double discriminant = c1 * c1 - 4.0 * c0 * c2;
  if (discriminant < 0.0) return;
  // The form without cancellation (Numerical Recipes 5.6.4); a vanishing c2 leaves the linear root.
  const double q = -0.5 * (c1 + std::copysign(std::sqrt(discriminant), c1));
  if (q != 0.0) offer(c0 / q);
  if (c2 != 0.0) offer(q / c2);
}

void CrossingCandidates::offer_quartic(const std::array<double, 5>& c) noexcept {
  const auto f = [&](double t) {
    return Jet1{(((c[4] * t + c[3]) * t + c[2]) * t + c[1]) * t + c[0],
                ((4.0 * c[4] * t + 3.0 * c[3]) * t + 2.0 * c[2]) * t + c[1]};
  };
  // Of f'' = 12 c4 t^2 + 6 c3 t + 2 c2 on 0 <= t <= 1.
  const double second = 12.0 * std::abs(c[4]) + 6.0 * std::abs(c[3]) + 2.0 * std::abs(c[2]);
  double size = 0.0;
  for (const double coefficient : c) size += std::abs(coefficient);
  visit_sign_changes(f, 0.0, 1.0, second, 16.0 * std::numeric_limits<double>::epsilon() * size, [&](double root, bool) {
    offer(root);
    return false;
  });
}

std::optional<surface::Crossing> CrossingCandidates::first(const surface::Surface& solid, const Vec3& a_W_m,
                                                           const Vec3& b_W_m) noexcept {
  std::sort(fractions_.begin(), fractions_.begin() + static_cast<std::ptrdiff_t>(count_));
  const Vec3 along = b_W_m - a_W_m;
  const auto inside = [&](double t) { return solid.signed_distance(a_W_m + t * along) < 0.0; };
  const bool starts_inside = solid.signed_distance(a_W_m) < 0.0;
  for (std::size_t i = 0; i < count_; ++i) {
    const double low = i == 0 ? 0.0 : fractions_[i - 1];
    double t = fractions_[i];
    const double next = i + 1 < count_ ? fractions_[i + 1] : 1.0;
    if (next == t && i + 1 < count_) continue;
    const bool inside_after = next > t ? inside(0.5 * (t + next)) : solid.signed_distance(b_W_m) < 0.0;
    if (inside_after == starts_inside) continue;
    // The root of a polynomial is off by its rounding. The signed distance grows by n . along with t: Newton's steps on
    // it take the point onto the surface, as long as they come closer and stay between the neighbouring candidates.
    surface::SurfacePoint at = solid.closest(a_W_m + t * along);
    for (int newton = 0; newton < 3; ++newton) {
      const double slope = at.n_W.dot(along);
      const double better = slope != 0.0 ? t - at.signed_distance_m / slope : t;
      if (!(better >= low && better <= next) || better == t) break;
      const surface::SurfacePoint there = solid.closest(a_W_m + better * along);
      if (!(there.distance_m < at.distance_m)) break;
      t = better;
      at = there;
    }
    return surface::Crossing{t, at.p_W_m, at.n_W, !starts_inside, -1};
  }
  return std::nullopt;
}

}  // namespace touchstone::synthetic
