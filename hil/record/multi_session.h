// Several devices in one run: a thread for each reads it and hands its samples to a raw recording of its own
// (raw_recorder.h), all by one clock of this machine. What one device does never waits for another.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "record/raw_recorder.h"
#include "record/stream.h"

namespace touchstone::hil {

// How a stream is doing.
struct StreamStatus {
  std::string name;
  StreamCounters counters;
  std::uint64_t written = 0, lost_in_memory = 0;
  double rate_Hz = 0.0;     // of samples that came in the last seconds
  double nominal_Hz = 0.0;  // as the device or the hardware map states it; 0: neither does
  double clock_ppm =
      0.0;  // of the device's clock against this machine's, by the line below all arrivals; NaN: no such clock
  double delay_s = 0.0;   // of the last samples against that line
  double silent_s = 0.0;  // since a sample came
  bool disk_stalled = false;
};
// One line per stream: rate, skew, delay, loss, silence.
std::string status_table(const std::vector<StreamStatus>& streams, double seconds);

struct MultiOptions {
  double seconds = 0.0;          // 0: until stopped
  double silence_s = 2.0;        // a stream that sends nothing for so long has stopped: the run ends
  double disk_patience_s = 5.0;  // a disk that takes nothing for so long ends the run: what waits is saved elsewhere
  RawRecorderOptions recorder;
  // Called about twice a second by record_streams()'s own thread; none: nothing is shown.
  std::function<void(const std::vector<StreamStatus>&, double seconds)> show;
};

struct MultiReport {
  struct OneStream {
    std::string name;
    StreamKind kind = StreamKind::force;
    std::filesystem::path file;
    StreamStatus last;
    std::string failure;  // what its device or its disk said; empty: nothing
    bool silent = false;
    double arrival_rate_Hz = 0.0;  // of samples that came or were lost, between the first and the last
  };
  std::vector<OneStream> streams;
  double start_s = 0.0, seconds = 0.0;
  bool stopped = false;  // by the user

  // What is wrong with the run, one sentence each; none: it is whole.
  [[nodiscard]] std::vector<std::string> problems() const;
};

struct NamedStream {
  std::string name;  // of the file, and in messages
  std::unique_ptr<Stream> stream;
};

// Makes `folder` (it must not exist) with a file <name>.tsraw for each stream. Any stream that stops or fails ends the
// run for all; what came until then is on disk. Throws BadData where the folder cannot be made.
MultiReport record_streams(std::vector<NamedStream> streams, const std::filesystem::path& folder,
                           const MultiOptions& options, const std::function<bool()>& stop);

}  // namespace touchstone::hil
