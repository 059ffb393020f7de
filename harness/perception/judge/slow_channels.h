// Evidence of the channels that come from the responses: force, stiffness, rate, direction, friction.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "harness/perception/judge/response.h"
#include "harness/perception/judge/thresholds.h"

namespace touchstone::perception {

struct SlowEvidence {
  bool known = false;
  double jnd = 0.0;
  double depth_m = 0.0;
  double real = 0.0;  // force, stiffness, force of the rate or delay, angle, friction: what the channel compares
  double rendered = 0.0;
  bool delay = false;  // of the rate's: a delay [s] of the force, not damping
  // Standard error in JND by another hand: its load and speed where friction is met, and what the responses leave.
  double by_hand = 0.0;
};
enum class SlowChannel : unsigned char { force, stiffness, rate, direction, friction };
inline constexpr std::size_t slow_channels = 5;
using SlowEvidences = std::array<SlowEvidence, slow_channels>;

// Mean direction of sliding one way: 5 % of the samples slide back.
inline constexpr double one_way_share = 0.9;

// Depth times slope over the force's magnitude at `depth_m`, its slope taken over the `step_m` above it: how much of an
// error of the depth arrives in the force. 0 where the force falls with depth, or there is none.
double depth_exponent(const ResponseCurves& curves, double depth_m, double step_m, const DepthGrid& grid);

// JND of a force over depth. People tell stiffness by the force at a depth that they reach again; how well they reach
// it explains how stiffness JNDs differ, and at a depth that is given the JND is that of force (Fu, van Paassen and
// Mulder 2017; read: its abstract). Who does not know the depth exactly cannot say whether the force or the depth was
// another: the observer's error of the depth arrives in the logarithm of the force, `exponent` times as large (1 for a
// spring, 0 for a constant force), and its variance adds to that of the force. `force_jnd`: the difference if the depth
// is known.
double force_at_depth_jnd(double force_jnd, double real_N, double rendered_N, double exponent,
                          const Thresholds& thresholds);

// JND of friction, which follows Weber's law unless it comes near the threshold of detection, and that threshold
// depends on what else is felt (JNDs of friction beside mass, spring and damper, TU Delft's repository; read: the
// abstract). `apart_N` is the difference of the vectors. In steps of the friction's own fraction from the force on that
// is noticed as a change of the load `load_N`, in proportion below.
double friction_jnd(double real_N, double rendered_N, double apart_N, double load_N, const Thresholds& thresholds);

// Standard error in JND by another hand: friction of another load may grow otherwise than by Amontons' law (growth.h),
// that of another speed as a fluid's at most. `loads`: the smaller over the larger; `speeds`: one over the other.
double friction_by_hand_jnd(double larger_N, double loads, double speeds, double load_N, const Thresholds& thresholds);

// Magnitude of the steady force of `own` at a depth, with the force across if it can be compared with that of `other`:
// friction hides in it where one of them slid one way only.
double steady_force_N(const Response& own, const Response& other, double depth_m);

// At which depths both were seen: 20 to 100 % of the shallower press.
std::vector<double> common_depths_m(const Response& real, const Response& rendered);

SlowEvidences slow_evidence(const Response& real, const ResponseCurves& real_curves, const Response& rendered,
                            const ResponseCurves& rendered_curves, bool same_motion,
                            const std::vector<double>& depths_m, const Thresholds& thresholds);

// Standard errors in JND by leaving out blocks: of both together if they share a motion, else one after the other.
std::array<double, slow_channels> slow_errors(const Response& real, const Response& rendered, bool same_motion,
                                              const std::vector<double>& depths_m, const Thresholds& thresholds);

}  // namespace touchstone::perception
