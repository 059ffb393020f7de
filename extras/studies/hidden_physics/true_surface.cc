#include "hidden_physics/true_surface.h"

#include <algorithm>
#include <cmath>

namespace touchstone::hidden_physics {

TrueSurface::Jet TrueSurface::at(const Vec2& xy) const {
  Jet jet{0.5 * curvature_per_m.dot(xy.cwiseAbs2()), curvature_per_m.cwiseProduct(xy),
          Eigen::Matrix2d(curvature_per_m.asDiagonal())};
  for (const Wave& wave : waves) {
    const double angle = wave.k_per_m.dot(xy) + wave.phase_rad;
    jet.h += wave.amplitude_m * std::sin(angle);
    jet.slope += wave.amplitude_m * std::cos(angle) * wave.k_per_m;
    jet.bend -= wave.amplitude_m * std::sin(angle) * wave.k_per_m * wave.k_per_m.transpose();
  }
  for (const Bump& bump : bumps) {
    const Vec2 r = xy - bump.centre_m;
    const double variance = bump.width_m * bump.width_m;
    const double height = bump.amplitude_m * std::exp(-0.5 * r.squaredNorm() / variance);
    jet.h += height;
    jet.slope -= height / variance * r;
    jet.bend += height / variance * (r * r.transpose() / variance - Eigen::Matrix2d::Identity());
  }
  return jet;
}

TrueSurface::Foot TrueSurface::foot(const Vec3& p, const Vec2& guess) const {
  Vec2 xy = guess;
  for (int iteration = 0; iteration < 8; ++iteration) {
    const Jet jet = at(xy);
    const double above = jet.h - p.z();
    const Vec2 gradient = xy - p.head<2>() + above * jet.slope;
    Eigen::Matrix2d curvature = Eigen::Matrix2d::Identity() + jet.slope * jet.slope.transpose() + above * jet.bend;
    // Far from the surface the objective may bend downwards: Gauss-Newton's matrix always descends.
    if (curvature.determinant() <= 0.0 || curvature.trace() <= 0.0) {
      curvature = Eigen::Matrix2d::Identity() + jet.slope * jet.slope.transpose();
    }
    const Vec2 step = curvature.inverse() * gradient;
    xy -= step;
    if (step.norm() < 1e-12 * half_side_m) break;
  }
  const Jet jet = at(xy);
  Foot foot;
  foot.q_W_m = Vec3(xy.x(), xy.y(), jet.h);
  foot.n_W = Vec3(-jet.slope.x(), -jet.slope.y(), 1.0).normalized();
  foot.distance_m = (p - foot.q_W_m).dot(foot.n_W);
  return foot;
}

surface::TriangleMesh TrueSurface::slab(std::size_t cells, double thickness_m) const {
  surface::TriangleMesh mesh;
  const auto n = static_cast<std::int32_t>(cells) + 1;
  const double step = 2.0 * half_side_m / static_cast<double>(cells);
  double lowest = 0.0;
  for (std::int32_t j = 0; j < n; ++j) {
    for (std::int32_t i = 0; i < n; ++i) {
      const Vec2 xy(-half_side_m + step * i, -half_side_m + step * j);
      const double h = at(xy).h;
      lowest = std::min(lowest, h);
      mesh.vertices_W_m.emplace_back(xy.x(), xy.y(), h);
    }
  }
  const auto id = [n](std::int32_t i, std::int32_t j) { return j * n + i; };
  for (std::int32_t j = 0; j + 1 < n; ++j) {
    for (std::int32_t i = 0; i + 1 < n; ++i) {
      const auto a = id(i, j);
      const auto b = id(i + 1, j);
      const auto c = id(i + 1, j + 1);
      const auto d = id(i, j + 1);
      if ((i + j) % 2 == 0) {
        mesh.triangles.push_back({a, b, c});
        mesh.triangles.push_back({a, c, d});
      } else {
        mesh.triangles.push_back({a, b, d});
        mesh.triangles.push_back({b, c, d});
      }
    }
  }
  // The rim, counter-clockwise seen from above, once more at the bottom, and the bottom as a fan about its middle.
  std::vector<std::int32_t> rim;
  for (std::int32_t i = 0; i + 1 < n; ++i) rim.push_back(id(i, 0));
  for (std::int32_t j = 0; j + 1 < n; ++j) rim.push_back(id(n - 1, j));
  for (std::int32_t i = n - 1; i > 0; --i) rim.push_back(id(i, n - 1));
  for (std::int32_t j = n - 1; j > 0; --j) rim.push_back(id(0, j));
  const auto first = static_cast<std::int32_t>(mesh.vertices_W_m.size());
  for (const std::int32_t v : rim) {
    Vec3 below = mesh.vertices_W_m[static_cast<std::size_t>(v)];
    below.z() = lowest - thickness_m;
    mesh.vertices_W_m.push_back(below);
  }
  const auto middle = static_cast<std::int32_t>(mesh.vertices_W_m.size());
  mesh.vertices_W_m.emplace_back(0.0, 0.0, lowest - thickness_m);
  const auto count = static_cast<std::int32_t>(rim.size());
  for (std::int32_t r = 0; r < count; ++r) {
    const std::int32_t next = (r + 1) % count;
    const auto a = rim[static_cast<std::size_t>(r)];
    const auto b = rim[static_cast<std::size_t>(next)];
    mesh.triangles.push_back({a, first + r, first + next});
    mesh.triangles.push_back({a, first + next, b});
    mesh.triangles.push_back({middle, first + next, first + r});
  }
  mesh.source = "blind case";
  return mesh;
}

double TrueSurface::deviation_m(const TrueSurface& meshed, std::size_t cells) const {
  const double step = 2.0 * half_side_m / static_cast<double>(cells);
  double largest = 0.0;
  for (std::size_t j = 0; j < cells; ++j) {
    for (std::size_t i = 0; i < cells; ++i) {
      const Vec2 corner(-half_side_m + step * static_cast<double>(i), -half_side_m + step * static_cast<double>(j));
      const double h00 = meshed.at(corner).h;
      const double h10 = meshed.at(corner + Vec2(step, 0.0)).h;
      const double h01 = meshed.at(corner + Vec2(0.0, step)).h;
      const double h11 = meshed.at(corner + Vec2(step, step)).h;
      const bool even = (i + j) % 2 == 0;
      for (const double u : {0.125, 0.375, 0.625, 0.875}) {
        for (const double v : {0.125, 0.375, 0.625, 0.875}) {
          double flat = 0.0;
          if (even) {  // the diagonal from 00 to 11
            flat = u > v ? h00 + u * (h10 - h00) + v * (h11 - h10) : h00 + v * (h01 - h00) + u * (h11 - h01);
          } else {  // from 10 to 01
            flat = u + v < 1.0 ? h00 + u * (h10 - h00) + v * (h01 - h00)
                               : h11 + (1.0 - u) * (h01 - h11) + (1.0 - v) * (h10 - h11);
          }
          largest = std::max(largest, std::abs(at(corner + step * Vec2(u, v)).h - flat));
        }
      }
    }
  }
  return largest;
}

}  // namespace touchstone::hidden_physics
