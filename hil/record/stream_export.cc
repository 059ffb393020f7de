#include "record/stream_export.h"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <memory>
#include <nlohmann/json.hpp>
#include <system_error>

#include "harness/base/atomic_file.h"
#include "harness/base/error.h"

namespace touchstone::hil {
namespace {

using Files = std::vector<std::filesystem::path>;

std::uint64_t number_of(const RawSample& sample, const RawHeader& header) {
  return header.clock == StreamClock::ticks ? sample.ticks : sample.wrench.sequence;
}

// What the first pass over the files finds.
struct Read {
  DriftingClock::Axis axis;
  ExportReport report;

  [[nodiscard]] double time_of(const RawSample& sample) const {
    return report.header.clock == StreamClock::host ? sample.wrench.t_s : axis.at(number_of(sample, report.header));
  }
};

// With what a full disk left over, if it was moved there (RawRecorder).
Files with_rest(const std::filesystem::path& raw) {
  const std::filesystem::path rest = raw.string() + ".rest";
  return std::filesystem::exists(rest) ? Files{raw, rest} : Files{raw};
}

Read read_stream(const Files& files) {
  Read read;
  ExportReport& report = read.report;
  DriftingClock clock;
  std::uint64_t first_sequence = 0, last_sequence = 0, last_number = 0;
  for (const auto& file : files) {
    const RawHeader header = read_raw_header(file);
    if (report.samples == 0) report.header = header;
    const auto part = read_raw(file, [&](const RawSample& s) {
      if (report.samples == 0) {
        first_sequence = s.wrench.sequence;
        report.first_s = s.wrench.t_s;
      }
      if (report.samples > 0 && s.wrench.sequence <= last_sequence) {
        throw BadData(fmt::format("{}: sample {} comes after sample {}: are the files in the order of their recording?",
                                  file.string(), s.wrench.sequence, last_sequence));
      }
      last_sequence = s.wrench.sequence;
      report.last_s = s.wrench.t_s;
      ++report.samples;
      // A tracker may send one frame twice; its clock stands still then.
      const std::uint64_t number = number_of(s, header);
      if (header.clock != StreamClock::host && (clock.samples() == 0 || number > last_number)) {
        clock.add(number, s.wrench.t_s);
        last_number = number;
      }
    });
    report.damaged_bytes += part.damaged_bytes;
    report.emulated = report.emulated || header.device.emulated;
  }
  if (report.samples < 2)
    throw BadData(fmt::format("{}: holds {} sound samples, and 2 are needed for a time axis; nothing to export",
                              files.front().string(), report.samples));
  report.kind = report.header.pose ? StreamKind::motion : StreamKind::force;
  const std::uint64_t sent = last_sequence - first_sequence + 1;
  report.missing_samples = sent > report.samples ? sent - report.samples : 0;
  if (report.header.clock == StreamClock::host) {
    const double seconds = report.last_s - report.first_s;
    if (seconds > 0.0) report.rate_Hz = static_cast<double>(sent - 1) / seconds;
    return read;
  }
  if (clock.samples() < 2)
    throw BadData(fmt::format(
        "{}: the device's clock stands still over all samples; check the device's settings and record again",
        files.front().string()));
  read.axis = clock.axis();
  const double numbers_per_s = read.axis.rate_Hz();
  if (!(numbers_per_s > 0.0))
    throw BadData(
        fmt::format("{}: time does not advance with the samples; check the device's settings and record again",
                    files.front().string()));
  report.first_s = read.axis.at(read.axis.first);
  report.last_s = read.axis.at(read.axis.last);
  report.rate_Hz = static_cast<double>(sent - 1) / (report.last_s - report.first_s);
  const double stated =
      report.header.clock == StreamClock::ticks ? report.header.ticks_per_s : report.header.nominal_rate_Hz;
  if (stated > 0.0) report.clock_ppm = 1e6 * (numbers_per_s / stated - 1.0);
  report.rate_change_ppm = 1e6 * read.axis.rate_change();
  report.axis_uncertainty_s = read.axis.floor_s;
  return read;
}

void write_row(std::FILE* out, double t_s, const RawSample& s, StreamKind kind) {
  if (kind == StreamKind::force) {
    const auto &f = s.wrench.wrench.f_N, &t = s.wrench.wrench.torque_Nm;
    fmt::print(out, "{:.9f},{:.9g},{:.9g},{:.9g},{:.9g},{:.9g},{:.9g},{}\n", t_s, f.x(), f.y(), f.z(), t.x(), t.y(),
               t.z(), s.wrench.flags);
    return;
  }
  fmt::print(out, "{:.9f},{:.9g},{:.9g},{:.9g},{:.9g},{:.9g},{:.9g},{:.9g},{},{}\n", t_s, s.p_W_m.x(), s.p_W_m.y(),
             s.p_W_m.z(), s.q_WB.w(), s.q_WB.x(), s.q_WB.y(), s.q_WB.z(),
             (s.wrench.flags & recording::sample_not_tracked) != 0 ? 0 : 1, s.wrench.device_status);
}

void write_table(const Files& files, const std::filesystem::path& csv, double origin_s, Read& read) {
  AtomicFile target(csv);
  std::unique_ptr<std::FILE, int (*)(std::FILE*)> owner(std::fopen(target.path().c_str(), "we"), std::fclose);
  std::FILE* const out = owner.get();
  if (out == nullptr) throw BadData(fmt::format("{}: cannot be written: {}", csv.string(), std::strerror(errno)));
  const StreamKind kind = read.report.kind;
  std::fputs(kind == StreamKind::force ? "t_s,fx_N,fy_N,fz_N,tx_Nm,ty_Nm,tz_Nm,flags\n"
                                       : "t_s,x_m,y_m,z_m,qw,qx,qy,qz,tracked,device_status\n",
             out);
  double sum = 0.0, worst = 0.0, last = -1e300;
  std::uint64_t rows = 0;
  const auto cannot_write = [&](const char* why) {
    return BadData(
        fmt::format("{}: cannot be written: {}; the raw recording is whole: make room, and `touchstone hil "
                    "recover` writes the tables",
                    csv.string(), why));
  };
  for (const auto& file : files) try {
      read_raw(file, [&](const RawSample& s) {
        const double t = read.time_of(s);
        if (!(t > last)) {  // a frame sent twice, or a clock that stands still
          ++read.report.left_out_samples;
          return;
        }
        last = t;
        ++rows;
        sum += s.wrench.t_s - t;
        worst = std::max(worst, s.wrench.t_s - t);
        write_row(out, t - origin_s, s, kind);
      });
    } catch (const std::system_error& error) {  // as fmt::print() says that the disk is full
      throw cannot_write(error.code().message().c_str());
    }
  read.report.mean_delay_s = sum / static_cast<double>(std::max<std::uint64_t>(1, rows));
  read.report.worst_delay_s = worst;
  const bool good = std::ferror(out) == 0;
  if (std::fclose(owner.release()) != 0 || !good) throw cannot_write("is the disk full?");
  target.commit();
}

nlohmann::json as_json(const SessionExport::Table& table) {
  const ExportReport& r = table.report;
  return {{"name", table.name},
          {"kind", r.kind == StreamKind::force ? "force" : "motion"},
          {"table", table.csv.filename().string()},
          {"device", r.header.device.id},
          {"serial", r.header.device.serial},
          {"firmware", r.header.device.firmware},
          {"calibration", r.header.device.calibration},
          {"emulated", r.emulated},
          {"started", r.header.started},
          {"scheduling", r.header.scheduling},
          {"clock", to_string(r.header.clock)},
          {"samples", r.samples},
          {"missing_samples", r.missing_samples},
          {"left_out_samples", r.left_out_samples},
          {"damaged_bytes", r.damaged_bytes},
          {"rate_Hz", r.rate_Hz},
          {"clock_ppm", r.clock_ppm},
          {"rate_change_ppm", r.rate_change_ppm},
          {"mean_delay_s", r.mean_delay_s},
          {"worst_delay_s", r.worst_delay_s},
          {"axis_uncertainty_s", r.axis_uncertainty_s}};
}

}  // namespace

std::string ExportReport::axis_problem() const {
  constexpr std::uint64_t stretches = 16, enough = 30;  // of the axis (DriftingClock), and arrivals in each
  const double least_s = samples < stretches * enough ? 50e-3 : 5e-3;
  const double limit_s = std::max(least_s, rate_Hz > 0.0 ? 0.5 / rate_Hz : least_s);
  if (header.clock == StreamClock::host || !(axis_uncertainty_s > limit_s)) return {};
  return fmt::format(
      "the time axis is uncertain by {:.2g} ms (limit {:.2g} ms): no even clock fits the arrivals; was a clock set "
      "meanwhile, on this computer or the device's, or did the network stall for seconds? Record again",
      1e3 * axis_uncertainty_s, 1e3 * limit_s);
}

ExportReport export_raw(const std::vector<std::filesystem::path>& given, const std::filesystem::path& csv) {
  const Files files = given.size() == 1 ? with_rest(given.front()) : given;
  Read read = read_stream(files);
  write_table(files, csv, read.report.first_s, read);
  return read.report;
}

SessionExport export_session(const std::filesystem::path& folder) {
  SessionExport session;
  std::vector<std::filesystem::path> raw;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(folder, error)) {
    if (entry.path().extension() == ".tsraw") raw.push_back(entry.path());
  }
  if (error)
    throw BadData(fmt::format("{}: cannot be read: {}; give the folder of a run of touchstone hil record",
                              folder.string(), error.message()));
  if (raw.empty())
    throw BadData(
        fmt::format("{}: holds no raw recording (.tsraw); is it a folder of touchstone hil record?", folder.string()));
  std::sort(raw.begin(), raw.end());
  std::vector<Files> files;
  std::vector<Read> reads;
  double origin = 1e300;
  for (const auto& path : raw) {
    files.push_back(with_rest(path));
    reads.push_back(read_stream(files.back()));
    origin = std::min(origin, reads.back().report.first_s);
  }
  nlohmann::json json{{"schema", "touchstone-session/1"}};
  for (std::size_t i = 0; i < raw.size(); ++i) {
    SessionExport::Table table{raw[i].stem().string(), raw[i], {}};
    table.csv.replace_extension(".csv");
    write_table(files[i], table.csv, origin, reads[i]);
    table.report = reads[i].report;
    json["streams"].push_back(as_json(table));
    session.tables.push_back(std::move(table));
  }
  write_file(folder / "session.json", json.dump(1) + "\n");
  return session;
}

}  // namespace touchstone::hil
