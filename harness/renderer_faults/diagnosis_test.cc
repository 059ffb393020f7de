// Each detector finds the fault that is planted for it, by name, and finds nothing in a renderer without it. A planted
// fault is a right renderer of the catalogue with its input, its answer or its cost changed.
#include "harness/renderer_faults/diagnosis.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <time.h>

#include <atomic>
#include <cmath>
#include <thread>

#include "harness/base/error.h"
#include "harness/base/random.h"
#include "harness/renderer_faults/planted_fault_for_test.h"

namespace touchstone::renderer_faults {
using rendering::StepResult;

namespace {

void burn(double seconds) {
  const auto now = [] {
    timespec t{};
    ::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
  };
  for (const double end = now() + seconds; now() < end;) {
  }
}

// The side of the smallest triangle's square near a place, from its area.
double size_at(const Memory& memory, const Vec3& p) {
  const surface::SurfacePoint foot = memory.surface->closest(p);
  return std::sqrt(memory.surface->mesh()->scaled_normal(static_cast<std::size_t>(foot.triangle)).norm());
}

std::atomic<double> shared_depth_m{0.0};

std::vector<Fault> faults() {
  const std::string cone = R"(, "mu_static": 0.4, "mu_dynamic": 0.3)";
  return {
      {"TurnsWithTheTip", "wrong-frame", {}, [](auto& r, auto& tip, auto&) { r.f_W_N = tip.q_WS * r.f_W_N; }},
      {"WorldFrameForgotten",
       "wrong-frame",
       {},
       [](auto& r, auto&, auto&) {
         r.f_W_N = {0, 0, r.f_W_N.norm()};
       }},
      {"NothingBetweenTwoWalls",
       "tie-break",
       {},
       [](auto& r, auto& tip, auto&) {
         if (r.contact && std::abs(0.02 - tip.p_W_m.x() + tip.p_W_m.z()) < 1e-12) nothing_there(r, tip);
       }},
      // A wall that nobody sees where a joint is: the force of a proxy that stays behind.
      {"SticksAtZero",
       "sticks-at-joints",
       {},
       [](auto& r, auto& tip, auto&) {
         if (r.contact && tip.p_W_m.x() > 0.0 && std::abs(tip.p_W_m.z()) < 0.01) r.f_W_N.x() -= 500.0 * tip.p_W_m.x();
       }},
      {"SticksAtSmallBends",
       "sticks-at-flat-edges",
       {},
       [](auto& r, auto& tip, auto& m) {
         const auto& mesh = *m.surface->mesh();
         const bool nearly_flat = mesh.source == "roof" && std::abs(mesh.bounds().max().z()) < 1e-6;
         if (r.contact && nearly_flat && tip.p_W_m.x() > 0.0) r.f_W_N.x() -= 500.0 * tip.p_W_m.x();
       }},
      {"PopsThroughAMillimetre",
       "pops-through-shell",
       {},
       [](auto& r, auto& tip, auto& m) {
         const auto box = m.surface->bounds();
         const double thickness = box.sizes().z();
         if (thickness <= 1e-3 && tip.p_W_m.z() < -0.5 * thickness) nothing_there(r, tip);
       }},
      // A renderer with an absolute epsilon: intersections with triangles below a size are lost.
      {"TriangleTooSmallForItsEpsilon",
       "untouchable-triangles",
       {},
       [](auto& r, auto& tip, auto& m) {
         if (r.contact && size_at(m, r.contact_W_m) < 1e-5) nothing_there(r, tip);
       }},
      // Small triangles are right, and those that come after them are lost.
      {"LosesTheLargeBesideTheSmall",
       "untouchable-triangles",
       {},
       [](auto& r, auto& tip, auto& m) {
         const double sheet_m = m.surface->bounds().sizes().x();
         const double size_m = size_at(m, r.contact_W_m);
         if (r.contact && size_m > 0.05 * sheet_m && size_m < 0.2 * sheet_m) nothing_there(r, tip);
       }},
      {"JumpsByTwoPercentOnOneTriangle",
       "jump-between-triangles",
       {},
       [](auto& r, auto&, auto& m) {
         if (r.contact && m.surface->closest(r.contact_W_m).triangle == 17) r.f_W_N *= 1.02;
       }},
      {"LosesItsFriction",
       "friction-lost",
       {},
       [](auto& r, auto&, auto&) { r.f_W_N = r.f_W_N.dot(r.n_W) * r.n_W; },
       "friction-cone",
       cone},
      {"LosesItsFrictionInMillimetres",
       "friction-lost",
       {},
       [](auto& r, auto&, auto& m) {
         if (m.unit == 1e3) r.f_W_N = r.f_W_N.dot(r.n_W) * r.n_W;
       },
       "friction-cone",
       cone},
      {"PushesMoreOnTheWayOut",
       "energy-gained",
       {},
       [](auto& r, auto& tip, auto& m) {
         if (tip.p_W_m.z() > m.last_tip.z()) r.f_W_N *= 1.05;
       }},
      {"TenMicrometresLate",
       "gap-at-contact",
       {},
       [](auto& r, auto& tip, auto&) {
         if (r.contact && r.depth_m < 1e-5) nothing_there(r, tip);
       }},
      {"FloatsByATenthOfAMicrometre",
       "standoff",
       {},
       [](auto& r, auto&, auto&) {
         if (r.contact) r.contact_W_m += 1e-7 * r.n_W;
       }},
      {"NoisyAtRest",
       "noise",
       {},
       [](auto& r, auto&, auto& m) {
         if (r.contact) r.f_W_N *= 1.0 + 0.01 * std::sin(12.9898 * static_cast<double>(m.steps));
       }},
      {"SawsWhileSliding",
       "noise",
       {},
       [](auto& r, auto& tip, auto&) {
         if (r.contact) r.f_W_N *= 1.0 + 0.01 * std::fmod(std::abs(tip.p_W_m.x()) / 1e-4, 1.0);
       }},
      {"RemembersTheLastRun",
       "state-after-reset",
       {},
       [](auto& r, auto&, auto& m) {
         if (m.steps != m.since_reset) r.f_W_N *= 1.0 + 1e-12;
       }},
      {"OneScratchForAll", "shared-state",
       [](auto& tip, auto&) {
         shared_depth_m = tip.p_W_m.z();
         // In the second thread: until the first one's renderer has had its step.
         static const auto first = std::this_thread::get_id();
         if (std::this_thread::get_id() == first) return;
         for (int i = 0; i < 50 && shared_depth_m == tip.p_W_m.z(); ++i) std::this_thread::yield();
         tip.p_W_m.z() = shared_depth_m;
       }},
      {"OneMemoryForAll",
       "shared-state",
       {},
       [](auto& r, auto& tip, auto&) {
         // Smooths its depth with that of the last step, whoever's it was.
         const double last = shared_depth_m.exchange(tip.p_W_m.z());
         r.f_W_N.z() += last == tip.p_W_m.z() ? 0.0 : 1e-9 * last;
       }},
      {"AllocatesInContact",
       "allocation",
       {},
       [](auto& r, auto&, auto&) {
         if (r.contact) delete new volatile double(r.depth_m);
       }},
      {"CostGrowsWithTheSteps",
       "growing-cost",
       {},
       [](auto& r, auto&, auto& m) {
         volatile double sum = 0.0;
         for (std::size_t i = 0; i < m.steps / 50; ++i) sum = sum + 1.0;
         r.depth_m += 0.0 * sum;
       }},
      {"SpikeAfterAMillionSteps",
       "late-spike",
       {},
       [](auto&, auto&, auto& m) {
         if (m.steps == 1'000'000) burn(1e-3);
       }},
  };
}

class PlantedFault : public ::testing::TestWithParam<Fault> {};

TEST_P(PlantedFault, IsFoundByName) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  if (GetParam().caught_by == "allocation" || GetParam().caught_by == "shared-state")
    GTEST_SKIP() << "the sanitizer's own business";
#endif
  const auto finding = find_detector(GetParam().caught_by).find(engine_of(GetParam()));
  ASSERT_TRUE(finding.has_value());
  fmt::print("{}: {}: {}\n  {}\n", GetParam().name, finding->name, finding->what, finding->smallest_case);
  EXPECT_EQ(finding->name, GetParam().caught_by);
  EXPECT_FALSE(finding->smallest_case.empty());
}

INSTANTIATE_TEST_SUITE_P(Diagnosis, PlantedFault, ::testing::ValuesIn(faults()),
                         [](const auto& tested) { return tested.param.name; });

class Healthy : public ::testing::TestWithParam<std::string> {};

// The same path without a fault is clean: it is the fault that is found.
TEST_P(Healthy, IsClean) {
  const std::string& renderer = GetParam();
  const Engine engine = engine_of(
      {"healthy", "", {}, {}, renderer, renderer == "friction-cone" ? R"(, "mu_static": 0.4, "mu_dynamic": 0.3)" : ""});
  for (const Detector& detector : detectors()) {
    const auto finding = detector.find(engine);
    EXPECT_FALSE(finding.has_value()) << detector.name << ": " << finding->what << "; " << finding->smallest_case;
  }
}

INSTANTIATE_TEST_SUITE_P(Diagnosis, Healthy, ::testing::Values("god-object", "friction-cone"), [](const auto& tested) {
  return tested.param == "god-object" ? "GodObject" : "FrictionCone";
});

// Interrupts at 2 % of the steps, others in every run: three runs have ten of a million in common.
TEST(Diagnosis, ABusyMachineIsNoLateSpike) {
  Random random(11);
  const Engine engine = engine_of({"interrupted", "", {}, [&](auto&, auto&, auto&) {
                                     if (random.uniform() < 0.02) burn(3e-5);
                                   }});
  const auto finding = find_detector("late-spike").find(engine);
  EXPECT_FALSE(finding.has_value()) << finding->what;
}

// A ball that stands off by its engine's epsilon, which rounding lengthens.
TEST(Diagnosis, AnEpsilonThatIsDeclaredIsNoStandoff) {
  Engine engine = engine_of({"lifted",
                             "",
                             {},
                             [](StepResult& result, auto&, auto&) {
                               if (result.contact) result.contact_W_m.z() += 1e-7 + 1e-17;
                             },
                             "god-object",
                             R"(, "tip_radius_m": 0.001)"});
  engine.tip_radius_m = 0.001;
  engine.epsilon_m = 1e-7;
  const auto finding = find_detector("standoff").find(engine);
  EXPECT_FALSE(finding.has_value()) << finding->what;
  engine.epsilon_m = 0.9e-7;
  EXPECT_TRUE(find_detector("standoff").find(engine).has_value());
}

// Triangles of ten epsilons are looked at and smaller ones are not, in the lengths of the renderer's own world.
TEST(Diagnosis, TrianglesBelowTheDeclaredEpsilonMayBeLost) {
  Engine engine = engine_of({"coarse", "", {}, [](StepResult& result, const rendering::TipState& tip, Memory& memory) {
                               if (result.contact && size_at(memory, result.contact_W_m) < 4e-6)
                                 nothing_there(result, tip);
                             }});
  engine.epsilon_m = 1e-6;
  const auto finding = find_detector("untouchable-triangles").find(engine);
  EXPECT_FALSE(finding.has_value()) << finding->what;
  engine.epsilon_m = 1e-7;
  EXPECT_TRUE(find_detector("untouchable-triangles").find(engine).has_value());
}

// Those of timing, of the settled force and of a ball are planted in fault_matrix_test.cc.
TEST(Diagnosis, EveryDetectorHasAPlantedFaultAndItsOwnName) {
  const auto planted = faults();
  for (const Detector& detector : detectors()) {
    EXPECT_EQ(find_detector(detector.name).name, detector.name);
    if (detector.kind != DetectorKind::moving && detector.kind != DetectorKind::running) continue;
    if (detector.name == "ball-at-edge") continue;
    EXPECT_TRUE(std::ranges::any_of(planted, [&](const Fault& fault) { return fault.caught_by == detector.name; }))
        << detector.name;
  }
  EXPECT_THROW(find_detector("bad-luck"), UsageError);
}

TEST(Diagnosis, WhatIsDeclaredIsNotLookedForAndWhatThrowsIsSaid) {
  Engine engine = engine_of({"healthy", ""});
  engine.cannot = {{rendering::Ability::surface_contact, "it rounds"}};
  engine.make = [](auto, double) -> std::unique_ptr<rendering::Renderer> { throw BadData("no memory"); };
  const Diagnosis diagnosis = diagnose(engine);
  EXPECT_THAT(diagnosis.declared, ::testing::Contains(::testing::Pair("standoff", "it rounds")));
  EXPECT_THAT(diagnosis.failed, ::testing::Contains(::testing::Pair("delay", "no memory")));
  EXPECT_TRUE(diagnosis.findings.empty());
}

// Its zero force is that of free space, and would pass for a steady, passive one that pulls nobody.
TEST(Diagnosis, ARendererThatBreaksDownIsCleanOfNothing) {
  const auto breaks = [](StepResult& result, const rendering::TipState&, Memory&) {
    result = {};
    result.status = rendering::StepStatus::failed;
  };
  const Diagnosis diagnosis = diagnose(engine_of({"broken", "", {}, breaks, "friction-cone"}));
  // Of a point with friction nothing is asked that only a ball without can answer.
  EXPECT_THAT(diagnosis.clean, ::testing::ElementsAre("ball-at-edge"));
  EXPECT_TRUE(diagnosis.findings.empty());
  EXPECT_EQ(diagnosis.failed.size(), detectors().size() - 1);
}

}  // namespace
}  // namespace touchstone::renderer_faults
