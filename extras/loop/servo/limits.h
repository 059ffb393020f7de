// What is known in closed form, or exactly, of the stability of a virtual wall F = K d + B d' on a mass m with viscous
// friction b and Coulomb friction F_c, sampled with the period T in steps of Delta and answered after the latency t_d.
// The functions are of the linear system, computed by other means than the simulation (servo_loop.h), which is held
// against them.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

#include "servo/servo_loop.h"

namespace touchstone::servo {

// Passive whatever the hand does, and so stable with every hand: b > K T / 2 + |B| (Colgate and Schenkel, J. Robotic
// Systems 14, 1997, for a wall with B by backward difference). 0 where no stiffness is.
double passive_stiffness_N_per_m(double b, double virtual_b, double period_s);

// The linear condition K < (b + B) / (T/2 + t_d), which the stable region of a sampled wall follows while K and B are
// far from what mass and period allow (Gil, Sanchez, Hulin, Preusche and Hirzinger, J. Computing and Information
// Science in Engineering 9, 2009). Whatever damping the hand adds is part of b.
double linear_stiffness_N_per_m(double b, double virtual_b, double period_s, double latency_s);

// Passive with quantisation: K <= min(2 b / T, 2 F_c / Delta) (Abbott and Okamura, IEEE Trans. Robotics 21, 2005).
double quantised_passive_stiffness_N_per_m(double b, double friction_N, double period_s, double resolution_m);

// The four regions of Diolaiti, Niemeyer, Barbagli and Salisbury, IEEE Trans. Robotics 22 (2006): whether the sampling
// gives more energy than viscous friction takes, and the quantisation more than Coulomb friction does.
enum class Region : std::uint8_t {
  passive,          // neither: nothing vibrates
  small_vibration,  // quantisation alone: a vibration of some steps of the encoder, which does not grow
  large_unstable,   // sampling alone: rests if it is left at rest, grows when struck
  unstable,         // both
};
Region region(double stiffness, double b, double friction_N, double period_s, double resolution_m);
std::string_view name_of(Region region);

// The largest modulus of the eigenvalues of one period of the linear loop without quantisation and Coulomb friction, in
// contact throughout (Astrom and Wittenmark, Computer-Controlled Systems, section 3.2: sampling with a latency of any
// part of a period); below 1 it is stable. Hand, filter, actuator and latency as in `parameters`; jitter is left out.
struct Mode {
  double modulus = 0.0;
  double frequency_Hz = 0.0;  // of that eigenvalue
};
Mode dominant_mode(const LoopParameters& parameters, double stiffness_N_per_m);

// The stiffness from which on the linear loop is unstable, with the frequency there; nothing if it is unstable at every
// stiffness, or stable up to 1e7 N/m.
struct CriticalGain {
  double stiffness_N_per_m = 0.0;
  double frequency_Hz = 0.0;
};
std::optional<CriticalGain> critical_gain(const LoopParameters& parameters);

// The vibration that a quantised wall of this stiffness settles at, about a place in the middle of a step, by
// describing functions: the quantiser's (Gelb and Vander Velde 1968, section 2.3) times K must be the stiffness at
// which the loop is critical, with Coulomb friction as the viscous friction 4 F_c / (pi A w). The larger of two such
// amplitudes is the stable one. Nothing: none settles.
struct LimitCycle {
  double amplitude_m = 0.0;
  double frequency_Hz = 0.0;
};
std::optional<LimitCycle> limit_cycle(const LoopParameters& parameters, double stiffness_N_per_m);
// Of a quantiser with steps of `step` that rounds to the nearest, for a sine of that amplitude: 1 for large ones.
double quantiser_gain(double amplitude, double step);

}  // namespace touchstone::servo
