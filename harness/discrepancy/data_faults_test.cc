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

}  // namespace
}  // namespace touchstone::discrepancy
