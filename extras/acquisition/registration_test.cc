#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "contact_registration.h"
#include "harness/base/error.h"
#include "harness/base/random.h"
#include "rigid_registration.h"

namespace touchstone::acquisition {
namespace {

using testing::HasSubstr;

std::string complaint(const std::function<void()>& act) {
  try {
    act();
  } catch (const BadData& error) {
    return error.what();
  }
  return "accepted";
}

RigidTransform somewhere(Random& random, double scale) { return {random.rotation(), 3 * scale * random.direction()}; }

// An ellipsoid, whose closest points are found by Newton's method on the Lagrange multiplier: all six directions count.
class Ellipsoid : public surface::Surface {
 public:
  explicit Ellipsoid(Vec3 axes) : axes_(std::move(axes)) {}
  [[nodiscard]] surface::SurfacePoint closest(const Vec3& p) const override {
    // sum (a_i p_i / (t + a_i^2))^2 = 1, decreasing and convex in t right of -min a^2: bisect.
    const Vec3 squares = axes_.cwiseAbs2();
    double low = -squares.minCoeff() + axes_.minCoeff() * std::abs(p[0]) * 0.0, high = axes_.maxCoeff() * p.norm();
    for (int i = 0; i < 200; ++i) {
      const double t = 0.5 * (low + high);
      const double g = (axes_.cwiseProduct(p).array() / (t + squares.array())).square().sum();
      (g > 1 ? low : high) = t;
    }
    const double t = 0.5 * (low + high);
    const Vec3 q = (squares.cwiseProduct(p).array() / (t + squares.array())).matrix();
    const Vec3 n = (q.array() / squares.array()).matrix().normalized();
    const double distance = (p - q).norm();
    return {q, n, distance, (p - q).dot(n) < 0 ? -distance : distance, -1, surface::Feature::analytic};
  }
  [[nodiscard]] std::optional<surface::Crossing> first_crossing(const Vec3&, const Vec3&) const override {
    return std::nullopt;
  }
  [[nodiscard]] Box3 bounds() const override { return {-axes_, axes_}; }
  [[nodiscard]] Vec3 point(Random& random) const {
    const Vec3 u = random.direction();
    return axes_.cwiseProduct(u);
  }

 private:
  Vec3 axes_;
};

class Plane : public surface::Surface {
 public:
  [[nodiscard]] surface::SurfacePoint closest(const Vec3& p) const override {
    return {Vec3(p.x(), p.y(), 0), Vec3::UnitZ(), std::abs(p.z()), p.z(), -1, surface::Feature::analytic};
  }
  [[nodiscard]] std::optional<surface::Crossing> first_crossing(const Vec3&, const Vec3&) const override {
    return std::nullopt;
  }
  [[nodiscard]] Box3 bounds() const override { return {}; }
};

TEST(MarkerRegistration, IsExactWithoutNoiseAtEveryScale) {
  Random random(31);
  for (const double scale : {1e-3, 1.0, 1e3}) {
    for (int trial = 0; trial < 20; ++trial) {
      const RigidTransform truth = somewhere(random, scale);
      std::vector<Vec3> tracker, object;
      for (int i = 0; i < 4; ++i) {
        tracker.push_back(scale * random.direction());
        object.push_back(truth.point(tracker.back()));
      }
      const auto found = register_markers(tracker, object, "markers.csv");
      EXPECT_LT(found.tracker_to_object.q.angularDistance(truth.q), 1e-7);
      EXPECT_LT(found.residual_rms_m, 1e-13 * scale);
      EXPECT_NEAR(found.tracker_to_object.q.norm(), 1.0, 1e-14);
    }
  }
}

TEST(MarkerRegistration, NeverMirrors) {
  const std::vector<Vec3> tracker{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 1}};
  std::vector<Vec3> mirrored;
  for (const Vec3& p : tracker) mirrored.push_back(Vec3(-p.x(), p.y(), p.z()));
  const auto found = register_markers(tracker, mirrored, "markers.csv");
  EXPECT_NEAR(found.tracker_to_object.q.toRotationMatrix().determinant(), 1.0, 1e-12);
  EXPECT_GT(found.residual_rms_m, 0.1);  // and says that it does not fit
}

TEST(MarkerRegistration, ForetellsTheErrorAtATarget) {
  Random random(32);
  const std::vector<Vec3> tracker{
      {0.1, 0, 0}, {-0.05, 0.08, 0}, {0, -0.09, 0.04}, {0.02, 0.03, -0.07}, {-0.06, -0.05, 0.02}};
  const Vec3 target(0.15, 0.1, 0.05);
  constexpr double noise = 1e-4;
  double squared = 0.0, foretold = 0.0;
  constexpr int trials = 400;
  for (int trial = 0; trial < trials; ++trial) {
    const RigidTransform truth = somewhere(random, 0.3);
    std::vector<Vec3> object, seen;
    for (const Vec3& p : tracker) {
      object.push_back(truth.point(p));
      seen.push_back(p + noise * Vec3(random.normal(), random.normal(), random.normal()));
    }
    const auto found = register_markers(seen, object, "markers.csv");
    squared += (found.tracker_to_object.point(target) - truth.point(target)).squaredNorm() / trials;
    foretold += std::pow(found.expected_error_m(truth.point(target)), 2) / trials;
  }
  EXPECT_NEAR(std::sqrt(foretold / squared), 1.0, 0.1);
}

TEST(MarkerRegistration, RefusesMarkersThatCannotTell) {
  EXPECT_THAT(complaint([] {
                register_markers({{0, 0, 0}, {1, 0, 0}}, {{0, 0, 0}, {1, 0, 0}}, "m.csv");
              }),
              HasSubstr("at least 3"));
  const std::vector<Vec3> line{{0, 0, 0}, {1, 1, 0}, {2, 2, 0}, {5, 5, 0}};
  EXPECT_THAT(complaint([&] { register_markers(line, line, "m.csv"); }), HasSubstr("one line"));
  EXPECT_THAT(complaint([&] { register_markers(line, {line[0]}, "m.csv"); }), HasSubstr("same order"));
}

// A tracker, or a scan, whose lengths are 1 to 3 % off bends the place by a millimetre; noise of the markers does not.
TEST(MarkerRegistration, RefusesLengthsThatDifferByAFactor) {
  Random random(87);
  for (int trial = 0; trial < 1000; ++trial) {
    const double factor = trial % 2 == 0 ? 1.0 : 1.0 + (trial % 4 == 1 ? 1 : -1) * random.uniform(0.012, 0.03);
    const RigidTransform there = somewhere(random, 0.1);
    std::vector<Vec3> object, tracker;
    for (int i = 0; i < 5 + trial % 3; ++i) {
      object.push_back(0.09 * random.direction());
      tracker.push_back(factor * there.point(object.back()) +
                        1.5e-4 * Vec3(random.normal(), random.normal(), random.normal()));
    }
    const auto said = complaint([&] { register_markers(tracker, object, "markers.csv"); });
    if (factor == 1.0) {
      EXPECT_EQ(said, "accepted");
    } else {
      EXPECT_THAT(said, HasSubstr("farther from each other than on the object")) << factor;
    }
  }
}

TEST(ContactRegistration, BringsContactsBackOntoTheSurfaceAtEveryScale) {
  Random random(33);
  for (const double scale : {1e-3, 1.0, 1e3}) {
    const Ellipsoid surface(scale * Vec3(0.03, 0.045, 0.06));
    const double radius = 0.0015 * scale;
    // Off by half a millimetre and half a degree, as markers leave it.
    const Quat dq(Eigen::AngleAxisd(0.009, random.direction()));
    const RigidTransform off{dq, 0.0005 * scale * random.direction()};
    std::vector<Vec3> centers, truth;
    for (int i = 0; i < 150; ++i) {
      const Vec3 p = surface.point(random);
      truth.push_back(p + radius * surface.closest(p * 1.001).n_W);
      centers.push_back(off.q.conjugate() * (truth.back() - off.t_m));
    }
    const auto found = register_contacts(surface, centers, radius, {}, "contacts");
    EXPECT_GT(found.rms_before_m, 1e-4 * scale);
    EXPECT_LT(found.rms_after_m, 1e-9 * scale);
    EXPECT_EQ(found.determined_directions, 6);
    EXPECT_TRUE(found.converged);
    for (std::size_t i = 0; i < truth.size(); i += 10)
      EXPECT_LT((found.correction.point(centers[i]) - truth[i]).norm(), 1e-6 * scale);
  }
}

TEST(ContactRegistration, ContactsThatAreWrongCountLess) {
  Random random(34);
  const Ellipsoid surface(Vec3(0.03, 0.045, 0.06));
  std::vector<Vec3> centers;
  for (int i = 0; i < 200; ++i) {
    const Vec3 p = surface.point(random);
    const double lift = i % 20 == 0 ? 0.004 : 1e-5 * random.normal();  // one in twenty was not a contact at all
    centers.push_back(p + (0.001 + lift) * surface.closest(p * 1.001).n_W + Vec3(3e-4, -2e-4, 1e-4));
  }
  const auto found = register_contacts(surface, centers, 0.001, {}, "contacts");
  EXPECT_LT((found.correction.t_m - Vec3(-3e-4, 2e-4, -1e-4)).norm(), 3e-5);
  EXPECT_GT(found.residual_after_m[0], 0.003);  // the residual map shows it
}

TEST(ContactRegistration, LeavesAloneWhatTheContactsDoNotTell) {
  Random random(35);
  std::vector<Vec3> centers;
  for (int i = 0; i < 50; ++i)
    centers.push_back(Vec3(random.uniform(-0.05, 0.05), random.uniform(-0.05, 0.05), 0.0021));
  const auto found = register_contacts(Plane(), centers, 0.001, {}, "contacts");
  EXPECT_EQ(found.determined_directions, 3);
  EXPECT_NEAR(found.correction.t_m.z(), -0.0011, 1e-9);
  EXPECT_NEAR(found.correction.t_m.head<2>().norm(), 0.0, 1e-9);
  EXPECT_THAT(complaint([&] { register_contacts(Plane(), {centers[0]}, 0.001, {}, "contacts"); }),
              HasSubstr("at least 6"));
}

TEST(BallContact, LiesOneRadiusBelowTheCentre) {
  const auto contact = ball_contact(Plane(), Vec3(0.01, 0.02, 0.0025), 0.003);
  EXPECT_NEAR((contact.contact_W_m - Vec3(0.01, 0.02, 0)).norm(), 0, 1e-15);
  EXPECT_NEAR(contact.gap_m, -0.0005, 1e-15);
}

}  // namespace
}  // namespace touchstone::acquisition
