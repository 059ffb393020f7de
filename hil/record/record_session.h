// From a wrench source to a raw recording, until time is up or someone stops it, with a live plot where there is a
// terminal.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "record/raw_recorder.h"

namespace touchstone::hil {

struct RecordOptions {
  double seconds = 0.0;          // 0: until stopped
  double nominal_rate_Hz = 0.0;  // of a sensor that states none; 0: unknown
  double silence_s = 2.0;        // a stream that sends nothing for so long has stopped: the run ends
  bool plot = true;              // on stderr, only where that is a terminal
  RawRecorderOptions recorder;
};

struct RecordReport {
  StreamCounters stream;
  std::uint64_t written = 0, lost_in_memory = 0;
  double seconds = 0.0;
  bool stopped = false;          // by the user
  bool silent = false;           // the stream stopped
  double device_rate_Hz = 0.0;   // as the device states it; 0: it does not
  double arrival_rate_Hz = 0.0;  // of samples that came or were lost, between the first and the last

  // What is wrong with the recording, one sentence each; none: it is whole.
  [[nodiscard]] std::vector<std::string> problems() const;
};

// `stop` is asked between reads. A stream that stops ends the run, with report.silent. Throws DeviceError when the
// device goes (what came until then is on disk), BadData when the disk fails.
RecordReport record_session(WrenchSource& source, const std::filesystem::path& path, const RecordOptions& options,
                            const std::function<bool()>& stop);

}  // namespace touchstone::hil
