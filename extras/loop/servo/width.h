// The largest stable stiffness of a wall, over virtual damping, latency or period: the Z-width of a device in a hand
// (Colgate and Brown, ICRA 1994). Found by hitting a flat wall slowly and fast, and pressing it with 1 N, beside what
// theory knows.
#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include "servo/setup.h"

namespace touchstone::servo {

enum class WidthOver : std::uint8_t { virtual_damping, latency, period };

struct WidthPoint {
  double at = 0.0;  // N s/m or s
  // Simulated, the smallest over the masses that are tried; 0: none.
  double unfelt_N_per_m = 0.0;  // nothing is felt of the loop: the verdict is stable
  double held_N_per_m = 0.0;    // the hand is not thrown out of contact
  // Theory, with the same hand and the mass that it allows least; NaN: none.
  double linear_N_per_m = 0.0;   // the eigenvalues of the sampled loop, without quantisation and dry friction
  double passive_N_per_m = 0.0;  // Colgate and Schenkel's, of the device alone
};

inline constexpr double least_wall_N_per_m = 10.0;
inline constexpr double stiffest_wall_N_per_m = 1e5;

// Down to the wall z = 0 from 2 mm above at that speed, into it as far as presses with 1 N, and there for 1.5 s, with
// the tremor of a hand of 0.05 mm (root mean square; synthetic/trajectories/tremor.h). Dry friction may hold a wall
// that is pressed gently and not one that is hit: walls are tried at 0.03 and 0.3 m/s.
MotionColumns hit(const LoopParameters& parameters, double speed_m_per_s);

std::vector<WidthPoint> stable_width(const LoopSetup& setup, WidthOver over, const std::vector<double>& at,
                                     const perception::Thresholds& thresholds);

// The stiffest wall with a virtual damping that stays stable when it is `margin` times as stiff, in all of the setups
// (one device in several hands), and the least damping with which it is within 3 % of that.
struct TunedWall {
  double stiffness_N_per_m = 0.0;  // 0: none is stable
  double virtual_damping_N_s_per_m = 0.0;
  double undamped_N_per_m = 0.0;  // the same without virtual damping
};
TunedWall tune(const std::vector<LoopSetup>& setups, double margin, const perception::Thresholds& thresholds);

}  // namespace touchstone::servo
