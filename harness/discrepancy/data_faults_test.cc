// A fault of the data needs evidence for a fault: recordings whose load does not vary, or follows no position, have
// none.
#include "harness/discrepancy/data_faults.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "harness/base/random.h"
#include "harness/discrepancy/plane_for_test.h"

namespace touchstone::discrepancy {
namespace {

// Presses of a plane at 250 Hz for 20 s; no two alike.
MotionColumns presses(Random& random) {
  std::vector<double> phase(6);
  for (double& p : phase) p = random.uniform(0.0, 6.28);
  MotionColumns motion;
  for (int i = 0; i < 5000; ++i) {
    const double t = 0.004 * i;
    double z = 0.0;
    for (std::size_t k = 0; k < phase.size(); ++k) {
      z -= 5e-4 * (1.0 + std::sin((1.3 + 1.7 * static_cast<double>(k)) * t + phase[k]));
    }
    motion.t_s.push_back(t);
    motion.p_W_m.emplace_back(1e-3 * t, 0.0, z + 2e-3);
  }
  return motion;
}

struct Case {
  explicit Case(MotionColumns motion) : predictor(motion) {
    model.parameters["stiffness_N_per_m"] = 500.0;
    recording.motion = std::move(motion);
    recording.f_W_N = predictor.predict(model).f_W_N;
    blocks.predictor = &predictor;
    blocks.blocks = make_blocks(recording.motion, 2.0 / 60.0);
  }
  [[nodiscard]] std::optional<std::string> fault() { return find_order_fault({&recording, &blocks, nullptr}, model); }

  PlanePredictor predictor;
  Model model;
  Recording recording;
  FitData blocks;
};

TEST(DataFaults, AConstantLoadIsNoFault) {
  Random random(1);
  for (int world = 0; world < 10; ++world) {
    Case force_control(presses(random));
    double wander = 0.0;
    for (Vec3& f : force_control.recording.f_W_N) {
      wander = 0.99 * wander + 0.01 * random.normal();
      f = Vec3(0.1 * random.normal(), 0.0, 2.0 + wander);
    }
    EXPECT_FALSE(force_control.fault());
    for (Vec3& f : force_control.recording.f_W_N) f = Vec3(0.0, 0.0, 2.0);
    EXPECT_FALSE(force_control.fault());
  }
}

TEST(DataFaults, AJointWhoseTorqueFollowsTheDirectionAloneIsNoFault) {
  Random random(2);
  Case joint(presses(random));
  auto& motion = joint.recording.motion;
  for (std::size_t i = 0; i < motion.size(); ++i) {  // there and back at one speed, a load in proportion to the depth
    const double t = motion.t_s[i];
    motion.p_W_m[i] = Vec3(t < 10.0 ? 0.1 * t : 2.0 - 0.1 * t, 0.0, -1e-3);
    joint.recording.f_W_N[i] = Vec3((t < 10.0 ? -0.07 : 0.07) + 0.01 * random.normal(), 0.0, 0.5);
  }
  PlanePredictor along(motion);
  joint.blocks.predictor = &along;
  EXPECT_FALSE(joint.fault());
}

TEST(DataFaults, SecondsInAWrongOrderAreOne) {
  Random random(3);
  for (int world = 0; world < 10; ++world) {
    Case shuffled(presses(random));
    EXPECT_FALSE(shuffled.fault());
    auto& f = shuffled.recording.f_W_N;
    for (std::size_t b = 19; b > 0; --b) {
      const std::size_t other = random.below(b + 1);
      for (std::size_t i = 0; i < 250; ++i) std::swap(f[b * 250 + i], f[other * 250 + i]);
    }
    const auto fault = shuffled.fault();
    ASSERT_TRUE(fault);
    EXPECT_THAT(*fault, ::testing::HasSubstr("in another order"));
  }
}

// A tool of 1 to 2 N, which the model does not know: where it weighs more than the press pushes, the size of the force
// falls as the load rises.
TEST(DataFaults, AHeavyToolIsNoWrongOrder) {
  Random random(4);
  for (int world = 0; world < 40; ++world) {
    Case heavy(presses(random));
    const double weight_N = random.uniform(1.0, 2.0);
    for (std::size_t i = 0; i < heavy.recording.size(); ++i) {
      Vec3& f = heavy.recording.f_W_N[i];
      const double bump = 0.5 * std::exp(-std::pow((std::fmod(heavy.recording.motion.t_s[i], 9.0) - 4.0) / 1.5, 2));
      if (f.z() > 0.05) f.z() += bump;
      f += Vec3(0.02 * random.normal(), 0.02 * random.normal(), 0.02 * random.normal() - weight_N);
    }
    EXPECT_FALSE(heavy.fault()) << world;
  }
}

TEST(DataFaults, SecondsInAWrongOrderAreOneUnderAHeavyToolToo) {
  Random random(5);
  int found = 0;
  for (int world = 0; world < 10; ++world) {
    Case shuffled(presses(random));
    auto& f = shuffled.recording.f_W_N;
    for (Vec3& force : f) force.z() -= 1.5;
    for (std::size_t b = 19; b > 0; --b) {
      const std::size_t other = random.below(b + 1);
      for (std::size_t i = 0; i < 250; ++i) std::swap(f[b * 250 + i], f[other * 250 + i]);
    }
    found += shuffled.fault() ? 1 : 0;
  }
  EXPECT_EQ(found, 10);
}

TEST(DataFaults, AReversedForceIsNoWrongOrder) {
  Random random(6);
  for (int world = 0; world < 10; ++world) {
    Case reversed(presses(random));
    for (Vec3& f : reversed.recording.f_W_N) f = -f;
    EXPECT_FALSE(reversed.fault()) << world;
  }
}

}  // namespace
}  // namespace touchstone::discrepancy
