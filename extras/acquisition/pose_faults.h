// Poses that the tracker did not measure: its last one, repeated while the probe was hidden (VRPN servers do that), and
// poses of another body or of exchanged markers, which stand off by a jump that no hand makes.
//   A jump: one step between two frames that stands out of the three on either side of it, and for which the tip would
// have to be brought to speed and to rest again within a frame, with 4 s / dt^2 for a step of s. 25 m/s^2 is the limit:
// voluntary strokes of a hand that holds a probe stay below 10 m/s^2 (Flash and Hogan 1985: 5.77 d / T^2 for a stroke
// of d in T, 0.2 m in 0.35 s), a tremor of 1 mm at 12 Hz makes 6 m/s^2. What an impact stops was fast before it, so
// that its steps do not stand out.
//   Noise is taken from third differences, whose variance is 1 + 9 + 9 + 1 = 20 times that of one component.
#pragma once

#include <vector>

#include "harness/base/vec.h"

namespace touchstone::acquisition {

struct PoseFaults {
  struct Stretch {
    double from_s = 0.0, to_s = 0.0;
    double off_m = 0.0;  // how far the tip is off there
  };
  std::vector<bool> measured;          // per pose
  std::vector<Stretch> held, swapped;  // repeats of an older pose; between two jumps, there and back
  std::vector<Stretch> jumped;         // without a way back: from_s is the time of the jump
  double noise_m = 0.0;                // of the tip, one component

  [[nodiscard]] bool any() const { return !held.empty() || !swapped.empty() || !jumped.empty(); }
};

// Standard deviation of one component of the tip's measured place; 0 with fewer than four poses.
double tip_noise_m(const std::vector<Vec3>& tip_m);

// `tip_m` and `q` of every pose, at increasing times.
PoseFaults find_pose_faults(const std::vector<double>& t_s, const std::vector<Vec3>& tip_m, const std::vector<Quat>& q);

}  // namespace touchstone::acquisition
