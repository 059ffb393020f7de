#include "harness/rendering/out_trajectory.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "harness/base/error.h"
#include "harness/base/random.h"
#include "harness/rendering/in_trajectory.h"
#include "harness/surface/embree_surface.h"
#include "harness/testing/tiny_meshes.h"

namespace touchstone::rendering {
using surface::Feature;
using surface::Surface;
using surface::SurfacePoint;
using surface::TriangleMesh;

namespace {

using ::testing::HasSubstr;

constexpr double epsilon = std::numeric_limits<double>::epsilon();

class Plane final : public Surface {
 public:
  Plane(const Vec3& point, const Vec3& normal, double size) : point_(point), n_(normal.normalized()), size_(size) {}
  SurfacePoint closest(const Vec3& p) const override {
    const double s = n_.dot(p - point_);
    return {p - s * n_, n_, std::abs(s), s, -1, Feature::analytic};
  }
  std::optional<surface::Crossing> first_crossing(const Vec3&, const Vec3&) const override { return std::nullopt; }
  Box3 bounds() const override { return {Vec3(point_.array() - size_), Vec3(point_.array() + size_)}; }

 private:
  Vec3 point_;
  Vec3 n_;
  double size_;
};

class Sphere final : public Surface {
 public:
  Sphere(const Vec3& center, double radius) : center_(center), radius_(radius) {}
  SurfacePoint closest(const Vec3& p) const override {
    const Vec3 n = (p - center_).normalized();
    const double s = (p - center_).norm() - radius_;
    return {center_ + radius_ * n, n, std::abs(s), s, -1, Feature::analytic};
  }
  std::optional<surface::Crossing> first_crossing(const Vec3&, const Vec3&) const override { return std::nullopt; }
  Box3 bounds() const override { return {Vec3(center_.array() - radius_), Vec3(center_.array() + radius_)}; }

 private:
  Vec3 center_;
  double radius_;
};

struct Contact {
  Vec3 p_W_m;
  Vec3 f_W_N;
};

// The simplest renderer there is: a spring to the closest point where the ball's centre is clear of the surface.
Contact render(const Surface& surface, const Vec3& tip, double tip_radius_m, double stiffness) {
  const SurfacePoint at = surface.closest(tip);
  const double depth = tip_radius_m - at.signed_distance_m;
  if (depth <= 0.0) return {tip, Vec3::Zero()};
  return {at.p_W_m + tip_radius_m * at.n_W, stiffness * depth * at.n_W};
}

// A frictionless scan: the ball rolls over the surface and is pushed along the normal.
struct Scan {
  recording::Recording recording;
  std::vector<double> force_N;
};

Scan frictionless_scan(const Surface& surface, double size, double tip_radius_m, double largest_depth_m,
                       double stiffness, Random& random, bool on_faces_only) {
  Scan scan;
  scan.recording.source = "scan";
  const Vec3 center = surface.bounds().center();
  while (scan.recording.f_W_N.size() < 500) {
    const SurfacePoint at = surface.closest(center + size * random.direction());
    if (on_faces_only && at.feature != Feature::face) continue;
    const double force = stiffness * largest_depth_m * random.uniform(0.01, 1.0);
    if (on_faces_only) {
      // Deeper than the nearest edge another face would be closer.
      const Vec3 probe = at.p_W_m - 1.01 * (force / stiffness) * at.n_W;
      if (surface.closest(probe).triangle != at.triangle) continue;
    }
    scan.recording.motion.t_s.push_back(1e-3 * static_cast<double>(scan.recording.f_W_N.size()));
    scan.recording.motion.p_W_m.push_back(at.p_W_m + tip_radius_m * at.n_W);
    scan.recording.f_W_N.push_back(force * at.n_W);
    scan.force_N.push_back(force);
  }
  return scan;
}

// Named bound: positions come back within this many units of rounding of the largest coordinate, forces within k times
// it.
// The worst must also come within a twelfth of it: a bound that has grown loose is no bound.
constexpr double round_trip_roundings = 8.0;

void expect_round_trip(const Surface& surface, const Scan& scan, double tip_radius_m, double stiffness, double& worst) {
  const recording::OutTrajectory out = make_out_trajectory(scan.recording, surface, {tip_radius_m, 0.0});
  const recording::InTrajectory in = synthesize_in_trajectory(out, stiffness);
  ASSERT_EQ(in.size(), scan.recording.size());
  for (std::size_t i = 0; i < out.size(); ++i) {
    const double unit =
        epsilon * (out.motion.p_W_m[i].cwiseAbs().maxCoeff() + tip_radius_m + surface.bounds().diagonal().norm());
    const Contact contact = render(surface, in.motion.p_W_m[i], tip_radius_m, stiffness);
    const double position_error = (contact.p_W_m - out.motion.p_W_m[i]).norm() / unit;
    const double scan_error = (out.motion.p_W_m[i] - scan.recording.motion.p_W_m[i]).norm() / unit;
    const double force_error = (contact.f_W_N - scan.recording.f_W_N[i]).norm() / (stiffness * unit);
    worst = std::max({worst, position_error, scan_error, force_error});
    ASSERT_LE(position_error, round_trip_roundings) << i;
    ASSERT_LE(scan_error, round_trip_roundings) << i;
    ASSERT_LE(force_error, round_trip_roundings) << i;
    ASSERT_GE(surface.signed_distance(out.motion.p_W_m[i]), tip_radius_m) << i;
    ASSERT_EQ(out.gap_m[i], 0.0);
    ASSERT_EQ(in.motion.t_s[i], scan.recording.motion.t_s[i]);
  }
}

TEST(OutTrajectory, FrictionlessRoundTripIsExactOnPlaneSphereAndMesh) {
  const std::uint64_t seed = 31;
  Random random(seed);
  double worst = 0.0;
  for (const double scale : {1e-3, 1.0, 1e3}) {
    for (const double radius : {0.0, 0.1}) {
      SCOPED_TRACE(fmt::format("seed {}, scale {}, tip radius {}", seed, scale, radius * scale));
      const Vec3 shift = 3.0 * scale * random.direction();
      const Plane plane(shift, random.direction(), scale);
      expect_round_trip(plane, frictionless_scan(plane, scale, radius * scale, 0.2 * scale, 500.0, random, false),
                        radius * scale, 500.0, worst);
      const Sphere sphere(shift, scale);
      expect_round_trip(sphere,
                        frictionless_scan(sphere, 2.0 * scale, radius * scale, 0.2 * scale, 500.0, random, false),
                        radius * scale, 500.0, worst);
      const auto mesh =
          make_embree_surface(surface::moved(testing::torus(1.0, 0.4, 24, 16), random.rotation(), shift, scale));
      expect_round_trip(*mesh, frictionless_scan(*mesh, 2.0 * scale, radius * scale, 0.05 * scale, 500.0, random, true),
                        radius * scale, 500.0, worst);
    }
  }
  EXPECT_GT(worst, round_trip_roundings / 12.0);
  fmt::print("worst round trip: {:.1f} units of rounding of the coordinates (bound {})\n", worst, round_trip_roundings);
}

TEST(OutTrajectory, IsNeverInsideWhateverWasMeasured) {
  Random random(7);
  for (const double scale : {1e-3, 1.0, 1e3}) {
    const auto surface = make_embree_surface(
        surface::moved(testing::torus(1.0, 0.4, 24, 16), random.rotation(), 5.0 * scale * random.direction(), scale));
    for (const double radius : {0.0, 0.05 * scale, 0.3 * scale}) {
      const OutTrajectoryMaker make(*surface, {radius, 0.05});
      for (int i = 0; i < 2000; ++i) {
        const Vec3 p = surface->bounds().center() + scale * random.uniform(0.0, 2.0) * random.direction();
        const OutSample out = make(p, random.normal() * random.direction());
        ASSERT_TRUE(out.clear) << i;
        ASSERT_GE(surface->signed_distance(out.p_W_m), radius);
        ASSERT_NEAR(out.n_W.norm(), 1.0, 1e-12);
        ASSERT_GE(out.normal_force_N, 0.0);
        ASSERT_TRUE(out.contact || out.normal_force_N == 0.0);
      }
    }
  }
}

TEST(OutTrajectory, ThresholdPullsAndSidewaysDrag) {
  const Plane plane(Vec3::Zero(), Vec3::UnitZ(), 1.0);
  const OutTrajectoryMaker make(plane, {0.0, 0.5});
  const Vec3 above(0.1, 0.2, 0.003);
  EXPECT_EQ(make(above, {0, 0, 0.5}).p_W_m, above);   // not above the threshold: free, stays
  EXPECT_EQ(make(above, {0, 0, -9.0}).p_W_m, above);  // a pull
  EXPECT_EQ(make(above, {9.0, 9.0, 0.1}).p_W_m, above);
  EXPECT_DOUBLE_EQ(make(above, {0, 0, 0.1}).gap_m, 0.003);
  const OutSample contact = make(above, {3.0, 0, 0.6});
  EXPECT_TRUE(contact.contact);
  EXPECT_EQ(contact.p_W_m, Vec3(0.1, 0.2, 0.0));
  EXPECT_EQ(contact.gap_m, 0.0);
  EXPECT_DOUBLE_EQ(contact.normal_force_N, 0.6);
  // Free, but measured inside: put on the surface without force.
  const OutSample inside = make({0.1, 0.2, -0.001}, {0, 0, 0.1});
  EXPECT_EQ(inside.p_W_m, Vec3(0.1, 0.2, 0.0));
  EXPECT_FALSE(inside.contact);
  EXPECT_EQ(inside.normal_force_N, 0.0);
}

// Two planes that meet at a right angle: a ball lies in the valley with its centre r sqrt(2) above the crease.
TriangleMesh valley() {
  TriangleMesh mesh;
  mesh.vertices_W_m = {{-1, -1, 1}, {-1, 1, 1}, {0, -1, 0}, {0, 1, 0}, {1, -1, 1}, {1, 1, 1}};
  mesh.triangles = {{0, 2, 3}, {0, 3, 1}, {2, 4, 5}, {2, 5, 3}};
  mesh.source = "valley";
  return mesh;
}

TEST(OutTrajectory, ABallInAValleyTouchesBothSides) {
  const auto surface = make_embree_surface(valley());
  const double r = 0.1;
  const OutTrajectoryMaker make(*surface, {r, 0.05});
  for (const double height : {-0.05, 0.0, 0.02, 0.1}) {
    const OutSample out = make({0.0, 0.1, height}, {0, 0, 1.0});
    EXPECT_LT((out.p_W_m - Vec3(0.0, 0.1, r * std::sqrt(2.0))).norm(), 1e-14) << height;
    EXPECT_LT((out.n_W - Vec3::UnitZ()).norm(), 1e-14);
    EXPECT_TRUE(out.clear);
  }
  // On one side only, clear of the other.
  const OutSample side = make({0.5, 0.1, 0.5}, {0, 0, 1.0});
  EXPECT_LT((side.n_W - Vec3(-1, 0, 1).normalized()).norm(), 1e-14);
  EXPECT_LT((side.p_W_m - (Vec3(0.5, 0.1, 0.5) + r * Vec3(-1, 0, 1).normalized())).norm(), 1e-14);
}

TEST(OutTrajectory, ABallOverARidgeIsPushedFromIt) {
  const auto surface = make_embree_surface(testing::cube(1.0));
  const OutTrajectoryMaker make(*surface, {0.1, 0.05});
  const OutSample out = make({1.04, 1.03, 0.2}, {1.0, 1.0, 0.0});
  EXPECT_LT((out.n_W - Vec3(0.8, 0.6, 0.0)).norm(), 1e-14);
  EXPECT_LT((out.p_W_m - Vec3(1.08, 1.06, 0.2)).norm(), 1e-14);
}

TEST(OutTrajectory, ASlotTooNarrowIsSaid) {
  // Two walls 0.1 apart that face each other.
  TriangleMesh slot;
  slot.vertices_W_m = {{0, -1, -1}, {0, 1, -1}, {0, 0, 1}, {0.1, -1, -1}, {0.1, 1, -1}, {0.1, 0, 1}};
  slot.triangles = {{0, 1, 2}, {3, 5, 4}};
  const auto surface = make_embree_surface(slot);
  const OutTrajectoryMaker make(*surface, {0.2, 0.05});
  OutTrajectorySummary summary;
  summary.add(make({0.04, 0.0, -0.5}, {1.0, 0, 0}));
  EXPECT_EQ(summary.not_clear, 1U);
  EXPECT_EQ(summary.in_contact, 1U);
}

TEST(OutTrajectory, BadInputIsRefused) {
  const Plane plane(Vec3::Zero(), Vec3::UnitZ(), 1.0);
  EXPECT_THROW(OutTrajectoryMaker(plane, {-1.0, 0.0}), UsageError);
  EXPECT_THROW(OutTrajectoryMaker(plane, {0.0, std::nan("")}), UsageError);
  EXPECT_THROW(synthesize_in_trajectory({}, 0.0), UsageError);
  EXPECT_THROW(synthesize_in_trajectory({}, std::numeric_limits<double>::infinity()), UsageError);
  recording::Recording recording;
  recording.source = "r.csv";
  recording.motion.t_s = {0.0, 0.5};
  recording.motion.p_W_m = {Vec3::Zero(), Vec3(0, std::nan(""), 0)};
  recording.f_W_N = {Vec3::Zero(), Vec3::Zero()};
  try {
    make_out_trajectory(recording, plane, {});
    FAIL();
  } catch (const BadData& error) {
    EXPECT_THAT(error.what(), HasSubstr("r.csv: sample 1 (t = 0.5 s)"));
  }
  recording.f_W_N.pop_back();
  EXPECT_THROW(make_out_trajectory(recording, plane, {}), BadData);
}

// 1.9 N on 0.11 mm look like 17 kN/m; a tracker that scatters by 0.09 mm does not show them. A tenth of the noise does.
TEST(DepthUnderForce, ADepthWithinTheTrackersNoiseIsNone) {
  for (const double noise_m : {9e-5, 9e-6}) {
    Random random(5);
    recording::Recording press;
    for (int i = 0; i < 2000; ++i) {
      press.motion.t_s.push_back(i / 60.0);
      press.motion.p_W_m.emplace_back(0.001 * i, 0.0, -1.1e-4 + noise_m * random.normal());
      press.f_W_N.emplace_back(0.0, 0.0, 1.9 + 0.5 * std::sin(0.1 * i));
    }
    const DepthUnderForce felt = depth_under_force(press, Plane(Vec3::Zero(), Vec3::UnitZ(), 10.0), 0.0);
    EXPECT_NEAR(felt.noise_m, noise_m, 0.1 * noise_m);
    EXPECT_EQ(felt.is_rigid(), noise_m > 5e-5);
  }
}

TEST(DepthUnderForce, TellsARigidObjectFromOneThatGivesWay) {
  for (const double stiffness : {300.0, 2e4, 1e5, 1e7}) {
    for (const double radius : {0.0, 0.002}) {
      recording::Recording press;
      for (int i = 0; i < 400; ++i) {
        const double force = 2.0 * std::max(0.0, std::sin(0.05 * i));  // half of the time in the air
        press.motion.t_s.push_back(0.01 * i);
        press.motion.p_W_m.emplace_back(0.0, 0.0, radius + (force > 0.0 ? -force / stiffness : 0.003));
        press.f_W_N.emplace_back(0.0, 0.0, force);
      }
      const Plane plane(Vec3::Zero(), Vec3::UnitZ(), 1.0);
      const DepthUnderForce felt = depth_under_force(press, plane, radius);
      EXPECT_NEAR(felt.force_N / felt.depth_m, stiffness, 1e-6 * stiffness);
      EXPECT_EQ(felt.is_rigid(), stiffness > 41.5e3) << stiffness;
      press.f_W_N.assign(400, Vec3::Zero());
      EXPECT_FALSE(depth_under_force(press, plane, radius).is_rigid()) << "nothing is felt";
    }
  }
}

}  // namespace
}  // namespace touchstone::rendering
