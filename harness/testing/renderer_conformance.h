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
#include <limits>
#include <memory>
#include <string>
#include <tuple>
#include <vector>

#include "harness/base/random.h"
#include "harness/base/rotations.h"
#include "harness/renderer_faults/engine.h"
#include "harness/rendering/limitation.h"
#include "harness/rendering/renderer.h"
#include "harness/rendering/renderer_failed.h"
#include "harness/rendering/settled_renderer.h"
#include "harness/surface/embree_surface.h"
#include "harness/surface/moved_mesh.h"
#include "harness/testing/allocation_guard.h"
#include "harness/testing/conformance_failure.h"
#include "harness/testing/conformance_shapes.h"
#include "harness/testing/renderer_behaviour.h"

namespace touchstone::testing {

// A pose and unit of the world.
struct ConformancePose {
  Quat turn = Quat::Identity();
  Vec3 shift = Vec3::Zero();
  double unit = 1.0;
  [[nodiscard]] Vec3 operator()(const Vec3& p) const { return turn * (unit * p) + shift; }
};

class RendererConformance : public ::testing::TestWithParam<std::tuple<SharedSubject, ConformanceShape>> {
 protected:
  using Pose = ConformancePose;

  void SetUp() override {
    if (!(shape().thickness_m < subject().thinnest_m)) return;
    const rendering::Limitation* const limit = lacks(rendering::Ability::thin_shells);
    ASSERT_NE(limit, nullptr) << "what is not felt at all must be declared";
    GTEST_SKIP() << limit->reason;
  }

  [[nodiscard]] const RendererSubject& subject() const { return *std::get<0>(GetParam()); }
  [[nodiscard]] const std::string& shape_name() const { return std::get<1>(GetParam()).name; }
  [[nodiscard]] const ConformanceBody& shape() const { return shape_; }
  [[nodiscard]] const rendering::Limitation* lacks(rendering::Ability ability) const {
    return find_limitation(subject().cannot, ability);
  }

  // False where the renderer declares that it cannot: the test is skipped with its reason. Else failures say that it
  // may.
  [[nodiscard]] bool can(rendering::Ability ability) {
    may_declare_.push_back(ability);
    const rendering::Limitation* const limit = lacks(ability);
    if (limit != nullptr) [&] { GTEST_SKIP() << limit->reason; }();
    return limit == nullptr;
  }
  [[nodiscard]] const std::vector<rendering::Ability>& may_declare() const { return may_declare_; }
  // What a failed step says; `tip` in this world, before the pose.
  [[nodiscard]] std::string said(std::size_t step, const Vec3& tip, const rendering::StepResult& answer,
                                 std::string_view expected) const {
    const double above_m = surface()->signed_distance(tip) - subject().tip_radius_m;
    return failure_text({shape_name(), step, tip, above_m, answer}, expected, may_declare_);
  }

  [[nodiscard]] std::shared_ptr<const surface::Surface> surface(const Pose& pose = {}) const {
    return make_embree_surface(moved(shape().mesh, pose.turn, pose.shift, pose.unit));
  }
  [[nodiscard]] std::unique_ptr<rendering::Renderer> make(const Pose& pose = {}) const {
    return rendering::settled(
        subject().make(subject().queries(moved(shape().mesh, pose.turn, pose.shift, pose.unit)), pose.unit),
        subject().lag_samples);
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
    constexpr double eps = std::numeric_limits<double>::epsilon();
    const auto tips = strokes(101, 8);
    const auto here = make();
    const auto there = make(pose);
    const auto expected = run(*here, tips);
    const auto obtained = run(*there, tips, pose);
    // Moving the mesh rounds its vertices: a tilt of eps |x| / (height of a triangle), for at most 1 mm of depth.
    const double lengths = 0.1 + pose.shift.norm() / pose.unit;
    const double tilt = std::max(1e3, 1e-3 / least_height_m());
    const double tolerance_N = subject().stiffness_N_per_m * lengths * tilt * eps;
    std::size_t touching = 0;
    for (std::size_t i = 0; i < tips.size(); ++i) {
      const Vec3 turned_back_N = pose.turn.conjugate() * obtained[i].f_W_N;
      if (!((turned_back_N - expected[i].f_W_N).norm() <= tolerance_N)) {
        FAIL() << said(i, tips[i], obtained[i],
                       fmt::format("{} N as in the world at rest, within {:.2g} N; turned back it is {} N (the world "
                                   "turned, shifted by {} m, lengths times {})",
                                   place_text(expected[i].f_W_N), tolerance_N, place_text(turned_back_N),
                                   place_text(pose.shift), pose.unit));
      }
      touching += expected[i].contact ? 1U : 0U;
    }
    if (touching == 0U && !feels_exactly())
      GTEST_SKIP() << not_reached << lacks(rendering::Ability::surface_contact)->reason;
    EXPECT_GT(touching, 100U) << "the strokes must touch";
  }

  // Else it may round an edge off by more than the strokes are deep.
  [[nodiscard]] bool feels_exactly() const { return lacks(rendering::Ability::surface_contact) == nullptr; }
  static constexpr const char* not_reached = "the strokes do not reach what it feels: ";

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
  std::vector<rendering::Ability> may_declare_;
};

inline std::string conformance_name(const ::testing::TestParamInfo<RendererConformance::ParamType>& of) {
  return std::get<0>(of.param)->name + "_" + std::get<1>(of.param).name;
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
    for (const rendering::StepResult& now : {again[i], other[i]}) {
      if (now.f_W_N == first[i].f_W_N && now.contact_W_m == first[i].contact_W_m) continue;
      FAIL() << said(i, tips[i], now,
                     fmt::format("as in the first run, to the bit: {}; this is the run {}", answer_text(first[i]),
                                 &now == &other[i] ? "of another instance" : "after reset()"));
    }
  }
}

TEST_P(RendererConformance, RigidMotionOfTheWorldChangesNothing) {
  if (!can(rendering::Ability::rigid_motion)) return;
  expect_same_forces({Quat(0.83, 0.31, -0.41, 0.22).normalized(), {0.3, -0.2, 0.1}, 1.0});
}

TEST_P(RendererConformance, TheUnitOfLengthChangesNothing) {
  if (!can(rendering::Ability::unit_scale)) return;
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
      if (result.contact || result.f_W_N != Vec3::Zero() || result.contact_W_m != tip)
        FAIL() << said(tick - 1, tip, result, "no contact and no force, the contact point at the tip");
    }
    // The next leg starts where a straight way cannot meet the shape.
    renderer->reset();
  }
}

TEST_P(RendererConformance, ForceStaysInTheFrictionConeAndNeverPulls) {
  const auto renderer = make();
  const auto tips = strokes(103, 8);
  const auto results = run(*renderer, tips);
  const double rounding_N = subject().stiffness_N_per_m * 0.1 * 64 * std::numeric_limits<double>::epsilon();
  for (std::size_t i = 0; i < results.size(); ++i) {
    const rendering::StepResult& now = results[i];
    if (!now.contact && now.f_W_N != Vec3::Zero()) FAIL() << said(i, tips[i], now, "no force without contact");
    if (!now.contact) continue;
    if (!(std::abs(now.n_W.norm() - 1.0) <= 1e-12))
      FAIL() << said(i, tips[i], now, fmt::format("a normal of length 1, got {}", place_text(now.n_W)));
    const double normal_N = now.f_W_N.dot(now.n_W);
    const double tangential_N = (now.f_W_N - normal_N * now.n_W).norm();
    if (!(normal_N >= -rounding_N))
      FAIL() << said(i, tips[i], now,
                     fmt::format("a push along the normal {}; it pulls with {:.6g} N", place_text(now.n_W), -normal_N));
    if (!(tangential_N <= subject().friction * normal_N * (1.0 + 1e-12) + rounding_N))
      FAIL() << said(
          i, tips[i], now,
          fmt::format("at most {:.6g} N along the surface (friction {:.6g} of {:.6g} N along the normal {}), "
                      "got {:.6g} N; --friction=MU says another coefficient",
                      subject().friction * normal_N, subject().friction, normal_N, place_text(now.n_W), tangential_N));
  }
}

TEST_P(RendererConformance, ClosedLoopsGiveNoEnergyBack) {
  if (!can(rendering::Ability::passive)) return;
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
    if (!results[i + 1].contact && !(given_J <= sampling_J + rounding_J))
      FAIL() << said(i + 1, tips[i + 1], results[i + 1],
                     fmt::format("at most {:.4g} J given to the hand since the start, which sampling alone gives; it "
                                 "gave {:.4g} J",
                                 sampling_J + rounding_J, given_J));
  }
}

TEST_P(RendererConformance, ContactBeginsAndEndsWithoutAJump) {
  if (!can(rendering::Ability::continuous_force)) return;
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
    if (!(f.norm() <= most_N * (1.0 + 1e-9))) {
      FAIL() << said(
          i, tips[i], results[i],
          fmt::format("contact {} with at most {:.4g} N, stiffness times the tip's step; it does with {:.4g} N",
                      results[i].contact ? "begins" : "ends", most_N, f.norm()));
    }
    contacts += results[i].contact ? 1 : 0;
  }
  if (contacts == 0 && !feels_exactly())
    GTEST_SKIP() << not_reached << lacks(rendering::Ability::surface_contact)->reason;
  // Samples further apart than the strokes are deep may round off what a stroke should meet.
  const bool may_miss = subject().thinnest_m > 0.0;
  if (!may_miss && contacts < 12)
    ADD_FAILURE() << shape_name() << ": 12 strokes press 0.5 mm deep, and contact began " << contacts << " times"
                  << may_declare_text(may_declare());
}

TEST_P(RendererConformance, StepAllocatesNothing) {
  if (subject().queries_allocate) GTEST_SKIP() << "the exact queries allocate, the fast ones do not";
  if (!allocations_are_counted()) GTEST_SKIP() << "the thread sanitizer does not let allocations be counted";
  const auto renderer = make();
  const auto tips = strokes(106, 6);
  renderer->reset();
  const AllocationGuard guard;
  for (std::size_t i = 0; i < tips.size(); ++i) step(*renderer, i, tips[i]);
  if (guard.count() != 0U)
    ADD_FAILURE() << shape_name() << ": " << tips.size() << " steps allocated memory " << guard.count()
                  << " times; a servo loop waits for none" << may_declare_text(may_declare());
}

TEST_P(RendererConformance, RefusesBadInputAndStaysAsItWas) {
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  constexpr double inf = std::numeric_limits<double>::infinity();
  const auto tips = strokes(107, 3);
  const auto renderer = make();
  const auto expected = run(*renderer, tips);
  renderer->reset();
  for (std::size_t i = 0; i < tips.size(); ++i) {
    const double t_s = static_cast<double>(i + 1) * 1e-3;
    for (const rendering::TipState& bad :
         {rendering::TipState{t_s, {nan, 0, 0}, Quat::Identity()},
          rendering::TipState{t_s, {0, 0, inf}, Quat::Identity()}, rendering::TipState{nan, tips[i], Quat::Identity()},
          rendering::TipState{inf, tips[i], Quat::Identity()}, rendering::TipState{t_s, tips[i], Quat(nan, 0, 0, 0)},
          rendering::TipState{i > 0 ? t_s - 1e-3 : nan, tips[i], Quat::Identity()}}) {
      if (i % 7 != 0) break;
      const rendering::StepResult refused = renderer->step(bad);
      if (refused.status != rendering::StepStatus::refused || refused.f_W_N != Vec3::Zero() || refused.contact)
        FAIL() << said(i, tips[i], refused,
                       fmt::format("t = {} s, tip {} m refused (StepStatus::refused) without force or contact", bad.t_s,
                                   place_text(bad.p_W_m)));
    }
    const rendering::StepResult now = step(*renderer, i, tips[i]);
    if (now.f_W_N != expected[i].f_W_N)
      FAIL() << said(i, tips[i], now,
                     fmt::format("{} N, as without the refused input before it", place_text(expected[i].f_W_N)));
  }
}

TEST_P(RendererConformance, SurfaceContactPointIsOnOrAboveTheSurface) {
  if (!can(rendering::Ability::surface_contact)) return;
  const auto renderer = make();
  const auto at = surface();
  const auto tips = strokes(108, 8);
  const auto results = run(*renderer, tips);
  for (std::size_t i = 0; i < tips.size(); ++i) {
    if (!results[i].contact) continue;
    const double gap = at->signed_distance(results[i].contact_W_m) - subject().tip_radius_m;
    if (!(gap >= -1e-3 * 64 * 1e4 * std::numeric_limits<double>::epsilon()))
      FAIL() << said(i, tips[i], results[i],
                     fmt::format("the contact point on the surface or above it; it is {:.3g} mm below", -1e3 * gap));
    if (!((results[i].contact_W_m - tips[i]).norm() <= 0.1))
      FAIL() << said(i, tips[i], results[i], "the contact point within 100 mm of the tip");
  }
}

// Straight down through the shape's top, far out at the other side, and back up.
TEST_P(RendererConformance, LargeJumpsThroughABodyStayOutside) {
  if (!can(rendering::Ability::large_jumps)) return;
  const auto renderer = make();
  renderer->reset();
  const double x = shape_name() == "torus" ? 0.0203 : 0.0013;
  step(*renderer, 0, {x, 0.0021, 0.05});
  const Vec3 above_m(x, 0.0021, 0.05), below_m(x, 0.0021, -0.05);
  const rendering::StepResult below = step(*renderer, 1, below_m);
  const auto inside = [&](const rendering::StepResult& at) {
    return shape().closed && !(surface()->signed_distance(at.contact_W_m) - subject().tip_radius_m >= -1e-9);
  };
  // On a round top it slides round to where the tip is; on a flat one it stays.
  if (inside(below))
    FAIL() << said(1, below_m, below, "the contact point outside the body; the tip was 50 mm above it a step before");
  if (shape().level && (!below.contact || below.contact_W_m.z() <= -1e-9 || below.f_W_N.z() <= 0.0))
    FAIL() << said(1, below_m, below,
                   "held on the top, with a force upwards: the tip was 50 mm above it a step before, and a tip that "
                   "jumps through a body stays on the side it came from");
  const rendering::StepResult back = step(*renderer, 2, above_m);
  if (below.contact && back.contact) FAIL() << said(2, above_m, back, "no contact, 50 mm above the body again");
  // It had slid round and out below: from there the body is in the way again, and a flat underside holds it.
  if (!below.contact && inside(back)) FAIL() << said(2, above_m, back, "the contact point outside the body");
}

TEST_P(RendererConformance, SlowPushesThroughAThinShellStayOutside) {
  if (!can(rendering::Ability::thin_shells)) return;
  if (shape_name() != "plate" && shape_name() != "sheet") GTEST_SKIP() << "a " << shape_name() << " is no thin shell";
  const auto renderer = make();
  renderer->reset();
  double last_N = 0.0;
  for (int i = 0; i <= 300; ++i) {
    const Vec3 tip(0.0013, 0.0021, 0.001 + subject().tip_radius_m - 2e-5 * i);
    const rendering::StepResult now = step(*renderer, static_cast<std::size_t>(i), tip);
    if (!(now.f_W_N.z() >= last_N) || (i == 300 && now.f_W_N.z() <= 0.0))
      FAIL() << said(static_cast<std::size_t>(i), tip, now,
                     fmt::format("a force upwards of at least {:.6g} N, that of the step before: pushed down slowly in "
                                 "steps of 0.02 mm, the shell holds to 5 mm below it",
                                 last_N));
    last_N = now.f_W_N.z();
  }
}

TEST_P(RendererConformance, AStartInsideIsPushedOutByTheClosestWay) {
  if (!can(rendering::Ability::start_inside)) return;
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
    // In a valley a ball hangs higher than over the closest point: by r (1 / cos(half the bend) - 1).
    const double least_m = closest.distance_m + subject().tip_radius_m;
    const double most_m = least_m + 0.01 * subject().tip_radius_m;
    if (!result.contact || !(result.depth_m >= least_m - 1e-12 && result.depth_m <= most_m + 1e-12))
      FAIL() << said(0, p, result,
                     fmt::format("pushed out by the closest way: a depth from {:.9g} to {:.9g} m, got {:.9g} m",
                                 least_m, most_m, result.depth_m));
  }
  EXPECT_GE(inside, 20);
}

}  // namespace touchstone::testing

#define TOUCHSTONE_RENDERER_CONFORMANCE(prefix, subjects)                                      \
  namespace touchstone::testing {                                                              \
  static const std::vector<SharedSubject>& prefix##Subjects() {                                \
    static const std::vector<SharedSubject> all = shared(subjects);                            \
    return all;                                                                                \
  }                                                                                            \
  INSTANTIATE_TEST_SUITE_P(prefix, RendererConformance,                                        \
                           ::testing::Combine(::testing::ValuesIn(prefix##Subjects()),         \
                                              ::testing::ValuesIn(conformance_shapes())),      \
                           conformance_name);                                                  \
  INSTANTIATE_TEST_SUITE_P(prefix, RendererBehaviour, ::testing::ValuesIn(prefix##Subjects()), \
                           [](const auto& tested) { return tested.param->name; });             \
  }                                                                                            \
  static_assert(true)
