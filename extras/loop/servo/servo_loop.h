// The closed loop: hand -> device -> renderer -> device -> hand.
//
// The hand means to follow a path and holds the device by a spring and a damper; the device is a mass with friction
// (axis_motion.h, three independent axes of the object's frame). Once a period the position is read in steps of the
// encoder, the renderer answers, and the force, limited, is held until the next one comes: after the latency, and late
// by the jitter. Sampling with hold as in Colgate and Schenkel, J. Robotic Systems 14 (1997); quantisation and Coulomb
// friction as in Abbott and Okamura, IEEE Trans. Robotics 21 (2005).
//
// The same inputs and seed give the same answer to the bit. Not modelled: the mechanism (inertia and friction that
// change with place and direction, springiness, gravity, backlash), stiction above Coulomb friction, and what the hand
// does on purpose when it feels something.
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "harness/base/motion.h"
#include "harness/base/vec.h"
#include "harness/rendering/renderer.h"
#include "servo/axis_motion.h"

namespace touchstone::servo {

struct LoopParameters {
  AxisParameters axis;        // mass: device and hand together
  double hand_mass_kg = 0.0;  // of that mass
  double period_s = 1e-3;
  double latency_s = 0.0;
  double jitter_s = 0.0;      // below one period
  double resolution_m = 0.0;  // 0: positions are exact
  double force_limit_N = std::numeric_limits<double>::infinity();
  // In contact the servo adds -B v along the normal, as engines do: v is the difference of measured positions after a
  // first-order filter.
  double virtual_damping_N_s_per_m = 0.0;
  double velocity_cutoff_Hz = std::numeric_limits<double>::infinity();
  bool exact_velocity = false;  // by differences of exact positions, not of measured ones
  double force_gain = 1.0;      // of the renderer's force: for a stiffness this many times as large
  std::uint64_t seed = 1;       // of the jitter
};

// At each sampling instant, before the new force acts. Energies since the beginning.
struct LoopTrace {
  std::vector<double> t_s;
  std::vector<Vec3> intended_W_m;
  std::vector<Vec3> tip_W_m;        // where the device is
  std::vector<Vec3> contact_W_m;    // the renderer's surface contact point
  std::vector<Vec3> commanded_W_N;  // the renderer's force with damping and limit
  std::vector<Vec3> felt_W_N;       // on the hand by the device
  std::vector<unsigned char> contact;
  std::vector<unsigned char> limited;  // the force limit cut it
  std::vector<double> by_actuator_J, by_hand_J, lost_J, kinetic_J;
  std::optional<double> left_at_s;  // the run ended here: the device went beyond any workspace

  [[nodiscard]] std::size_t size() const noexcept { return t_s.size(); }
};

// Resets the renderer and runs along the path, as long as it lasts; straight between its samples. `keep_every`: only
// every n-th sampling instant is recorded. Throws UsageError for parameters out of range, BadData where the
// renderer breaks down.
LoopTrace run_loop(rendering::Renderer& renderer, const MotionColumns& path, const LoopParameters& parameters,
                   std::size_t keep_every = 1);

// The same hand and device under a servo that is `ideal_rate` times as fast, without latency and lag, its velocity
// exact: what is left is the renderer's own. With `resolution_m` above 0 positions are still read in such steps, and
// what the hand feels of them as it moves is left too. Recorded at the instants of the other.
inline constexpr std::size_t ideal_rate = 16;
LoopTrace run_ideal_loop(rendering::Renderer& renderer, const MotionColumns& path, LoopParameters parameters,
                         double resolution_m = 0.0);

// The renderer alone over the path itself, at the servo's instants, as `touchstone replay` does: columns of what is
// felt, limits and energy stay empty.
LoopTrace run_open(rendering::Renderer& renderer, const MotionColumns& path, const LoopParameters& parameters);

}  // namespace touchstone::servo
