// The truth generator: Coulomb, Hooke and contact hold exactly at every instant, on open and closed surfaces.
#include "rigid_scan.h"

#include <gmock/gmock.h>

#include "harness/base/error.h"
#include "harness/testing/steps.h"
#include "recipe.h"
#include "synthetic/surface_catalogue.h"

namespace touchstone::datasets {
using synthetic::HeightField;
using synthetic::make_surface;
using synthetic::RadialBody;

namespace {

constexpr std::uint64_t seed = 42;

class EveryRecipe : public ::testing::TestWithParam<std::size_t> {
 protected:
  [[nodiscard]] const Recipe& chosen() const { return recipes()[GetParam()]; }
};

INSTANTIATE_TEST_SUITE_P(Bundled, EveryRecipe, ::testing::Range<std::size_t>(0, recipes().size()),
                         [](const auto& instance) { return recipes()[instance.param].name; });

TEST_P(EveryRecipe, ObeysCoulombAndStaysOnTheSurface) {
  const RigidScan scan = make_scan(chosen(), seed);
  const auto surface = make_surface(chosen().surface, chosen().parameters);
  const Contact& contact = scan.contact();
  int in_contact = 0;
  for (const double t : testing::steps(0.0, scan.duration_s(), 0.0173)) {
    const ScanTruth at = scan.at(t);
    EXPECT_NEAR(at.n_W.norm(), 1.0, 1e-14);
    // The ball's centre keeps radius and gap from the surface: a search over the whole surface finds nothing closer.
    EXPECT_NEAR(surface->closest(at.p_W_m).signed_distance_m, contact.tip_radius_m + at.gap_m, 1e-15);
    const double normal = at.f_W_N.dot(at.n_W);
    const Vec3 tangential = at.f_W_N - normal * at.n_W;
    EXPECT_NEAR(normal, at.normal_force_N, 1e-12);
    if (at.normal_force_N == 0.0) {
      EXPECT_EQ(at.f_W_N, Vec3::Zero());
      continue;
    }
    ++in_contact;
    EXPECT_EQ(at.gap_m, 0.0);
    EXPECT_GT(at.normal_force_N, 0.0);
    if (at.v_t_W_m_per_s.norm() == 0.0) {
      EXPECT_LT(tangential.norm(), 1e-12);
    } else {
      EXPECT_NEAR(tangential.norm(), contact.mu * at.normal_force_N, 1e-12);
      EXPECT_NEAR(tangential.normalized().dot(at.v_t_W_m_per_s.normalized()), -1.0, 1e-12);
      // Against the velocity of the centre itself, by a difference of another order.
      const double h = 2e-5;
      const Vec3 v = (scan.at(t + h).p_W_m - scan.at(t - h).p_W_m) / (2.0 * h);
      EXPECT_LT((v - v.dot(at.n_W) * at.n_W - at.v_t_W_m_per_s).norm(), 1e-6);
    }
    // The hand can do no work on a rigid object but through friction: power into the object is not negative.
    EXPECT_LE(at.f_W_N.dot(at.v_t_W_m_per_s), 0.0);
  }
  EXPECT_GT(in_contact, 600);
}

TEST_P(EveryRecipe, HookeGivesTheNormalForceBack) {
  const RigidScan scan = make_scan(chosen(), seed);
  const auto surface = make_surface(chosen().surface, chosen().parameters);
  const double r = scan.contact().tip_radius_m;
  for (const double k : {300.0, 500.0, 5000.0}) {
    for (const double t : testing::steps(0.0, scan.duration_s(), 0.0371)) {
      const ScanTruth at = scan.at(t);
      const Vec3 in = RigidScan::in_trajectory_W_m(at, r, k);
      const double depth = r - surface->closest(in).signed_distance_m;
      EXPECT_NEAR(k * std::max(0.0, depth), at.normal_force_N, 1e-11);
    }
  }
}

TEST_P(EveryRecipe, BallFitsEveryHollow) {
  const auto surface = make_surface(chosen().surface, chosen().parameters);
  const auto* const body = dynamic_cast<const RadialBody*>(surface.get());
  if (body == nullptr) return;
  EXPECT_LT(body->largest_curvature().concave_per_m * chosen().contact.tip_radius_m, 0.5);
}

TEST_P(EveryRecipe, TapsStandAtBothEnds) {
  const RigidScan scan = make_scan(chosen(), seed);
  std::vector<ScanScript::Window> taps;
  double slides_from = scan.duration_s();
  double slides_to = 0.0;
  for (const auto& window : scan.script().windows()) {
    if (window.touch == Touch::tap) taps.push_back(window);
    if (window.touch == Touch::slide) {
      slides_from = std::min(slides_from, window.from_s);
      slides_to = std::max(slides_to, window.to_s);
    }
  }
  ASSERT_EQ(taps.size(), 4U);
  EXPECT_LT(taps[1].to_s, slides_from);
  EXPECT_GT(taps[2].from_s, slides_to);
  for (const auto& tap : taps) {
    EXPECT_NEAR(scan.at(0.5 * (tap.from_s + tap.to_s)).normal_force_N, 2.5, 1e-9);
    EXPECT_LT(scan.at(tap.from_s - 0.01).normal_force_N, 1e-12);
    EXPECT_LT(scan.at(tap.to_s + 0.01).normal_force_N, 1e-12);
  }
}

TEST(RigidScan, CompliantObjectGivesWayByItsHooke) {
  const auto surface = make_surface("gauss");
  const auto guide = std::make_shared<HeightFieldGuide>(dynamic_cast<const HeightField&>(*surface));
  std::vector<Leg> legs{{Touch::free, 0.3, Vec3(-0.01, 0, 0)},
                        {Touch::slide, 2.0, Vec3(0.01, 0.002, 0)},
                        {Touch::free, 0.3, Vec3(0.01, 0.002, 0)}};
  const RigidScan scan(guide, ScanScript(Vec3(-0.01, 0, 0), legs, HandModel{}, seed), {0.0005, 2000.0, 0.3});
  for (const double t : testing::steps(0.0, 2.6, 0.01)) {
    const ScanTruth at = scan.at(t);
    const double depth = 0.0005 - surface->closest(at.p_W_m).signed_distance_m;
    EXPECT_NEAR(at.normal_force_N, 2000.0 * std::max(0.0, depth), 1e-9);
  }
}

TEST(RigidScan, BallRollsOverAnEdge) {
  const auto surface = make_surface("wedge");
  const auto guide = std::make_shared<ClosestPointGuide>(*surface);
  std::vector<Leg> legs{{Touch::free, 0.3, Vec3(0.01, 0, 0.002)},
                        {Touch::slide, 2.0, Vec3(-0.01, 0, 0.002)},
                        {Touch::free, 0.3, Vec3(-0.01, 0, 0.002)}};
  HandModel hand;
  hand.tremor = 0.0;
  const RigidScan scan(guide, ScanScript(Vec3(0.01, 0, 0.002), legs, hand, seed),
                       {0.001, std::numeric_limits<double>::infinity(), 0.3});
  int at_edge = 0;
  for (const double t : testing::steps(0.3, 2.3, 0.005)) {
    const ScanTruth at = scan.at(t);
    EXPECT_NEAR(surface->closest(at.p_W_m).signed_distance_m, 0.001 + at.gap_m, 1e-15);
    at_edge += at.contact_W_m.norm() < 1e-12 ? 1 : 0;
  }
  EXPECT_GT(at_edge, 10);
  EXPECT_THROW(guide->at(Vec3(0, 0, -0.01)), UsageError);
}

TEST(ScanScript, RefusesScansThatBeginInContact) {
  EXPECT_THROW(ScanScript(Vec3::Zero(), {}, HandModel{}, 1), UsageError);
  EXPECT_THROW(ScanScript(Vec3::Zero(), {{Touch::slide, 1.0, Vec3::Zero()}}, HandModel{}, 1), UsageError);
  EXPECT_THROW(ScanScript(Vec3::Zero(), {{Touch::free, 0.0, Vec3::Zero()}}, HandModel{}, 1), UsageError);
}

}  // namespace
}  // namespace touchstone::datasets
