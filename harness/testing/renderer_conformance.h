// What every renderer must keep, as a GoogleTest suite that a new one joins by one line:
//
//   #include "harness/testing/renderer_conformance.h"
//   TOUCHSTONE_RENDERER_CONFORMANCE(MyRenderer, std::vector<RendererSubject>{my_subject()});
//
// in a test program that links touchstone::testing, touchstone::testing_alloc and GoogleTest. Every subject runs on
// every shape below. An ability that a renderer declares it lacks (harness/rendering/limitation.h) skips with its
// reason shown.
//
// Invariants, for tips p(t), forces f, stiffness k, friction coefficient mu, unit of length u:
//   1  reset:         after reset() the same tips give the same results, bit for bit
//   2  rigid motion:  f(R p + s, R world + s) = R f(p, world), to rounding
//   3  unit:          f(u p, u world, k / u) = f(p, world), to rounding
//   4  free space:    no contact and f = 0 where the tip is outside
//   5  friction cone: f = f_n n + f_t with f_n >= 0 and |f_t| <= mu f_n
//   6  passivity:     sum f_i . (p_i+1 - p_i) <= k/2 sum |p_i+1 - p_i|^2 over a loop that starts and ends free: what a
//                     held force gives to the hand is bounded by what sampling alone gives, which vanishes with the
//                     steps
//   7  first touch:   the first and the last force of a contact is at most k times the tip's step
//   8  allocation:    step() allocates nothing
//   9  bad input:     NaN, infinity and time that does not advance are refused, and what follows is as if they had not
//   been
//  10  contact point: on or above the surface
//  11  what the abilities promise: thin shells, large jumps, a start inside
//
// On every subject, not on every shape: the faults that harness/diagnosis knows by name, on meshes of its own
// (RendererBehaviour, harness/testing/renderer_behaviour.h).
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <limits>
#include <memory>
#include <string>
#include <tuple>
#include <vector>

#include "harness/base/random.h"
#include "harness/base/rotations.h"
#include "harness/diagnosis/engine.h"
#include "harness/rendering/limitation.h"
#include "harness/rendering/renderer.h"
#include "harness/rendering/renderer_failed.h"
#include "harness/surface/embree_surface.h"
#include "harness/testing/allocation_guard.h"
#include "harness/testing/renderer_behaviour.h"
#include "harness/testing/tiny_meshes.h"

namespace touchstone::testing {

struct ConformanceBody {
  surface::TriangleMesh mesh;  // about 40 mm in size
  bool closed;
  bool flat;  // touched from above only: its other sides are too near or not there
  double thickness_m = std::numeric_limits<double>::infinity();
  bool level = false;  // a tip that went straight down through it stays on its top
};

// A parameter of the suite is copied for each of its cases in every process that runs one of them, so it has no mesh.
struct ConformanceShape {
  std::string name;
  std::function<ConformanceBody()> make;
};

inline void PrintTo(const ConformanceShape& shape, std::ostream* out) { *out << shape.name; }

inline std::vector<ConformanceShape> conformance_shapes() {
  constexpr double kAnyThickness = std::numeric_limits<double>::infinity();
  const auto plate = [] {
    surface::TriangleMesh mesh = cube(0.02);
    for (Vec3& v : mesh.vertices_W_m) v.z() *= 0.005;  // 0.2 mm thick
    return ConformanceBody{mesh, true, true, 2e-4, true};
  };
  return {{"cube",
           [] {
             return ConformanceBody{cube(0.02), true, false, kAnyThickness, true};
           }},
          {"ball",
           [] {
             return ConformanceBody{ball(0.02, 4), true, false};
           }},
          {"torus",
           [] {
             return ConformanceBody{torus(0.02, 0.008, 48, 24), true, false};
           }},
          {"plate", plate},
          {"sheet", [] {
             return ConformanceBody{grid(0.02, 12), false, true, kAnyThickness, true};
           }}};
}

// A pose and unit of the world.
struct ConformancePose {
  Quat turn = Quat::Identity();
  Vec3 shift = Vec3::Zero();
  double unit = 1.0;
  [[nodiscard]] Vec3 operator()(const Vec3& p) const { return turn * (unit * p) + shift; }
};

class RendererConformance : public ::testing::TestWithParam<std::tuple<RendererSubject, ConformanceShape>> {
 protected:
  using Pose = ConformancePose;

  void SetUp() override {
    if (!(shape().thickness_m < subject().thinnest_m)) return;
    const rendering::Limitation* const limit = lacks(rendering::Ability::thin_shells);
    ASSERT_NE(limit, nullptr) << "what is not felt at all must be declared";
    GTEST_SKIP() << limit->reason;
  }

  [[nodiscard]] const RendererSubject& subject() const { return std::get<0>(GetParam()); }
  [[nodiscard]] const std::string& shape_name() const { return std::get<1>(GetParam()).name; }
  [[nodiscard]] const ConformanceBody& shape() const { return shape_; }
  [[nodiscard]] const rendering::Limitation* lacks(rendering::Ability ability) const {
    return find_limitation(subject().cannot, ability);
  }

  [[nodiscard]] std::shared_ptr<const surface::Surface> surface(const Pose& pose = {}) const {
    return make_embree_surface(moved(shape().mesh, pose.turn, pose.shift, pose.unit));
  }
  [[nodiscard]] std::unique_ptr<rendering::Renderer> make(const Pose& pose = {}) const {
    return subject().make(subject().queries(moved(shape().mesh, pose.turn, pose.shift, pose.unit)), pose.unit);
  }

  // Taps, strokes at up to 0.5 mm depth and retreats all about the shape; begins and ends outside. A stroke does not
  // turn round a sharp edge: there the force of a right renderer may jump.
  [[nodiscard]] std::vector<Vec3> strokes(std::uint64_t seed, int contacts) const {
    const auto at = surface();
    const double clear = subject().tip_radius_m + 1e-3;
    Random random(seed);
    std::vector<Vec3> tips;
    for (int contact = 0; contact < contacts; ++contact) {
      Vec3 from = 0.05 * random.direction();
      if (shape().flat) from = {0.012 * random.uniform(-1, 1), 0.012 * random.uniform(-1, 1), 0.03};
      if (contact > 0) fly_round(tips, from);
      surface::SurfacePoint foot = at->closest(from);
      const Vec3 first_n = foot.n_W;
      const Vec3 along = random.direction();
      for (int i = 0; i <= 300; ++i) {
        const double press = i < 100 ? i / 100.0 : i <= 200 ? 1.0 : (300 - i) / 100.0;
        const double depth = press * (clear + 5e-4) - clear;
        // Beside the foot: straight over edges and vertices two answers are equally right.
        tips.push_back(foot.p_W_m + (subject().tip_radius_m - depth) * foot.n_W + Vec3(2.1e-5, -3.3e-5, 4.7e-5));
        if (i < 100 || i >= 200) continue;
        Vec3 next = foot.p_W_m + 3e-5 * (along - along.dot(foot.n_W) * foot.n_W);
        if (shape().flat) next = next.cwiseMax(-0.015).cwiseMin(0.015);
        const surface::SurfacePoint reached = at->closest(next);
        if (reached.n_W.dot(first_n) > 0.8) foot = reached;
      }
    }
    tips.push_back(2.0 * tips.back());
    return tips;
  }

  static std::vector<rendering::StepResult> run(rendering::Renderer& renderer, const std::vector<Vec3>& tips,
                                                const Pose& pose = {}) {
    renderer.reset();
    std::vector<rendering::StepResult> results;
    results.reserve(tips.size());
    for (std::size_t i = 0; i < tips.size(); ++i) results.push_back(step(renderer, i, pose(tips[i])));
    return results;
  }
  static rendering::StepResult step(rendering::Renderer& renderer, std::size_t tick, const Vec3& p) {
    const rendering::StepResult result = renderer.step({static_cast<double>(tick + 1) * 1e-3, p, Quat::Identity()});
    // Its zero force would pass for free space.
    if (result.status == rendering::StepStatus::failed) throw rendering::RendererFailed(renderer.failure());
    return result;
  }

  void expect_same_forces(const Pose& pose) const {
    constexpr double kEps = std::numeric_limits<double>::epsilon();
    const auto tips = strokes(101, 8);
    const auto here = make();
    const auto there = make(pose);
    const auto expected = run(*here, tips);
    const auto obtained = run(*there, tips, pose);
    // Moving the mesh rounds its vertices: a tilt of eps |x| / (height of a triangle), for at most 1 mm of depth.
    const double lengths = 0.1 + pose.shift.norm() / pose.unit;
    const double tilt = std::max(1e3, 1e-3 / least_height_m());
    const double tolerance_N = subject().stiffness_N_per_m * lengths * tilt * kEps;
    std::size_t touching = 0;
    for (std::size_t i = 0; i < tips.size(); ++i) {
      ASSERT_LE((pose.turn.conjugate() * obtained[i].f_W_N - expected[i].f_W_N).norm(), tolerance_N)
          << "step " << i << ": " << (pose.turn.conjugate() * obtained[i].f_W_N).transpose() << " N against "
          << expected[i].f_W_N.transpose();
      touching += expected[i].contact ? 1U : 0U;
    }
    if (touching == 0U && !feels_exactly())
      GTEST_SKIP() << kNotReached << lacks(rendering::Ability::surface_contact)->reason;
    EXPECT_GT(touching, 100U) << "the strokes must touch";
  }

  // Else it may round an edge off by more than the strokes are deep.
  [[nodiscard]] bool feels_exactly() const { return lacks(rendering::Ability::surface_contact) == nullptr; }
  static constexpr const char* kNotReached = "the strokes do not reach what it feels: ";

 private:
  // Of all triangles with an area.
  [[nodiscard]] double least_height_m() const {
    double least = std::numeric_limits<double>::infinity();
    const surface::TriangleMesh& mesh = shape().mesh;
    for (const auto& corners : mesh.triangles) {
      const auto at = [&](std::size_t i) { return mesh.vertices_W_m[static_cast<std::size_t>(corners[i])]; };
      const Vec3 a = at(1) - at(0);
      const Vec3 b = at(2) - at(0);
      const double longest = std::max({a.norm(), b.norm(), (b - a).norm()});
      const double height = a.cross(b).norm() / longest;
      if (height > 0.0) least = std::min(least, height);
    }
    return least;
  }

  // Well outside, by the great circle, to over the place where the next contact begins; of a flat shape straight up and
  // down again.
  void fly_round(std::vector<Vec3>& tips, const Vec3& to) const {
    if (shape().flat) return tips.push_back({tips.back().x(), tips.back().y(), 0.04});
    const Quat turn = shortest_rotation(tips.back(), to);
    const Vec3 from = 0.08 * tips.back().normalized();
    for (int i = 0; i <= 20; ++i) tips.push_back(Quat::Identity().slerp(i / 20.0, turn) * from);
    tips.push_back(to);
  }

  const ConformanceBody shape_ = std::get<1>(GetParam()).make();
};

inline std::string conformance_name(const ::testing::TestParamInfo<RendererConformance::ParamType>& of) {
  return std::get<0>(of.param).name + "_" + std::get<1>(of.param).name;
}

GTEST_ALLOW_UNINSTANTIATED_PARAMETERIZED_TEST(RendererConformance);

TEST_P(RendererConformance, ResetGivesTheSameRunToTheBit) {
  const auto tips = strokes(100, 6);
  const auto renderer = make();
  const auto first = run(*renderer, tips);
  // A different run between leaves nothing behind either.
  run(*renderer, strokes(99, 2));
  const auto again = run(*renderer, tips);
  const auto fresh = make();
  const auto other = run(*fresh, tips);
  for (std::size_t i = 0; i < tips.size(); ++i) {
    ASSERT_EQ(first[i].f_W_N, again[i].f_W_N) << "step " << i;
    ASSERT_EQ(first[i].contact_W_m, again[i].contact_W_m) << "step " << i;
    ASSERT_EQ(first[i].f_W_N, other[i].f_W_N) << "step " << i << " of another instance";
  }
}

TEST_P(RendererConformance, RigidMotionOfTheWorldChangesNothing) {
  if (const auto* limit = lacks(rendering::Ability::rigid_motion)) GTEST_SKIP() << limit->reason;
  expect_same_forces({Quat(0.83, 0.31, -0.41, 0.22).normalized(), {0.3, -0.2, 0.1}, 1.0});
}

TEST_P(RendererConformance, TheUnitOfLengthChangesNothing) {
  if (const auto* limit = lacks(rendering::Ability::unit_scale)) GTEST_SKIP() << limit->reason;
  for (const double unit : {1e3, 1e-3, 25.4}) {
    SCOPED_TRACE(unit);
    expect_same_forces({Quat::Identity(), Vec3::Zero(), unit});
  }
}

TEST_P(RendererConformance, NoForceInFreeSpace) {
  const auto renderer = make();
  const auto at = surface();
  Random random(102);
  renderer->reset();
  std::size_t tick = 0;
  for (int i = 0; i < 500; ++i) {
    // From one free place to the next by a way outside the box about the shape (of a sheet: in front of it, and of one
    // that is not plane in front of its rim's tangents, too).
    Vec3 p = random.log_uniform(0.036, 1.0) * random.direction();
    if (shape().flat) p.z() = std::abs(p.z());
    if (!shape().closed) p.z() += 2.0 * p.head<2>().norm();
    if (at->closest(p).distance_m <= 1.001 * subject().tip_radius_m) continue;
    const Vec3 far = 2.0 * p.normalized();
    for (const Vec3& tip : {Vec3(far), p, Vec3(far)}) {
      const rendering::StepResult result = step(*renderer, tick++, tip);
      ASSERT_FALSE(result.contact) << tip.transpose();
      ASSERT_EQ(result.f_W_N, Vec3::Zero()) << tip.transpose();
      ASSERT_EQ(result.contact_W_m, tip);
    }
    // The next leg starts where a straight way cannot meet the shape.
    renderer->reset();
  }
}

TEST_P(RendererConformance, ForceStaysInTheFrictionConeAndNeverPulls) {
  const auto renderer = make();
  const auto results = run(*renderer, strokes(103, 8));
  const double rounding_N = subject().stiffness_N_per_m * 0.1 * 64 * std::numeric_limits<double>::epsilon();
  for (std::size_t i = 0; i < results.size(); ++i) {
    const rendering::StepResult& now = results[i];
    if (!now.contact) {
      ASSERT_EQ(now.f_W_N, Vec3::Zero()) << "step " << i;
      continue;
    }
    ASSERT_NEAR(now.n_W.norm(), 1.0, 1e-12) << "step " << i;
    const double normal_N = now.f_W_N.dot(now.n_W);
    const double tangential_N = (now.f_W_N - normal_N * now.n_W).norm();
    ASSERT_GE(normal_N, -rounding_N) << "step " << i;
    ASSERT_LE(tangential_N, subject().friction * normal_N * (1.0 + 1e-12) + rounding_N) << "step " << i;
  }
}

TEST_P(RendererConformance, ClosedLoopsGiveNoEnergyBack) {
  if (const auto* limit = lacks(rendering::Ability::passive)) GTEST_SKIP() << limit->reason;
  const auto renderer = make();
  const auto tips = strokes(104, 8);
  const auto results = run(*renderer, tips);
  double given_J = 0.0;
  double sampling_J = 0.0;
  double rounding_J = 0.0;
  for (std::size_t i = 0; i + 1 < tips.size(); ++i) {
    const Vec3 d = tips[i + 1] - tips[i];
    given_J += results[i].f_W_N.dot(d);
    // Only steps that start or end in contact: the flights between are long.
    if (results[i].contact || results[i + 1].contact) sampling_J += 0.5 * subject().stiffness_N_per_m * d.squaredNorm();
    rounding_J += 1e-13 * results[i].f_W_N.norm();
    if (!results[i + 1].contact) {
      ASSERT_LE(given_J, sampling_J + rounding_J) << "up to step " << i + 1;
    }
  }
}

TEST_P(RendererConformance, ContactBeginsAndEndsWithoutAJump) {
  if (const auto* limit = lacks(rendering::Ability::continuous_force)) GTEST_SKIP() << limit->reason;
  const auto renderer = make();
  const auto at = surface();
  const auto tips = strokes(105, 12);
  const auto results = run(*renderer, tips);
  int contacts = 0;
  for (std::size_t i = 1; i < tips.size(); ++i) {
    if (results[i].contact == results[i - 1].contact) continue;
    // Friction may hold on to one face of a sharp edge while the tip leaves by the other.
    const bool past_edge = subject().friction > 0.0 && shape_name() == "cube" && results[i - 1].contact &&
                           at->signed_distance(tips[i - 1]) > subject().tip_radius_m;
    if (past_edge) continue;
    const Vec3& f = results[i].contact ? results[i].f_W_N : results[i - 1].f_W_N;
    const double most_N = subject().stiffness_N_per_m * (tips[i] - tips[i - 1]).norm() * (1.0 + subject().friction);
    ASSERT_LE(f.norm(), most_N * (1.0 + 1e-9)) << "step " << i;
    contacts += results[i].contact ? 1 : 0;
  }
  if (contacts == 0 && !feels_exactly())
    GTEST_SKIP() << kNotReached << lacks(rendering::Ability::surface_contact)->reason;
  // Samples further apart than the strokes are deep may round off what a stroke should meet.
  const bool may_miss = subject().thinnest_m > 0.0;
  EXPECT_TRUE(may_miss || contacts >= 12) << contacts;
}

TEST_P(RendererConformance, StepAllocatesNothing) {
  if (subject().queries_allocate) GTEST_SKIP() << "the exact queries allocate, the fast ones do not";
  if (!allocations_are_counted()) GTEST_SKIP() << "the thread sanitizer does not let allocations be counted";
  const auto renderer = make();
  const auto tips = strokes(106, 6);
  renderer->reset();
  const AllocationGuard guard;
  for (std::size_t i = 0; i < tips.size(); ++i) step(*renderer, i, tips[i]);
  EXPECT_EQ(guard.count(), 0U);
}

TEST_P(RendererConformance, RefusesBadInputAndStaysAsItWas) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  constexpr double kInf = std::numeric_limits<double>::infinity();
  const auto tips = strokes(107, 3);
  const auto renderer = make();
  const auto expected = run(*renderer, tips);
  renderer->reset();
  for (std::size_t i = 0; i < tips.size(); ++i) {
    const double t_s = static_cast<double>(i + 1) * 1e-3;
    for (const rendering::TipState& bad :
         {rendering::TipState{t_s, {kNan, 0, 0}, Quat::Identity()},
          rendering::TipState{t_s, {0, 0, kInf}, Quat::Identity()},
          rendering::TipState{kNan, tips[i], Quat::Identity()}, rendering::TipState{kInf, tips[i], Quat::Identity()},
          rendering::TipState{t_s, tips[i], Quat(kNan, 0, 0, 0)},
          rendering::TipState{i > 0 ? t_s - 1e-3 : kNan, tips[i], Quat::Identity()}}) {
      if (i % 7 != 0) break;
      const rendering::StepResult refused = renderer->step(bad);
      ASSERT_EQ(refused.status, rendering::StepStatus::refused);
      ASSERT_EQ(refused.f_W_N, Vec3::Zero());
      ASSERT_FALSE(refused.contact);
    }
    ASSERT_EQ(step(*renderer, i, tips[i]).f_W_N, expected[i].f_W_N) << "step " << i;
  }
}

TEST_P(RendererConformance, SurfaceContactPointIsOnOrAboveTheSurface) {
  if (const auto* limit = lacks(rendering::Ability::surface_contact)) GTEST_SKIP() << limit->reason;
  const auto renderer = make();
  const auto at = surface();
  const auto tips = strokes(108, 8);
  const auto results = run(*renderer, tips);
  for (std::size_t i = 0; i < tips.size(); ++i) {
    if (!results[i].contact) continue;
    const double gap = at->signed_distance(results[i].contact_W_m) - subject().tip_radius_m;
    ASSERT_GE(gap, -1e-3 * 64 * 1e4 * std::numeric_limits<double>::epsilon()) << "step " << i;
    ASSERT_LE((results[i].contact_W_m - tips[i]).norm(), 0.1) << "step " << i;
  }
}

// Straight down through the shape's top, far out at the other side, and back up.
TEST_P(RendererConformance, LargeJumpsThroughABodyStayOutside) {
  if (const auto* limit = lacks(rendering::Ability::large_jumps)) GTEST_SKIP() << limit->reason;
  const auto renderer = make();
  renderer->reset();
  const double x = shape_name() == "torus" ? 0.0203 : 0.0013;
  step(*renderer, 0, {x, 0.0021, 0.05});
  const rendering::StepResult below = step(*renderer, 1, {x, 0.0021, -0.05});
  // On a round top it slides round to where the tip is; on a flat one it stays.
  const double gap = surface()->signed_distance(below.contact_W_m) - subject().tip_radius_m;
  EXPECT_TRUE(!shape().closed || gap >= -1e-9) << gap;
  if (shape().level) {
    ASSERT_TRUE(below.contact) << "the tip jumped from 50 mm above the " << shape_name()
                               << " to 50 mm below it and is let through; a renderer that finds contact by where the "
                                  "tip is alone declares Ability::large_jumps with the reason";
    EXPECT_GT(below.contact_W_m.z(), -1e-9);
    EXPECT_GT(below.f_W_N.z(), 0.0);
  }
  const rendering::StepResult back = step(*renderer, 2, {x, 0.0021, 0.05});
  if (below.contact) {
    EXPECT_FALSE(back.contact);
  } else {
    // It had slid round and out below: from there the body is in the way again, and a flat underside holds it.
    const double back_gap = surface()->signed_distance(back.contact_W_m) - subject().tip_radius_m;
    EXPECT_TRUE(!shape().closed || back_gap >= -1e-9) << back_gap;
  }
}

TEST_P(RendererConformance, SlowPushesThroughAThinShellStayOutside) {
  if (const auto* limit = lacks(rendering::Ability::thin_shells)) GTEST_SKIP() << limit->reason;
  if (shape_name() != "plate" && shape_name() != "sheet") GTEST_SKIP() << "a " << shape_name() << " is no thin shell";
  const auto renderer = make();
  renderer->reset();
  double last_N = 0.0;
  for (int i = 0; i <= 300; ++i) {
    const rendering::StepResult now =
        step(*renderer, static_cast<std::size_t>(i), {0.0013, 0.0021, 0.001 + subject().tip_radius_m - 2e-5 * i});
    ASSERT_GE(now.f_W_N.z(), last_N)
        << "5 mm below a shell of 0.2 mm the force still rises; step " << i
        << ". A renderer that cannot hold it declares Ability::thin_shells with the reason";
    last_N = now.f_W_N.z();
  }
  EXPECT_GT(last_N, 0.0);
}

TEST_P(RendererConformance, AStartInsideIsPushedOutByTheClosestWay) {
  if (const auto* limit = lacks(rendering::Ability::start_inside)) GTEST_SKIP() << limit->reason;
  if (!shape().closed) GTEST_SKIP() << "an open sheet has no inside";
  const auto at = surface();
  Random random(109);
  int inside = 0;
  for (int i = 0; i < 400 && inside < 20; ++i) {
    const Vec3 p =
        at->bounds().center() + 0.5 * at->bounds().sizes().cwiseProduct(
                                          Vec3(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)));
    const surface::SurfacePoint closest = at->closest(p);
    if (!(closest.signed_distance_m < 0.0)) continue;
    ++inside;
    const auto renderer = make();
    renderer->reset();
    const rendering::StepResult result = step(*renderer, 0, p);
    ASSERT_TRUE(result.contact) << p.transpose();
    // In a valley a ball hangs higher than over the closest point: by r (1 / cos(half the bend) - 1).
    const double least_m = closest.distance_m + subject().tip_radius_m;
    ASSERT_GE(result.depth_m, least_m - 1e-12) << p.transpose();
    ASSERT_LE(result.depth_m, least_m + 0.01 * subject().tip_radius_m + 1e-12) << p.transpose();
  }
  EXPECT_GE(inside, 20);
}

}  // namespace touchstone::testing

#define TOUCHSTONE_RENDERER_CONFORMANCE(prefix, subjects)                                 \
  namespace touchstone::testing {                                                         \
  INSTANTIATE_TEST_SUITE_P(prefix, RendererConformance,                                   \
                           ::testing::Combine(::testing::ValuesIn(subjects),              \
                                              ::testing::ValuesIn(conformance_shapes())), \
                           conformance_name);                                             \
  INSTANTIATE_TEST_SUITE_P(prefix, RendererBehaviour, ::testing::ValuesIn(subjects),      \
                           [](const auto& tested) { return tested.param.name; });         \
  }                                                                                       \
  static_assert(true)
