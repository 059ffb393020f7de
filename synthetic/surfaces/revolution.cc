#include "synthetic/surfaces/revolution.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "synthetic/surfaces/crossing.h"

namespace touchstone::synthetic {
using surface::Feature;

Revolution::Revolution(Profile profile) : profile_(std::move(profile)) {}

surface::SurfacePoint Revolution::closest(const Vec3& p) const {
  const double s = std::hypot(p.x(), p.y());
  // On the axis every direction is as close: x is taken.
  const Vec2 radial = s > 0.0 ? Vec2(p.x() / s, p.y() / s) : Vec2(1.0, 0.0);
  const ProfilePoint foot = profile_.closest({s, p.z()});
  // A pole: the sides all around it sum up to a normal along the axis.
  const bool pole = foot.p.x() <= 0.0 && !profile_.closed();
  const Vec2 n = pole ? Vec2(0.0, foot.n.y() < 0.0 ? -1.0 : 1.0) : foot.n;
  // A cone ends in a vertex, a ball's arc or a flat disc goes on smoothly over the pole.
  const bool tip = pole && std::abs(foot.n.x()) > 1e-12;
  return analytic_point({foot.p.x() * radial.x(), foot.p.x() * radial.y(), foot.p.y()},
                        {n.x() * radial.x(), n.x() * radial.y(), n.y()}, foot.signed_distance,
                        tip ? Feature::vertex : (foot.corner ? Feature::edge : Feature::analytic));
}

std::optional<surface::Crossing> Revolution::first_crossing(const Vec3& a, const Vec3& b) const {
  CrossingCandidates candidates;
  const Vec3 d = b - a;
  // The squared distance from the axis along the segment: h0 + h1 t + h2 t^2.
  const double h0 = a.x() * a.x() + a.y() * a.y();
  const double h1 = 2.0 * (a.x() * d.x() + a.y() * d.y());
  const double h2 = d.x() * d.x() + d.y() * d.y();
  for (const ProfileElement& e : profile_.elements()) {
    if (e.is_arc) {
      // |p - c|^2 = r^2 revolved: (h + (z - cz)^2 + cs^2 - r^2)^2 = 4 cs^2 h.
      const double z = a.z() - e.centre.y();
      const double g0 = h0 + z * z + e.centre.x() * e.centre.x() - e.radius * e.radius;
      const double g1 = h1 + 2.0 * z * d.z();
      const double g2 = h2 + d.z() * d.z();
      if (e.centre.x() == 0.0) {
        candidates.offer_quadratic(g0, g1, g2);
      } else {
        const double k = 4.0 * e.centre.x() * e.centre.x();
        candidates.offer_quartic(
            {g0 * g0 - k * h0, 2.0 * g0 * g1 - k * h1, 2.0 * g0 * g2 + g1 * g1 - k * h2, 2.0 * g1 * g2, g2 * g2});
      }
    } else {
      // n_s s = n . start - n_z z, squared; both nappes, of which the profile's own is kept by the change of side.
      const double c0 = e.normal.dot(e.start) - e.normal.y() * a.z();
      const double c1 = -e.normal.y() * d.z();
      const double k = e.normal.x() * e.normal.x();
      if (k == 0.0) {
        candidates.offer_quadratic(c0, c1, 0.0);
      } else {
        candidates.offer_quadratic(k * h0 - c0 * c0, k * h1 - 2.0 * c0 * c1, k * h2 - c1 * c1);
      }
    }
  }
  return candidates.first(*this, a, b);
}

Box3 Revolution::bounds() const {
  double reach = 0.0;
  double low = profile_.elements().front().start.y();
  double high = low;
  for (const ProfileElement& e : profile_.elements()) {
    reach = std::max({reach, e.start.x(), e.end.x(), e.is_arc && e.sweep > 0.0 ? e.centre.x() + e.radius : 0.0});
    low = std::min({low, e.start.y(), e.end.y(), e.is_arc && e.sweep > 0.0 ? e.centre.y() - e.radius : low});
    high = std::max({high, e.start.y(), e.end.y(), e.is_arc && e.sweep > 0.0 ? e.centre.y() + e.radius : high});
  }
  return {Vec3(-reach, -reach, low), Vec3(reach, reach, high)};
}

Tessellation Revolution::tessellate(std::size_t triangles) const {
  const bool ring = profile_.closed();
  const auto rough = profile_.sample(64);
  double mean_s = 0.0;
  for (const Vec2& p : rough.points) mean_s += p.x() / static_cast<double>(rough.points.size());
  const double quads = static_cast<double>(triangles) / 2.0;
  const double aspect = profile_.length() / (2.0 * std::numbers::pi * mean_s);
  const auto samples = profile_.sample(static_cast<std::size_t>(std::max(2.0, std::round(std::sqrt(quads * aspect)))));
  const std::vector<Vec2>& points = samples.points;
  // Between poles n - 1 chords make n - 2 whole bands: the two at the poles are fans of half as many triangles.
  const double bands = ring ? static_cast<double>(points.size()) : static_cast<double>(points.size()) - 2.0;
  const auto sides = static_cast<std::int32_t>(std::max(3.0, std::round(quads / bands)));

  surface::TriangleMesh mesh;
  double reach = 0.0;
  const auto add_ring = [&](const Vec2& p) {
    const auto first = static_cast<std::int32_t>(mesh.vertices_W_m.size());
    reach = std::max(reach, p.x());
    for (std::int32_t j = 0; j < sides; ++j) {
      const double angle = 2.0 * std::numbers::pi * j / sides;
      mesh.vertices_W_m.emplace_back(p.x() * std::cos(angle), p.x() * std::sin(angle), p.y());
    }
    return first;
  };
  const auto add_band = [&](std::int32_t lower, std::int32_t upper) {
    for (std::int32_t j = 0; j < sides; ++j) {
      const std::int32_t k = (j + 1) % sides;
      mesh.triangles.push_back({lower + j, lower + k, upper + k});
      mesh.triangles.push_back({lower + j, upper + k, upper + j});
    }
  };
  if (ring) {
    const std::int32_t first = add_ring(points.front());
    std::int32_t lower = first;
    for (std::size_t i = 1; i < points.size(); ++i) {
      const std::int32_t upper = add_ring(points[i]);
      add_band(lower, upper);
      lower = upper;
    }
    add_band(lower, first);
  } else {
    const auto add_pole = [&](const Vec2& p) {
      mesh.vertices_W_m.emplace_back(0.0, 0.0, p.y());
      return static_cast<std::int32_t>(mesh.vertices_W_m.size() - 1);
    };
    const std::int32_t bottom = add_pole(points.front());
    std::int32_t lower = add_ring(points[1]);
    for (std::int32_t j = 0; j < sides; ++j) mesh.triangles.push_back({bottom, lower + (j + 1) % sides, lower + j});
    for (std::size_t i = 2; i + 1 < points.size(); ++i) {
      const std::int32_t upper = add_ring(points[i]);
      add_band(lower, upper);
      lower = upper;
    }
    const std::int32_t top = add_pole(points.back());
    for (std::int32_t j = 0; j < sides; ++j) mesh.triangles.push_back({lower + j, lower + (j + 1) % sides, top});
  }
  // The bands are plane facets between coaxial rings: at the middle of a facet a point is s (1 - cos(pi / sides))
  // nearer to the axis than its chord's circle, and a chord departs from its arc by the sagitta.
  const double facet = 2.0 * std::pow(std::sin(0.5 * std::numbers::pi / sides), 2);
  return {std::move(mesh), samples.sagitta + reach * facet};
}

}  // namespace touchstone::synthetic
