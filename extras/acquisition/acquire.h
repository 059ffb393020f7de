// Raw streams to a Recording, each step reported with its residual: voltages to wrenches, tool load removed by the
// measured orientation, clocks aligned by taps, tracker registered to the object by markers and contacts, force moved
// to the tip, smoothed with a stated bandwidth and brought to the motion's samples. (2006 paper, section 2.)
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "description.h"
#include "force_gains.h"
#include "harness/recording/trajectory.h"
#include "object_move.h"
#include "smoothing.h"

namespace touchstone::acquisition {
using recording::ToolIdentification;
using recording::WrenchResidual;

struct FlaggedSamples {
  std::size_t total = 0, saturated = 0, out_of_range = 0, not_finite = 0;
};

struct AcquisitionReport {
  FlaggedSamples force_samples;
  std::optional<ToolIdentification> tool;  // where identified from orientations
  ForceGains gains;                        // of the force's axes, by the same orientations
  std::optional<GainError> gain_error;     // of the session's contact forces
  std::optional<ClockAlignment> clocks;    // where aligned by taps
  std::optional<MarkerRegistration> markers;
  std::optional<ContactRegistration> contacts;
  std::optional<ObjectMove> object_move;
  WrenchResidual free_air;           // of the compensated force while nothing was touched
  bool contact_in_free_air = false;  // something was touched where nothing should be; a note says where
  double force_bandwidth_Hz = 0.0;
  double motion_bandwidth_Hz = 0.0;  // half the tracker's rate where positions were not smoothed
  double noise_gain = 0.0;           // of the force's smoothing
  std::size_t samples_without_tracking = 0;
  std::vector<std::string> notes;                           // what a reader must know, one sentence each
  std::vector<std::pair<std::string, std::string>> inputs;  // file, SHA-256
};

struct Acquired {
  recording::Recording recording;
  AcquisitionReport report;
};

// Throws BadData naming file, place, value and what to do.
Acquired acquire(const AcquisitionDescription& description);

// The report as JSON, schema "touchstone-acquisition-report/1", and as lines for people.
std::string report_json(const AcquisitionReport& report);
std::string report_text(const AcquisitionReport& report);
// A tool that was identified, for people: its values with their deviations, and what it leaves. If no tool fits the
// forces, gains of the axes mean nothing, and it says what would tell them.
std::string tool_text(const ToolIdentification& tool, const ForceGains& gains, bool forces_fit);

}  // namespace touchstone::acquisition
