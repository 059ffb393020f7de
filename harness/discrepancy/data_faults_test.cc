// A fault of the data needs evidence for a fault: recordings whose load does not vary, or follows no position, have
// none.
#include "harness/discrepancy/data_faults.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <utility>

#include "harness/base/random.h"
#include "harness/discrepancy/plane_for_test.h"
#include "harness/discrepancy/two_recordings_for_test.h"

namespace touchstone::discrepancy {
using rendering::Candidate;
using rendering::Model;
using rendering::Side;

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
  recording::Recording recording;
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

// A plane with dry friction: a bristle that slips beyond 10 um (Dahl 1968).
class RoughPlane final : public rendering::Predictor {
 public:
  explicit RoughPlane(MotionColumns motion) : motion_(std::move(motion)) {}
  rendering::Prediction predict(const Model& model) override {
    rendering::Prediction prediction = PlanePredictor(motion_).predict(model);
    const rendering::NamedParameters* const friction = find_entry(model, "coulomb-friction");
    if (friction == nullptr) return prediction;
    constexpr double most_m = 1e-5;
    Vec3 bristle = Vec3::Zero();
    for (std::size_t i = 1; i < motion_.size(); ++i) {
      bristle += motion_.p_W_m[i] - motion_.p_W_m[i - 1];
      bristle.z() = 0.0;
      if (bristle.norm() > most_m) bristle *= most_m / bristle.norm();
      prediction.f_W_N[i] -= friction->parameters.at("mu") * prediction.normal_N[i] / most_m * bristle;
    }
    return prediction;
  }

 private:
  MotionColumns motion_;
};

// Strokes of 0.3 s to all sides with rests of 0.7 s, at 250 Hz for 20 s, always pressed.
MotionColumns strokes(double first_rad) {
  MotionColumns motion;
  Vec3 p_W_m(0.0, 0.0, 0.0);
  for (int i = 0; i < 5000; ++i) {
    const double t = 0.004 * i;
    const double way_rad = first_rad + 2.4 * std::floor(t);
    if (std::fmod(t, 1.0) < 0.3) p_W_m += 0.004 * 0.05 * Vec3(std::cos(way_rad), std::sin(way_rad), 0.0);
    p_W_m.z() = -1e-3 - 3e-4 * std::sin(5.0 * t);
    motion.t_s.push_back(t);
    motion.p_W_m.push_back(p_W_m);
  }
  return motion;
}

std::optional<std::string> fault_of_friction(double mu) {
  const rendering::MakePredictor make = [](const MotionColumns& motion) {
    return std::make_unique<RoughPlane>(motion);
  };
  Model base;
  base.parameters["stiffness_N_per_m"] = 900.0;
  Model truth = base;
  truth.effects.push_back({"coulomb-friction", {{"mu", mu}}, ""});
  InstrumentDescription instrument = small_noise(1.0);
  instrument.position_noise_m = 7e-5;
  const auto record = [&](double first_rad, std::uint64_t seed) {
    const MotionColumns path = strokes(first_rad);
    return measured(path, RoughPlane(path).predict(truth).f_W_N, instrument, seed);
  };
  const TwoRecordings two(record(0.0, 1), record(1.0, 2), instrument, base, make);
  Candidate dry{"coulomb-friction", Side::contact, {{"mu", "1", 0.0, 2.0, 0.3, ""}}};
  dry.traits.one_sided = {{{"mu", 0.05}}, 0.05, "friction of {:.2f}"};
  const FitData train = fit_data(two.data.train, base, two.data.window_s);
  const FitData validation = fit_data(two.data.validation, base, two.data.window_s);
  return find_coefficient_fault({two.data.train.recording, &train, two.data.train.noise},
                                {two.data.validation.recording, &validation, two.data.validation.noise}, base, base,
                                {dry});
}

// Most of the error is where the tip rests, to a side that the tracker's noise hides.
TEST(DataFaults, FrictionThatPullsAlongIsOneThoughTheTipRestsMostOfTheTime) {
  const auto fault = fault_of_friction(-0.5);
  ASSERT_TRUE(fault);
  EXPECT_THAT(*fault, ::testing::StartsWith("friction of -0."));
}

TEST(DataFaults, FrictionThatResistsAndNoneAreNoFault) {
  EXPECT_FALSE(fault_of_friction(0.5));
  EXPECT_FALSE(fault_of_friction(0.0));
}

// Strokes to one half of all sides: a constant force to that side is along nearly all of them.
TEST(DataFaults, ABiasThatTheSearchFoundPullsNoTipAlong) {
  const rendering::MakePredictor make = [](const MotionColumns& motion) {
    return std::make_unique<PlanePredictor>(motion);
  };
  Model base;
  base.parameters["stiffness_N_per_m"] = 900.0;
  Model truth = base;
  truth.instrument.push_back({"force-bias", {{"fx_N", 0.3}, {"fy_N", 0.0}, {"fz_N", 0.0}}, ""});
  const InstrumentDescription instrument = small_noise(1.0);
  const auto record = [&](double first, std::uint64_t seed) {
    MotionColumns path;
    Vec3 p_W_m(0.0, 0.0, 0.0);
    for (int i = 0; i < 5000; ++i) {
      const double t = 0.004 * i;
      const double way_rad = 1.45 * std::sin(first + 2.4 * std::floor(t));
      p_W_m += 0.004 * (0.02 + 0.03 * std::fmod(t, 1.0)) * Vec3(std::cos(way_rad), std::sin(way_rad), 0.0);
      p_W_m.z() = -1e-3 - 3e-4 * std::sin(5.0 * t);
      path.t_s.push_back(t);
      path.p_W_m.push_back(p_W_m);
    }
    return measured(path, PlanePredictor(path).predict(truth).f_W_N, instrument, seed);
  };
  const TwoRecordings two(record(0.0, 1), record(1.0, 2), instrument, base, make);
  Candidate dry{"coulomb-friction", Side::contact, {{"mu", "1", 0.0, 2.0, 0.3, ""}}};
  dry.traits.one_sided = {{{"mu", 0.05}}, 0.05, "friction of {:.2f}"};
  Candidate falling{"stribeck-friction", Side::contact, {}};
  falling.traits.velocity_weakening = true;
  falling.traits.contains = {"coulomb-friction"};
  const auto fault_beside = [&](const Model& best) {
    const FitData train = fit_data(two.data.train, base, two.data.window_s);
    const FitData validation = fit_data(two.data.validation, base, two.data.window_s);
    return find_coefficient_fault({two.data.train.recording, &train, two.data.train.noise},
                                  {two.data.validation.recording, &validation, two.data.validation.noise}, base, best,
                                  {dry, falling});
  };
  EXPECT_TRUE(fault_beside(base));
  EXPECT_FALSE(fault_beside(truth));
}

}  // namespace
}  // namespace touchstone::discrepancy
