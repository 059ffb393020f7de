// What every renderer must keep whatever the shape: the faults that harness/diagnosis finds, each a test of its own
// that fails with the finding and its smallest case. An ability that a renderer declares it lacks skips with its
// reason. Joined by TOUCHSTONE_RENDERER_CONFORMANCE (harness/testing/renderer_conformance.h).
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <memory>
#include <ostream>
#include <string>
#include <vector>

#include "harness/renderer_faults/diagnosis.h"
#include "harness/surface/embree_surface.h"
#include "harness/testing/allocation_guard.h"
#include "harness/testing/conformance_failure.h"

namespace touchstone::testing {

// A renderer under test, with what the suite on shapes must know besides.
struct RendererSubject : renderer_faults::Engine {
  // How the surface is asked; the shapes' own places are always found with Embree.
  std::function<std::shared_ptr<const surface::Surface>(const surface::TriangleMesh&)> queries =
      surface::make_embree_surface;
  bool queries_allocate = false;
  std::vector<std::string> allowed = {};  // faults that are known: reported, and no failure
  double thinnest_m = 0.0;  // a body thinner than this it does not feel at all, which it declares as thin_shells
};

// A parameter of the suite is copied for each of its cases in every process that runs one of them.
using SharedSubject = std::shared_ptr<const RendererSubject>;

inline void PrintTo(const SharedSubject& subject, std::ostream* out) { *out << subject->name; }

inline std::vector<SharedSubject> shared(const std::vector<RendererSubject>& subjects) {
  std::vector<SharedSubject> all;
  for (const RendererSubject& subject : subjects) all.push_back(std::make_shared<RendererSubject>(subject));
  return all;
}

class RendererBehaviour : public ::testing::TestWithParam<SharedSubject> {
 protected:
  void SetUp() override {
    if (GetParam()->queries_allocate) GTEST_SKIP() << "the faults are looked for with the fast queries";
  }

  // Fails with the finding where one of the faults is there. What follows from another fault fails by that one's name.
  static void expect_none(const std::vector<std::string>& faults) {
    renderer_faults::Engine engine = *GetParam();
    if (allocations_are_counted()) engine.allocations = allocations_on_this_thread;
    const renderer_faults::Diagnosis found = renderer_faults::diagnose(engine, faults);
    for (const auto& [name, why] : found.failed) ADD_FAILURE() << name << ": could not be looked for: " << why;
    std::string passed_over;
    for (const renderer_faults::Finding& one : found.findings) {
      const auto allowed = [&](const std::string& name) {
        return std::ranges::find(GetParam()->allowed, name) != GetParam()->allowed.end();
      };
      if (allowed(one.name) || allowed(one.follows_from)) {
        passed_over += one.name + " is allowed: " + one.what + "\n";
      } else if (!one.follows_from.empty()) {
        passed_over += one.name + " follows from " + one.follows_from + ": " + one.what + "\n";
      } else {
        ADD_FAILURE() << one.name << ": " << one.what << "\n  " << one.smallest_case
                      << may_declare_text(renderer_faults::find_detector(one.name).needs) << "\n  --allow=" << one.name
                      << " (ALLOW of touchstone_add_renderer_tests) reports it without a failure";
      }
    }
    if (!passed_over.empty()) GTEST_SKIP() << passed_over;
    if (found.declared.size() == faults.size()) GTEST_SKIP() << found.declared.front().second;
  }
};

GTEST_ALLOW_UNINSTANTIATED_PARAMETERIZED_TEST(RendererBehaviour);

TEST_P(RendererBehaviour, TheForceTurnsWithTheWorldAndNotWithTheTip) { expect_none({"wrong-frame"}); }
TEST_P(RendererBehaviour, NearlyFlatEdgesHoldNothingBack) { expect_none({"sticks-at-flat-edges"}); }
TEST_P(RendererBehaviour, BodiesWithFlushTopsAreOneFloor) { expect_none({"sticks-at-joints"}); }
TEST_P(RendererBehaviour, PlatesOfAnyThicknessHold) { expect_none({"pops-through-shell"}); }
TEST_P(RendererBehaviour, SmallTrianglesAreFeltAsLargeOnes) { expect_none({"untouchable-triangles"}); }
TEST_P(RendererBehaviour, TheForceDoesNotJumpFromTriangleToTriangle) { expect_none({"jump-between-triangles"}); }
TEST_P(RendererBehaviour, ABallGoesRoundASharpEdge) { expect_none({"ball-at-edge"}); }
TEST_P(RendererBehaviour, DeclaredFrictionIsFelt) { expect_none({"friction-lost"}); }
TEST_P(RendererBehaviour, ACircleGivesNoEnergy) { expect_none({"energy-gained"}); }
TEST_P(RendererBehaviour, TheForceIsThatOfTheTipNow) {
  expect_none({"held-answer", "delay", "alternate-lag", "jitter", "filter", "clipped-rate"});
}
TEST_P(RendererBehaviour, NoSampleIsWithoutForce) { expect_none({"dropout"}); }
TEST_P(RendererBehaviour, TheForceIsAlongTheNormalUpToTenNewtons) {
  expect_none({"mirrored-axis", "exchanged-axes", "lost-axis", "saturation", "quantised"});
}
TEST_P(RendererBehaviour, TheSameDepthIsTheSameForceEverywhere) { expect_none({"place-dependent"}); }
TEST_P(RendererBehaviour, TheRateOfTheLoopChangesNothing) { expect_none({"rate-dependent"}); }
TEST_P(RendererBehaviour, ReleasedTheForceIsThatOfPressing) { expect_none({"hysteresis"}); }
TEST_P(RendererBehaviour, EveryFaceAnswersAsItsNeighbours) { expect_none({"one-bad-face"}); }
TEST_P(RendererBehaviour, ABlockHoldsHoweverDeep) { expect_none({"falls-through-block"}); }
TEST_P(RendererBehaviour, ContactBeginsAtTheSurface) { expect_none({"gap-at-contact"}); }
TEST_P(RendererBehaviour, TheContactPointLiesOnAPlane) { expect_none({"standoff"}); }
TEST_P(RendererBehaviour, InAWallsPlaneTheForceIsThatBesideIt) { expect_none({"tie-break"}); }
TEST_P(RendererBehaviour, AtRestAndOverAPlaneTheForceIsSteady) { expect_none({"noise"}); }
TEST_P(RendererBehaviour, ResetForgetsARunBrokenOffInContact) { expect_none({"state-after-reset"}); }
TEST_P(RendererBehaviour, TwoOnOneSurfaceDoNotDisturbOneAnother) { expect_none({"shared-state"}); }
TEST_P(RendererBehaviour, NoStepAllocates) { expect_none({"allocation"}); }
TEST_P(RendererBehaviour, TheCostDoesNotGrowWithTheSteps) { expect_none({"growing-cost"}); }
TEST_P(RendererBehaviour, NoStepOfAMillionIsASpike) { expect_none({"late-spike"}); }

}  // namespace touchstone::testing
