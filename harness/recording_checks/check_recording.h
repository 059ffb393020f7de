// The gate that every command passes a recording through before it fits or judges anything: is the recording sane? Each
// fault is a hypothesis that was tried; what is reported names the repair and what it gains. Nothing is repaired
// silently, and constant loads, one axis, few samples and recordings that touch little are legitimate.
#pragma once

#include <string>
#include <vector>

#include "harness/recording/trajectory.h"
#include "harness/recording_checks/recording_fault.h"
#include "harness/surface/surface.h"

namespace touchstone::recording_checks {

enum class FaultWeight {
  remark,  // worth knowing: results are what they are
  fault,   // results would be wrong without the repair
};

struct RecordingFinding {
  FaultWeight weight = FaultWeight::fault;
  RecordingFault fault = RecordingFault::reversed_force;
  std::string message;  // what was found, with numbers before and after the repair
  std::string repair;   // the flag or the key of an import map that does it; what to do where there is none
};

struct RecordingContext {
  const surface::Surface* surface = nullptr;
  std::string mesh_unit = "m";
  double tip_radius_m = 0.0;
  bool force_flipped = false;  // the user gave --flip-force: `recording` is flipped already
  double contact_force_N = 0.05;
  // A repair (clock, order, frame) is named if less than this share of the square of what does not fit is left with it.
  // Half: the fault matters more than all else that acts, friction and damping too. And the share of the load that must
  // be measured where there is no object. docs/explanation/recording-check-rates.md shows how far both may move.
  double most_left_with_repair = 0.5, noticed_share_of_load = 0.1;
};

// What is wrong with `recording`, gravest first. `recording.source` names it in messages of refuse_faulty().
std::vector<RecordingFinding> find_recording_faults(const recording::Recording& recording,
                                                    const RecordingContext& context);

// Throws BadData for the first fault. Returns a line for each remark.
std::vector<std::string> refuse_faulty(const recording::Recording& recording, const RecordingContext& context);

// "the force is reversed ...; give --flip-force"
std::string finding_line(const RecordingFinding& finding);

}  // namespace touchstone::recording_checks
