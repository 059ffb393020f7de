// A recording with a hidden cause: planned from a seed, simulated at 10 kHz with a tool on a hand, seen through a force
// sensor and a 60 Hz tracker. What a user of the search for missing effects gets is a mesh, a starting model, a
// declared instrument and two recordings; the cause goes into an answer apart.
#pragma once

#include <limits>
#include <map>
#include <string>
#include <vector>

#include "harness/recording/trajectory.h"
#include "hidden_physics/hand_script.h"
#include "hidden_physics/hidden_physics.h"

namespace touchstone::hidden_physics {

// What shakes the sensor above the band of a hand: mains hum, a mount that rings, a buzz that sliding makes. SI units,
// sensor's frame; amplitudes of zero switch each part off.
struct HiddenShaking {
  double hum_N = 0.0;  // of the fundamental
  double hum_Hz = 50.0;
  double hum_second = 0.0;  // amplitude of the second harmonic over the fundamental's
  double hum_phase_rad = 0.0;
  double buzz_N = 0.0;  // at the typical load, in proportion to the load, while the tip slides
  double buzz_Hz = 100.0;
  double buzz_from_m_per_s = 0.0;  // slides faster than this
  double buzz_load_N = 1.0;        // the typical load
  double ringing_N = 0.0;          // RMS of a lightly damped oscillator that white noise drives
  double ringing_Hz = 80.0;
  double ringing_damping = 0.02;  // share of critical
  Vec3 along_S = Vec3::UnitX();
};

// How the sensor's reading differs from the contact's force, beyond noise.
struct HiddenInstrument {
  double weight_kg = 0.0;
  double inertia_kg = 0.0;
  Vec3 bias_S_N = Vec3::Zero();
  Vec3 drift_S_N_per_s = Vec3::Zero();
  double c_xz = 0.0;
  double c_yz = 0.0;
  double limit_N = std::numeric_limits<double>::infinity();
  double lag_s = 0.0;
  Vec3 shift_W_m = Vec3::Zero();  // measured = true + shift + turn x true
  Vec3 turn_rad = Vec3::Zero();
};

struct DeclaredInstrument {
  double force_noise_N = 0.01;
  double force_noise_time_constant_s = 0.01;
  Vec3 force_step_N{1.0 / 320.0, 1.0 / 320.0, 1.0 / 640.0};
  double position_noise_m = 5e-5;  // of one tracker sample, before its low-pass
  double position_rate_Hz = 60.0;
  double geometry_error_m = 0.0;
};

enum class Corruption { none, shuffled_blocks, negative_friction, negative_mass };

struct HiddenEffect {
  std::string name;
  std::string side;  // "contact", "instrument" or "unknown"
  std::map<std::string, double> parameters;
};

struct BlindCase {
  std::string id;
  std::string set;      // "one", "one-noisy", "two", "three", "none", "unknown", "cannot-tell", "corrupted",
                        // "full-band", "outside"
  std::string verdict;  // expected
  std::vector<HiddenEffect> effects;
  std::vector<std::string> ambiguous;
  std::vector<std::string> follows;  // what a law for the hidden effect may say that it follows: one of these
  TrueSurface truth;
  TrueSurface meshed;  // what the mesh is made from: lacks a hidden bump and carries the mesh's own error
  std::size_t cells = 64;
  HiddenPhysics physics;
  HiddenInstrument instrument;
  HiddenShaking shaking;
  DeclaredInstrument declared;
  Corruption corruption = Corruption::none;
  double nominal_stiffness_N_per_m = 0.0;  // of the starting model
  ScriptSettings train;
  ScriptSettings holdout;
  std::uint64_t seed = 0;
};

// The sets, in order.
const std::vector<std::string>& blind_sets();

// Case number `index` of a set. Effects take turns, so that a set of 20 n cases holds each n times.
BlindCase plan_case(const std::string& set, std::size_t index, std::uint64_t seed);

// Deterministic. 250 Hz.
recording::Recording record(const BlindCase& plan, bool holdout);

// What the case's object and instruments show when a machine leads the tip along a given motion of equal time steps:
// for the recording that a search asks for. `repetition`: the motion is the same, the noise is not.
recording::Recording record_along(const BlindCase& plan, const MotionColumns& motion, std::uint64_t repetition);

}  // namespace touchstone::hidden_physics
