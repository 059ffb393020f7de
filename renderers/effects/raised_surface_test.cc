// Held against the closest point of the raised surface, looked for over all directions from a sphere's middle, and
// against planes, where depth and normal are known.
#include "renderers/effects/raised_surface.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <utility>

#include "renderers/instrument/geometry_effects.h"

namespace touchstone::renderers {
namespace {

using rendering::ContactState;

struct Gaussian {
  double amplitude_m;
  double x_m;
  double y_m;
  double width_m;
  RaisedBy operator()(double x, double y) const noexcept {
    const double dx = x - x_m;
    const double dy = y - y_m;
    const double variance = width_m * width_m;
    const double height = amplitude_m * std::exp(-0.5 * (dx * dx + dy * dy) / variance);
    return {height, -dx * height / variance, -dy * height / variance};
  }
};

// Of a sphere about the origin, raised: how deep a tip lies below it, and the outward normal.
struct Twin {
  double depth_m;
  Vec3 n;
};

// The raised surface along a direction: |S| = radius + h(S), by fixed point.
Vec3 along(const Vec3& direction, double radius_m, const Gaussian& height) {
  Vec3 place = radius_m * direction;
  for (int i = 0; i < 60; ++i) place = (radius_m + height(place.x(), place.y()).height_m) * direction;
  return place;
}

Twin closest(const Vec3& tip, double radius_m, const Gaussian& height) {
  const Vec3 middle = tip.normalized();
  const Vec3 u = middle.unitOrthogonal();
  const Vec3 v = middle.cross(u);
  double best_u = 0.0;
  double best_v = 0.0;
  const auto place = [&](double a, double b) { return along((middle + a * u + b * v).normalized(), radius_m, height); };
  double least = (place(0.0, 0.0) - tip).squaredNorm();
  // A compass search: steps along u and v, halved where none helps.
  for (double step = 0.1; step > 1e-9;) {
    bool better = false;
    for (const auto& [a, b] : {std::pair{step, 0.0}, {-step, 0.0}, {0.0, step}, {0.0, -step}}) {
      const double distance = (place(best_u + a, best_v + b) - tip).squaredNorm();
      if (distance >= least) continue;
      least = distance;
      best_u += a;
      best_v += b;
      better = true;
      break;
    }
    if (!better) step *= 0.5;
  }
  const Vec3 foot = place(best_u, best_v);
  const double outside = foot.norm() > tip.norm() ? 1.0 : -1.0;
  return {outside * (foot - tip).norm(), outside * (foot - tip).normalized()};
}

ContactState touch_sphere(const Vec3& tip, double radius_m) {
  ContactState contact;
  contact.tip_W_m = tip;
  contact.n_W = tip.normalized();
  contact.proxy_W_m = radius_m * contact.n_W;
  contact.depth_m = radius_m - tip.norm();
  return contact;
}

TEST(RaisedSurface, IsTheClosestPointOfASphereWithABump) {
  for (const double scale : {1e-2, 1.0, 100.0}) {
    const double radius = 0.04 * scale;
    for (const double amplitude : {1.2e-3, -0.8e-3}) {
      const Gaussian bump{amplitude * scale, 0.008 * scale, -0.005 * scale, 0.009 * scale};
      for (const double depth : {-0.5e-3, 0.5e-3, 2.5e-3}) {
        for (const Vec3& direction : {Vec3(0.1, 0.05, 1.0), Vec3(0.25, -0.2, 1.0), Vec3(0.4, -0.1, 1.0)}) {
          const Vec3 tip = (radius - depth * scale) * direction.normalized();
          const Twin twin = closest(tip, radius, bump);
          ContactState contact = touch_sphere(tip, radius);
          raise_surface(contact, 2, bump);
          SCOPED_TRACE(testing::Message() << scale << " " << amplitude << " " << depth << " " << direction.transpose());
          EXPECT_NEAR(contact.depth_m, twin.depth_m, 1e-6 * scale);
          // The sphere's normal turns by distance * slope / radius between the tip's foot and the closest point; the
          // steepest slope of a Gaussian is amplitude / width * exp(-1/2).
          const double distance = scale * (std::abs(depth) + std::abs(amplitude));
          const double turn = distance * std::abs(bump.amplitude_m) / bump.width_m * std::exp(-0.5) / radius;
          EXPECT_NEAR((contact.n_W - twin.n).norm(), 0.0, turn);
          EXPECT_NEAR((contact.proxy_W_m - (tip + twin.depth_m * twin.n)).norm(), 0.0, turn * distance);
          // With a look more it is nearer; a field has one look.
          ContactState once = touch_sphere(tip, radius);
          raise_surface(once, 1, bump);
          EXPECT_NEAR(once.depth_m, twin.depth_m, 6e-6 * scale);
        }
      }
    }
  }
}

// A plane raised to another plane, h = 0.3 x - 0.2 y + 1 mm: the distance from it whatever the number of looks, for a
// point and for a ball, whose radius the depth has already.
TEST(RaisedSurface, IsExactFromPlaneToPlane) {
  const Vec3 n = Vec3(-0.3, 0.2, 1.0).normalized();
  for (const double radius : {0.0, 2e-3}) {
    for (const Vec3& tip : {Vec3(0.01, 0.02, -3e-3), Vec3(-0.03, 0.01, 4e-3)}) {
      for (const int looks : {1, 2}) {
        ContactState contact;
        contact.tip_W_m = tip;
        contact.n_W = Vec3::UnitZ();
        contact.proxy_W_m = Vec3(tip.x(), tip.y(), 0.0);
        contact.depth_m = radius - tip.z();
        raise_surface(contact, looks, [](double x, double y) noexcept {
          return RaisedBy{0.3 * x - 0.2 * y + 1e-3, 0.3, -0.2};
        });
        const double below = (1e-3 + 0.3 * tip.x() - 0.2 * tip.y() - tip.z()) * n.z();
        EXPECT_NEAR(contact.depth_m, radius + below, 1e-15);
        EXPECT_NEAR((contact.n_W - n).norm(), 0.0, 1e-15);
        EXPECT_NEAR((contact.proxy_W_m - (tip + below * n)).norm(), 0.0, 1e-15);
      }
    }
  }
}

TEST(RaisedSurface, FarFromTheSurfaceNothingChanges) {
  ContactState contact;
  contact.tip_W_m = Vec3(0.0, 0.0, 1.0);
  raise_surface(contact, 2, Gaussian{1e-3, 0.0, 0.0, 0.01});
  EXPECT_EQ(contact.depth_m, 0.0);
  EXPECT_TRUE(contact.n_W.isZero());
}

// The bump of a model belongs to the surface: a tip that is deep in a curved body feels it where its foot is. The two
// looks leave the first one's slope, 0.022, times the square of distance * amplitude / width^2 = 0.31 of it.
TEST(RaisedSurface, AModelsBumpStandsAtTheFoot) {
  const double radius = 0.03;
  const double depth = 0.004;
  const Vec3 n = Vec3(0.4, 0.3, 1.0).normalized();
  const Vec3 peak = (radius + 1e-3) * n;
  const auto bump =
      make_surface_geometry(std::array{1e-3, peak.x(), peak.y(), 4e-3, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0})->contact_effect();
  ContactState contact = touch_sphere((radius - depth) * n, radius);
  bump->apply(contact);
  EXPECT_NEAR(contact.depth_m, depth + 1e-3, 2e-5);
  EXPECT_NEAR((contact.n_W - n).norm(), 0.0, 0.008);
}

}  // namespace
}  // namespace touchstone::renderers
