// A scan as instruments see it: the truth sampled by a force sensor and a tracker, each with its own clock and errors,
// and brought to the tracker's times as the 2006 paper does ("forces have been resampled to align in time with the
// position samples"). The exact answer at the same times and everything that was added are kept.
#pragma once

#include <string>
#include <vector>

#include "force_sensor.h"
#include "harness/recording/trajectory.h"
#include "rigid_scan.h"
#include "tracker.h"

namespace touchstone::datasets {

struct MeasuredScan {
  recording::Recording recording;  // ball's centre, orientation and force as measured, at the tracker's times
  std::vector<ScanTruth> truth;    // at the same times
  ForceMeasurement force;          // the raw samples, with what was added
  PoseMeasurement pose;            // the raw samples, with what was added
  std::vector<std::string> notes;  // how the clocks were brought together

  // The exact out-trajectory.
  [[nodiscard]] recording::OutTrajectory out_trajectory(double tip_radius_m) const;
  // What a flawless renderer of stiffness k with the scan's own friction answers to the exact in-trajectory: tip, proxy
  // (the ball's centre on the offset surface), force, contact.
  [[nodiscard]] recording::RenderedTrajectory exact_answer(double tip_radius_m, double stiffness_N_per_m) const;
};

// The tracker's lag is part of the stamps: the truth is taken at the stamps without it. Sensor and tracker draw from
// independent streams of the seed. `object_pose`: X_WB of an object that moves, in whose frame B the scan is; the
// tracker then measures probe and object in the world, each with its noise, and everything is brought into B as an
// experimenter would. An object that a motor moves feels nothing of its motion but through the probe: the contact is
// the same.
MeasuredScan measure(const RigidScan& scan, const ForceSensor& sensor, const Tracker& tracker, std::uint64_t seed,
                     Tracker::Pose (*object_pose)(double t_s) = nullptr);

}  // namespace touchstone::datasets
