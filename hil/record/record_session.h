// From a wrench source to a raw recording, until time is up or someone stops it, with a live plot where there is a
// terminal.
#pragma once

#include <filesystem>
#include <functional>

#include "hil/record/raw_recorder.h"

namespace touchstone::hil {

struct RecordOptions {
  double seconds = 0.0;  // 0: until stopped
  double nominal_rate_Hz = 0.0;
  bool plot = true;  // on stderr, only where that is a terminal
  RawRecorderOptions recorder;
};

struct RecordReport {
  StreamCounters stream;
  std::uint64_t written = 0, lost_in_memory = 0;
  double seconds = 0.0;
  bool stopped = false;  // by the user
};

// `stop` is asked between reads. Throws DeviceError when the device goes (what came until then is on disk), BadData
// when the disk fails.
RecordReport record_session(WrenchSource& source, const std::filesystem::path& path, const RecordOptions& options,
                            const std::function<bool()>& stop);

// A raw recording as CSV that `touchstone acquire` reads: t_s, fx_N .. tz_Nm, flags. Times come from a straight line
// through sequence numbers and arrival times, because samples arrive in packets; its scatter is returned. Several files
// are joined in order (a spilled rest).
struct ExportReport {
  std::uint64_t samples = 0, damaged_bytes = 0;
  std::uint64_t missing_samples = 0;  // by the device's sequence numbers: lost on the way, in memory or in the file
  double rate_Hz = 0.0, arrival_scatter_s = 0.0;
  bool emulated = false;
};
ExportReport export_raw(const std::vector<std::filesystem::path>& files, const std::filesystem::path& csv);

}  // namespace touchstone::hil
