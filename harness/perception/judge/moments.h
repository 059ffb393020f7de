// Where and when a rendering differs: the mean force of every quarter of a second in contact against what the real
// process gives for the same motion.
#pragma once

#include <vector>

#include "harness/perception/judge/judge.h"

namespace touchstone::perception {

inline constexpr double moment_s = 0.25;

// With `same_motion` against the real force of that moment, else against the real process's response to the motion.
std::vector<FeltMoment> felt_moments(const JudgedProcess& real, const JudgedProcess& rendered, bool same_motion,
                                     const Thresholds& thresholds);

// Share of the moments above one JND; NaN without any.
double noticed_share(const std::vector<FeltMoment>& moments);

}  // namespace touchstone::perception
