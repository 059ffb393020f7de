// Raw recordings as tables that `touchstone acquire` reads, on one time axis.
//   A device that numbers its samples, or stamps them by a clock of its own, gets its times from the line (or the
// parabola, where its rate drifts) below all arrivals over these numbers: arrivals are late, never early
// (DriftingClock). A device with neither has its arrival times.
#pragma once

#include <filesystem>
#include <limits>
#include <string>
#include <vector>

#include "record/drifting_clock.h"
#include "record/stream.h"

namespace touchstone::hil {

struct ExportReport {
  RawHeader header;
  StreamKind kind = StreamKind::force;
  std::uint64_t samples = 0, damaged_bytes = 0;
  std::uint64_t missing_samples = 0;   // by the device's sequence numbers: lost on the way, in memory or in the file
  std::uint64_t left_out_samples = 0;  // no rows of the table: not after the one before (a frame sent twice)
  double rate_Hz = 0.0;
  double first_s = 0.0, last_s = 0.0;              // by this machine's clock
  double mean_delay_s = 0.0, worst_delay_s = 0.0;  // of the arrivals against the time axis; 0 where it is the arrivals
  double axis_uncertainty_s = 0.0;                 // largest of the least delays of 16 stretches
  double clock_ppm = std::numeric_limits<double>::quiet_NaN();  // of the device's clock where a rate is stated
  double rate_change_ppm = 0.0;                                 // over the recording, where a drift was found
  bool emulated = false;

  // What is wrong with the times, one sentence; empty: nothing. An axis that is uncertain by more than half a sample
  // interval puts samples in their neighbours' places; below 5 ms a busy network's shortest delays scatter as much, and
  // below 50 ms where a stretch has fewer than 30 arrivals to be the least of.
  [[nodiscard]] std::string axis_problem() const;
};

// One stream, in one file (and its .rest beside it) or several in order. A force stream gives t_s, fx_N .. tz_Nm,
// flags; a motion t_s, x_m, y_m, z_m, qw .. qz, tracked, device_status. Throws BadData naming the file.
ExportReport export_raw(const std::vector<std::filesystem::path>& files, const std::filesystem::path& csv);

struct SessionExport {
  struct Table {
    std::string name;
    std::filesystem::path csv;
    ExportReport report;
  };
  std::vector<Table> tables;
};

// All streams of a folder that record_streams() made, also after a crash: <name>.csv beside each <name>.tsraw (and its
// .rest, where there is one), t_s from the earliest sample of them all; and session.json (schema
// "touchstone-session/1"), which says how each came out. Existing tables are written anew.
SessionExport export_session(const std::filesystem::path& folder);

}  // namespace touchstone::hil
