// The finger of the spring experiment: presses in the beat of a metronome, none like the other, with the tremor of a
// hand.
#pragma once

#include <cstdint>
#include <vector>

namespace touchstone::experiments {

// The paper gives neither stroke nor beat nor how the presses differ: all of this is ours.
struct PressMotion {
  double stroke_m = 0.010;
  double beat_Hz = 1.0;
  int presses = 10;
  double stroke_spread = 0.03;    // standard deviation of a press's stroke, as a share
  double onset_spread_s = 0.010;  // standard deviation of a press's time against the beat
  double tremor_m = 2e-5;         // RMS of its tremor (synthetic/trajectories/tremor.h)

  [[nodiscard]] double duration_s() const { return static_cast<double>(presses) / beat_Hz; }
};

// Depth of the fingertip at n / rate, from the first contact on (0 or more), a smooth function of the seed.
std::vector<double> press_depths_m(const PressMotion& motion, double rate_Hz, std::uint64_t seed);

}  // namespace touchstone::experiments
