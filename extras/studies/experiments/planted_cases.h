// Presses on a simulated spring with one planted difference each, and the d' that published thresholds give it, worked
// out from the planted number alone: what every metric of perception is held against.
//
// The real process: a linear spring pressed from free air with friction-free sideways motion of a few millimetres, seen
// through a force sensor and a tracker with white noise. Every recording has a hand of its own: strokes, onsets and
// tremor differ from press to press (synthetic tremor: Riviere, Rader and Khosla 1997).
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "harness/perception/judge/thresholds.h"
#include "harness/recording/trajectory.h"

namespace touchstone::experiments {

struct PlantedSetup {
  double stiffness_N_per_m = 500.0;
  double rate_Hz = 1000.0;
  double force_noise_N = 0.005;
  double position_noise_m = 1e-5;
  double peak_N = 4.0;  // at the full stroke
  double beat_Hz = 1.0;
  int presses = 10;
  double sliding_m_per_s = 0.02;
};

struct PlantedCase {
  std::string name;        // "softer 10 %"
  std::string family;      // "softer"
  double softer = 0.0;     // share of the stiffness
  double plateau_N = 0.0;  // the force rises within 0.3 of the stroke, then stays; 0: a spring
  double buzz_N = 0.0;     // amplitude in contact
  double buzz_Hz = 0.0;
  double sideways_N = 0.0;         // at the full stroke, in proportion to depth
  double tilt_rad = 0.0;           // of the whole force
  double late_m = 0.0;             // contact begins deeper
  double delay_s = 0.0;            // of force behind motion
  double recording_delay_s = 0.0;  // of the recording as a whole: no difference
  double deeper = 1.0;             // stroke: no difference
  double faster = 1.0;             // beat: no difference
  double longer = 1.0;             // number of presses: no difference
  double noisier = 1.0;            // force noise of the sensor: no difference of what is felt
  double texture_N = 0.0;          // amplitude over place
  double texture_wavelength_m = 0.0005;
  double quantum_N = 0.0;  // force comes in steps
  double friction = 0.0;   // coefficient against sliding: sticking
  double tap_N = 0.0;      // decaying 300 Hz burst after contact at 50 mm/s, in proportion to the speed
};

// Every planted difference at the strengths that the bench uses, from none to clear.
std::vector<PlantedCase> planted_cases();

// What the thresholds of the literature give this difference: from the numbers of the case and the setup, no signal.
double planted_d_prime(const PlantedCase& planted, const PlantedSetup& setup, const perception::Thresholds& thresholds);

// One recording; outward is +z. `seed` makes the hand and the noise.
recording::Recording record_planted(const PlantedCase& planted, const PlantedSetup& setup, std::uint64_t seed);

}  // namespace touchstone::experiments
