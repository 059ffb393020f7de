// Force and pose from instruments with clocks of their own, brought to common times: one Recording.
// Both clocks must count from the same instant; how they are synchronised is the acquisition's business.
#pragma once

#include <string>
#include <vector>

#include "harness/base/vec.h"
#include "harness/recording/clock.h"
#include "harness/recording/resample.h"
#include "harness/recording/trajectory.h"

namespace touchstone::recording {

// What a force sensor gave, in the object's frame or about to be turned into it.
struct ForceColumns {
  std::vector<double> t_s;
  std::vector<Vec3> f_W_N;
  std::vector<Vec3> torque_W_Nm;  // empty where not measured
};

enum class CommonTimes : std::uint8_t {
  pose,     // the tracker's
  force,    // the force sensor's
  uniform,  // start of the common span, then every 1 / rate_Hz
};

struct CombineOptions {
  CommonTimes times = CommonTimes::pose;
  double rate_Hz = 0.0;                          // CommonTimes::uniform
  Interpolation pose = Interpolation::cubic;     // orientation always by slerp
  Interpolation force = Interpolation::linear;   // where the force sensor is at least twice as fast as the common
                                                 // times, a windowed average takes its place
  double gap_factor = ClockPolicy{}.gap_factor;  // longer intervals than this many medians are not bridged
  OnGap on_gap = OnGap::keep;                    // keep, split: samples that would lie in a gap are left out; refuse
};

struct Combined {
  Recording recording;             // only samples that both instruments cover
  std::vector<std::string> notes;  // the methods chosen, and how many samples were left out and why
};

// Throws BadData where the two do not overlap, or on_gap is refuse and there is a gap.
Combined combine(const MotionColumns& pose, const ForceColumns& force, const CombineOptions& options = {});

}  // namespace touchstone::recording
