// Faults that single columns show by themselves: stuck (the same number while the rest moves on; the whole force or one
// of its channels), clipped at an end of the range, and stretches that repeat an earlier stretch number by number, as
// when a buffer was written twice. What stands still is a fault only where the rest shows the noise of a measurement.
// A force whose axis is zero throughout was not measured: legitimate in recordings of one axis.
#pragma once

#include <string>
#include <vector>

#include "harness/recording/trajectory.h"
#include "harness/recording_checks/recording_fault.h"

namespace touchstone::recording_checks {

struct ColumnFault {
  RecordingFault fault = RecordingFault::stuck_position;
  std::string message;  // what was found and where
  std::string repair;   // what to do
};

std::vector<ColumnFault> find_column_faults(const recording::Recording& recording);

}  // namespace touchstone::recording_checks
