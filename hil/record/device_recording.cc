#include "record/device_recording.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>

#include "devices/device_lock.h"
#include "devices/probe.h"
#include "drivers/device_table.h"
#include "harness/base/error.h"

namespace touchstone::hil {

const MappedDevice& usable_device(const std::string& id, const HardwareMap& map) {
  const auto* const mapped = map.find(id);
  if (mapped == nullptr) {
    throw UsageError(fmt::format("{}: is not in the hardware map{}", id,
                                 map.source.empty() ? "; give one with --map" : " " + map.source));
  }
  const auto state = mapped->calibration_file ? calibration_state(*mapped, today()) : CalibrationState::usable;
  if (state != CalibrationState::usable) throw BadData(probe_one(id, map).reason);
  return *mapped;
}

RecordReport record_device(const std::string& id, const HardwareMap& map, const std::filesystem::path& file,
                           const RecordOptions& options, const std::function<bool()>& stop) {
  const MappedDevice& mapped = usable_device(id, map);
  const DeviceLock lock(mapped);
  const auto source = open_force(mapped, options.nominal_rate_Hz);
  RecordOptions own = options;
  own.nominal_rate_Hz = mapped.rate_Hz;  // the other one is a card's
  return record_session(*source, file, own, stop);
}

MultiReport record_devices(const std::vector<std::string>& ids, const HardwareMap& map,
                           const std::filesystem::path& folder, const StreamSettings& settings,
                           const MultiOptions& options, const std::function<bool()>& stop) {
  std::vector<std::unique_ptr<DeviceLock>> locks;
  std::vector<NamedStream> streams;
  for (const auto& id : ids) {
    if (std::count(ids.begin(), ids.end(), id) > 1) throw UsageError(fmt::format("{}: is named more than once", id));
    const MappedDevice& mapped = usable_device(id, map);
    const KnownDevice* const known = find_known_device(mapped.id);
    const bool handle = known != nullptr && known->open_handle != nullptr;
    if (!handle) locks.push_back(std::make_unique<DeviceLock>(mapped));
    streams.push_back({id, open_stream(mapped, settings)});
    if (handle) locks.push_back(std::make_unique<DeviceLock>(streams.back().stream->header().device));
  }
  return record_streams(std::move(streams), folder, options, stop);
}

std::function<void(const std::vector<StreamStatus>&, double seconds)> show_on_terminal() {
  if (::isatty(STDERR_FILENO) == 0) return {};
  return [lines = std::size_t{0}](const std::vector<StreamStatus>& status, double seconds) mutable {
    if (lines > 0) fmt::print(stderr, "\x1b[{}A", lines);
    fmt::print(stderr, "{}", status_table(status, seconds));
    lines = status.size() + 1;
  };
}

std::string record_text(const RecordReport& report, const std::filesystem::path& file) {
  return fmt::format(
      "recorded {} samples in {:.1f} s -> {}\nlost on the way {}, repeated {}, late {}, malformed {}, device errors "
      "{}, lost in memory {}\n",
      report.written, report.seconds, file.string(), report.stream.lost, report.stream.repeated,
      report.stream.reordered, report.stream.malformed, report.stream.device_errors, report.lost_in_memory);
}

std::string record_text(const MultiReport& report) {
  std::string text;
  for (const auto& s : report.streams) {
    const StreamCounters& counters = s.last.counters;
    text += fmt::format(
        "{:<20} recorded {} samples in {:.1f} s; lost on the way {}, in memory {}, repeated {}, late {}, malformed "
        "{}{}\n",
        s.name, s.last.written, report.seconds, counters.lost, s.last.lost_in_memory, counters.repeated,
        counters.reordered, counters.malformed,
        counters.foreign_packets > 0 ? fmt::format(", from another address {}", counters.foreign_packets) : "");
  }
  return text;
}

namespace {

// Samples that are no rows of the table, where there are any.
std::string left_out_text(const ExportReport& report) {
  return report.left_out_samples > 0 ? fmt::format(", {} left out (not after the one before)", report.left_out_samples)
                                     : "";
}

}  // namespace

std::string session_text(const SessionExport& session) {
  std::string text;
  for (const auto& table : session.tables) {
    const ExportReport& r = table.report;
    text += fmt::format("{:<20} {} samples at {:.3f} Hz, {} missing, {} damaged bytes{}{} -> {}\n", table.name,
                        r.samples, r.rate_Hz, r.missing_samples, r.damaged_bytes, left_out_text(r),
                        r.emulated ? " (emulated)" : "", table.csv.string());
    if (r.header.clock == StreamClock::host) {
      text += fmt::format("{:<20} times are arrivals\n", "");
      continue;
    }
    text +=
        fmt::format("{:<20} {}{}, arrivals {:.3g} ms late on average, {:.3g} ms at worst; axis good to {:.2g} ms\n", "",
                    std::isfinite(r.clock_ppm) ? fmt::format("clock {:+.1f} ppm", r.clock_ppm) : "rate not stated",
                    r.rate_change_ppm != 0.0 ? fmt::format(", changing by {:+.2f} ppm", r.rate_change_ppm) : "",
                    1e3 * r.mean_delay_s, 1e3 * r.worst_delay_s, 1e3 * r.axis_uncertainty_s);
  }
  return text;
}

std::string recovery_text(const ExportReport& report, const std::filesystem::path& csv) {
  const std::string times =
      report.header.clock == StreamClock::host
          ? std::string("times are arrivals")
          : fmt::format(
                "arrivals were {:.3g} ms late on average, {:.3g} ms at worst; the time axis is good to {:.2g} ms",
                1e3 * report.mean_delay_s, 1e3 * report.worst_delay_s, 1e3 * report.axis_uncertainty_s);
  return fmt::format(
      "{} samples at {:.3f} Hz -> {}{}\n{}\n{} damaged bytes skipped, {} samples missing by the device's count{} (flag "
      "16: the first one after a gap)\n",
      report.samples, report.rate_Hz, csv.string(), report.emulated ? " (emulated)" : "", times, report.damaged_bytes,
      report.missing_samples, left_out_text(report));
}

std::filesystem::path table_of(const SessionExport& session, StreamKind kind, const std::string& name,
                               const std::string& option) {
  const SessionExport::Table* found = nullptr;
  for (const auto& table : session.tables) {
    if (table.report.kind != kind || (!name.empty() && table.name != name)) continue;
    if (found != nullptr)
      throw UsageError(fmt::format("{}: {} and {} were recorded; which one is it?", option, found->name, table.name));
    found = &table;
  }
  if (found == nullptr) throw UsageError(fmt::format("{}: no such stream was recorded", option));
  return found->csv;
}

}  // namespace touchstone::hil
