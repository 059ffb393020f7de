#include "hil/record/record_session.h"

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>

#include "harness/base/atomic_file.h"
#include "hil/lab/analysis.h"

namespace touchstone::hil {
namespace {

// The last seconds of the force's length as one line of blocks, redrawn ten times a second.
class LivePlot {
 public:
  explicit LivePlot(bool on) : on_(on && ::isatty(STDERR_FILENO) != 0) {}
  ~LivePlot() {
    if (on_) std::fputc('\n', stderr);
  }
  LivePlot(const LivePlot&) = delete;
  LivePlot& operator=(const LivePlot&) = delete;

  void add(const WrenchSample& sample) {
    if (on_) now_ = std::max(now_, sample.wrench.f_N.norm());
  }
  void draw(double t_s, const StreamCounters& counters, std::uint64_t written) {
    if (!on_ || t_s < next_s_) return;
    next_s_ = t_s + 0.1;
    history_[at_++ % history_.size()] = now_;
    now_ = 0.0;
    double largest = 0.1;
    for (const double v : history_) largest = std::max(largest, v);
    static constexpr std::array blocks{" ", "▁", "▂", "▃", "▄", "▅", "▆", "▇", "█"};
    std::string line;
    for (std::size_t i = 0; i < history_.size(); ++i) {
      line += blocks[std::min<std::size_t>(
          8, static_cast<std::size_t>(8.99 * history_[(at_ + i) % history_.size()] / largest))];
    }
    fmt::print(stderr, "\r|F| {} {:.2f} N full scale  {:.0f} s  {} written  {} lost ", line, largest, t_s, written,
               counters.lost);
    std::fflush(stderr);
  }

 private:
  bool on_;
  double now_ = 0.0, next_s_ = 0.0;
  std::array<double, 50> history_{};
  std::size_t at_ = 0;
};

// Straight line through (sequence, arrival), about the first sample.
struct ClockLine {
  double n = 0, sx = 0, sy = 0, sxx = 0, sxy = 0, syy = 0;
  std::uint64_t first_sequence = 0;
  double first_s = 0.0;
  void add(std::uint64_t sequence, double t_s) {
    if (n == 0) first_sequence = sequence, first_s = t_s;
    const double x = static_cast<double>(sequence - first_sequence), y = t_s - first_s;
    n += 1, sx += x, sy += y, sxx += x * x, sxy += x * y, syy += y * y;
  }
  [[nodiscard]] double slope() const { return (n * sxy - sx * sy) / (n * sxx - sx * sx); }
  [[nodiscard]] double level() const { return (sy - slope() * sx) / n; }
  [[nodiscard]] double at(std::uint64_t sequence) const {
    return first_s + level() + slope() * static_cast<double>(sequence - first_sequence);
  }
  [[nodiscard]] double scatter() const { return std::sqrt(std::max(0.0, (syy - level() * sy - slope() * sxy) / n)); }
};

}  // namespace

RecordReport record_session(WrenchSource& source, const std::filesystem::path& path, const RecordOptions& options,
                            const std::function<bool()>& stop) {
  RawHeader header;
  header.device = source.identity();
  header.scheduling = scheduling();
  header.started =
      fmt::format("{:%FT%TZ}", fmt::gmtime(std::chrono::system_clock::to_time_t(std::chrono::system_clock::now())));
  header.nominal_rate_Hz = options.nominal_rate_Hz;
  RawRecorder recorder(path, header, options.recorder);
  LivePlot plot(options.plot);
  MonotonicClock clock;
  RecordReport report;
  std::vector<WrenchSample> samples(1024);
  source.start();
  const double start = clock.now_s();
  while (!(report.stopped = stop())) {
    const double now = clock.now_s();
    if (options.seconds > 0.0 && now >= start + options.seconds) break;
    const double until = options.seconds > 0.0 ? std::min(start + options.seconds, now + 0.2) : now + 0.2;
    const std::size_t n = source.read(samples, until);
    for (std::size_t i = 0; i < n; ++i) {
      recorder.push({samples[i], Vec3::Zero()});
      plot.add(samples[i]);
    }
    plot.draw(now - start, source.counters(), recorder.written());
  }
  source.stop();
  report.stream = source.counters();
  report.seconds = clock.now_s() - start;
  recorder.finish();
  report.written = recorder.written();
  report.lost_in_memory = recorder.lost();
  return report;
}

ExportReport export_raw(const std::vector<std::filesystem::path>& files, const std::filesystem::path& csv) {
  ExportReport report;
  ClockLine line;
  std::uint64_t last_sequence = 0;
  for (const auto& file : files) {
    const auto part = read_raw(file, [&](const RawSample& s) {
      line.add(s.wrench.sequence, s.wrench.t_s);
      last_sequence = std::max(last_sequence, s.wrench.sequence);
    });
    report.samples += part.samples;
    report.damaged_bytes += part.damaged_bytes;
    report.emulated = report.emulated || part.header.device.emulated;
  }
  if (report.samples < 2)
    throw BadData(fmt::format("{}: holds {} sound samples; nothing to export", files.front().string(), report.samples));
  if (!(line.slope() > 0.0))
    throw BadData(fmt::format("{}: time does not advance with the samples", files.front().string()));
  const std::uint64_t sent = last_sequence - line.first_sequence + 1;
  report.missing_samples = sent > report.samples ? sent - report.samples : 0;
  report.rate_Hz = 1.0 / line.slope();
  report.arrival_scatter_s = line.scatter();
  AtomicFile target(csv);
  std::FILE* const out = std::fopen(target.path().c_str(), "we");
  if (out == nullptr) throw BadData(fmt::format("{}: cannot be written", csv.string()));
  std::fputs("t_s,fx_N,fy_N,fz_N,tx_Nm,ty_Nm,tz_Nm,flags\n", out);
  const double origin = line.at(line.first_sequence);
  for (const auto& file : files) {
    read_raw(file, [&](const RawSample& s) {
      const auto &f = s.wrench.wrench.f_N, &t = s.wrench.wrench.torque_Nm;
      fmt::print(out, "{:.9f},{:.9g},{:.9g},{:.9g},{:.9g},{:.9g},{:.9g},{}\n", line.at(s.wrench.sequence) - origin,
                 f.x(), f.y(), f.z(), t.x(), t.y(), t.z(), s.wrench.flags);
    });
  }
  const bool good = std::ferror(out) == 0;
  if (std::fclose(out) != 0 || !good)
    throw BadData(fmt::format("{}: cannot be written: is the disk full?", csv.string()));
  target.commit();
  return report;
}

}  // namespace touchstone::hil
