// The streams of a session as they came: forces from gauge voltages or wrenches, the tip's places from the tracker's
// poses, without what the tracker did not measure.
#pragma once

#include <algorithm>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "acquire.h"
#include "description.h"
#include "harness/base/wrench.h"

namespace touchstone::acquisition {

inline const std::vector<std::pair<std::string, double>> length_units{{"m", 1.0}, {"mm", 1e-3}};
inline constexpr std::size_t fewest_of_bias = 10;  // samples

struct ForceStream {
  std::vector<double> t_s;
  std::vector<Wrench> wrench;  // sensor frame, bias of the gauges removed where there is an interval for it
};

struct MotionStream {
  std::vector<double> t_s;
  std::vector<Vec3> tip_T_m;
  std::vector<Quat> q_TS;
  std::vector<std::pair<double, double>> gaps;
  double noise_m = 0.0;  // of the tip, one component
};

// Both throw BadData naming file and place; what a reader must know is added to the report's notes.
ForceStream read_force(const AcquisitionDescription& description, AcquisitionReport& report);
MotionStream read_motion(const AcquisitionDescription& description, AcquisitionReport& report);

// Within the motion's time and away from its gaps.
inline bool has_motion(const MotionStream& motion, double t_motion_s) {
  if (t_motion_s < motion.t_s.front() || t_motion_s > motion.t_s.back()) return false;
  return std::none_of(motion.gaps.begin(), motion.gaps.end(),
                      [&](const auto& gap) { return t_motion_s > gap.first && t_motion_s < gap.second; });
}

}  // namespace touchstone::acquisition
