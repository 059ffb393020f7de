// The processes of the spring experiment: a real spring through its sensors, and the six conditions as ordinary models
// (spring-linear and spring-quadratic with a haptic-device effect) pressed by a finger.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "experiments/press_motion.h"
#include "harness/perception/haptic_data_matrix.h"
#include "harness/rendering/model.h"

namespace touchstone::experiments {

// How k of F = k dx^2 goes with k of F = k dx; the paper writes the same letter for both and no number.
enum class QuadraticRule {
  equal_at_full_stroke,  // both forces agree at the full stroke
  same_number,           // the same number in N/mm and N/mm^2
};

struct SpringSetup {
  PressMotion motion;
  double stiffness_N_per_m = 600.0;  // ours: 6 N at the full stroke, more than Touch can give, less than Touch X
  QuadraticRule rule = QuadraticRule::same_number;
  double rate_Hz = 1000.0;  // of the recordings, as in the paper
  double simulation_rate_Hz = 4000.0;
  // Sensors of the finger, the same for every process; ours but for the resolution that section 2.1 asks for.
  double force_noise_N = 0.01;
  double force_step_N = 0.01;
  double distance_noise_m = 2e-5;  // of the distance module under the real spring; devices read their encoders
};

struct SpringCondition {
  std::string name;  // "Omega.7, F = k dx"
  std::string device;
  bool linear;
  rendering::Model model;
};
// Linear on Omega.7, Touch X, Touch, then quadratic on Touch, Touch X, Omega.7: the paper's order of likeness (table
// 2).
std::vector<SpringCondition> spring_conditions(const SpringSetup& setup);

// Every process has a finger and noise of its own: streams of the seed.
perception::PressSignal press_real_spring(const SpringSetup& setup, std::uint64_t seed);
perception::PressSignal press_condition(const SpringSetup& setup, const SpringCondition& condition, std::uint64_t seed,
                                        std::size_t stream);

}  // namespace touchstone::experiments
