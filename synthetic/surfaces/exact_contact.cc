#include "synthetic/surfaces/exact_contact.h"

#include <cmath>
#include <optional>

namespace touchstone::synthetic {
namespace {

ExactContact free_at(const Vec3& tip_W_m) { return {false, tip_W_m, Vec3::Zero(), 0.0, Vec3::Zero()}; }

}  // namespace

ExactContact exact_contact(const surface::Surface& surface, const Vec3& tip_W_m, double stiffness_N_per_m,
                           double tip_radius_m) {
  const surface::SurfacePoint at = surface.closest(tip_W_m);
  const double depth = tip_radius_m - at.signed_distance_m;
  if (depth <= 0.0) return free_at(tip_W_m);
  // The spring acts along the line to the closest point: the normal, except at an edge or a vertex.
  const bool smooth = at.feature == surface::Feature::analytic || at.feature == surface::Feature::face;
  const Vec3 towards = at.signed_distance_m < 0.0 ? Vec3(at.p_W_m - tip_W_m) : Vec3(tip_W_m - at.p_W_m);
  const Vec3 n = smooth || at.distance_m == 0.0 ? at.n_W : Vec3(towards / at.distance_m);
  return {true, tip_W_m + depth * n, n, depth, stiffness_N_per_m * depth * n};
}

bool leaves_sheet(const surface::Surface& surface, const Vec3& a_W_m, const Vec3& b_W_m, double tip_radius_m) {
  constexpr int pieces = 16;
  constexpr double lipschitz = 2.0;
  // Closest points of curved shapes are searched for; what the search leaves is far below this.
  const double rounding_m = 1e-9 * surface.bounds().diagonal().norm();
  const double most_m = lipschitz * (b_W_m - a_W_m).norm() / pieces + rounding_m;
  std::optional<Vec3> before;  // the closest point to the tip a piece ago, if that was inside
  for (int piece = 0; piece <= pieces; ++piece) {
    const surface::SurfacePoint at = surface.closest(a_W_m + piece * (1.0 / pieces) * (b_W_m - a_W_m));
    const bool inside = at.signed_distance_m < tip_radius_m;
    if (inside && before && (at.p_W_m - *before).norm() > most_m) return true;
    before = inside ? std::optional(at.p_W_m) : std::nullopt;
  }
  return false;
}

ExactContact exact_valley_contact(const Vec3& line_W_m, const Vec3& n1_W, const Vec3& n2_W, const Vec3& tip_W_m,
                                  double stiffness_N_per_m, double tip_radius_m) {
  // In the plane across the line: m halves the angle between the normals, t lies across, h is half that angle. Written
  // with half angles, nearly flat creases lose no digits.
  const Vec3 across = n2_W - n1_W;
  const Vec3 t = across.normalized();
  const Vec3 m = (n1_W + n2_W).normalized();
  const double sin_h = 0.5 * across.norm();
  const double cos_h = 0.5 * (n1_W + n2_W).norm();
  const Vec3 from_line = tip_W_m - line_W_m;
  const double d1 = tip_radius_m - n1_W.dot(from_line);
  const double d2 = tip_radius_m - n2_W.dot(from_line);
  if (d1 <= 0.0 && d2 <= 0.0) return free_at(tip_W_m);
  // To where both planes are touched; the pushes of both are positive only within the wedge of their normals (the
  // multipliers of Zilles and Salisbury 1995), outside of it one plane pushes alone.
  const double up = tip_radius_m / cos_h - m.dot(from_line);
  const double sideways = -t.dot(from_line);
  Vec3 move = up * m + sideways * t;
  if (std::abs(sideways) * cos_h > up * sin_h) move = sideways > 0.0 ? Vec3(d2 * n2_W) : Vec3(d1 * n1_W);
  const double depth = move.norm();
  return {true, tip_W_m + move, move / depth, depth, stiffness_N_per_m * move};
}

}  // namespace touchstone::synthetic
