#include "record/record_session.h"

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>

#include "harness/base/bar_line.h"
#include "lab/analysis.h"
#include "record/stream.h"

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
    auto in_order = history_;
    std::ranges::rotate_copy(history_, history_.begin() + static_cast<std::ptrdiff_t>(at_ % history_.size()),
                             in_order.begin());
    fmt::print(stderr, "\r|F| {} {:.2f} N full scale  {:.0f} s  {} written  {} lost ", bar_line(in_order, 0.0, largest),
               largest, t_s, written, counters.lost);
    std::fflush(stderr);
  }

 private:
  bool on_;
  double now_ = 0.0, next_s_ = 0.0;
  std::array<double, 50> history_{};
  std::size_t at_ = 0;
};

// Less than this share of the device's rate is no recording of its stream: another client had it meanwhile.
constexpr double least_share = 0.97;

}  // namespace

RecordReport record_session(WrenchSource& source, const std::filesystem::path& path, const RecordOptions& options,
                            const std::function<bool()>& stop) {
  RawHeader header = header_of(source, options.nominal_rate_Hz);
  header.scheduling = scheduling();
  header.started =
      fmt::format("{:%FT%TZ}", fmt::gmtime(std::chrono::system_clock::to_time_t(std::chrono::system_clock::now())));
  RawRecorder recorder(path, header, options.recorder);
  LivePlot plot(options.plot);
  MonotonicClock clock;
  RecordReport report;
  std::vector<WrenchSample> samples(1024);
  source.start();
  const double start = clock.now_s();
  double last_came = start, first_sample = 0.0, last_sample = 0.0;
  report.device_rate_Hz = source.nominal_rate_Hz();
  while (!(report.stopped = stop())) {
    const double now = clock.now_s();
    if (options.seconds > 0.0 && now >= start + options.seconds) break;
    const double until = options.seconds > 0.0 ? std::min(start + options.seconds, now + 0.2) : now + 0.2;
    const std::size_t n = source.read(samples, until);
    for (std::size_t i = 0; i < n; ++i) {
      recorder.push({samples[i], Vec3::Zero()});
      plot.add(samples[i]);
    }
    if (n > 0) {
      if (first_sample == 0.0) first_sample = samples[0].t_s;
      last_sample = samples[n - 1].t_s;
      last_came = clock.now_s();
    }
    if (n == 0 && clock.now_s() - last_came > options.silence_s) {
      report.silent = true;
      break;
    }
    plot.draw(now - start, source.counters(), recorder.written());
  }
  source.stop();
  report.stream = source.counters();
  report.seconds = clock.now_s() - start;
  if (last_sample > first_sample) {
    report.arrival_rate_Hz =
        static_cast<double>(report.stream.received + report.stream.lost - 1) / (last_sample - first_sample);
  }
  recorder.finish();
  report.written = recorder.written();
  report.lost_in_memory = recorder.lost();
  return report;
}

std::vector<std::string> RecordReport::problems() const {
  std::vector<std::string> said;
  if (silent && written == 0) {
    said.emplace_back(
        "the sensor sent nothing: is another program recording from it (most serve one client), is its stream switched "
        "off, does a firewall stop its packets?");
  } else if (silent) {
    said.push_back(fmt::format("the stream stopped before the end: what came in {:.1f} s is there and sound", seconds));
  } else if (written == 0) {
    said.emplace_back("no sample came in that time");
  }
  if (stream.lost > 0) said.push_back(fmt::format("{} samples were lost on the way", stream.lost));
  if (lost_in_memory > 0) said.push_back(fmt::format("{} samples were lost in memory", lost_in_memory));
  if (stream.device_errors > 0)
    said.push_back(fmt::format("{} samples have the device's error bit", stream.device_errors));
  // Over a tenth of a second and more: packets come in lumps.
  if (!silent && device_rate_Hz > 0.0 && arrival_rate_Hz > 0.0 && arrival_rate_Hz < least_share * device_rate_Hz &&
      seconds > 0.1) {
    said.push_back(fmt::format(
        "samples came at {:.1f} Hz, the device states {:.1f} Hz: another client may have had the stream for a while",
        arrival_rate_Hz, device_rate_Hz));
  }
  return said;
}

}  // namespace touchstone::hil
