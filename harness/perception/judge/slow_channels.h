// Evidence of the channels that come from the responses: force, stiffness, rate, direction, friction.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "harness/base/rooms.h"
#include "harness/perception/judge/response.h"
#include "harness/perception/judge/thresholds.h"

namespace touchstone::perception {

struct SlowEvidence {
  bool known = false;
  double jnd = 0.0;
  double depth_m = 0.0;
  double real = 0.0;  // force, stiffness, force of the rate, angle, friction: what the channel compares
  double rendered = 0.0;
};
enum class SlowChannel : unsigned char { force, stiffness, rate, direction, friction };
inline constexpr std::size_t kSlowChannels = 5;
using SlowEvidences = std::array<SlowEvidence, kSlowChannels>;

// At which depths both were seen: 20 to 100 % of the shallower press.
std::vector<double> common_depths_m(const Response& real, const Response& rendered);

SlowEvidences slow_evidence(const Response& real, const ResponseCurves& real_curves, const Response& rendered,
                            const ResponseCurves& rendered_curves, const std::vector<double>& depths_m,
                            const Thresholds& thresholds);

// Standard errors in JND by leaving out blocks: of both together if they share a motion, else one after the other.
std::array<double, kSlowChannels> slow_errors(const Response& real, const Response& rendered, bool same_motion,
                                              const std::vector<double>& depths_m, const Thresholds& thresholds);

}  // namespace touchstone::perception
