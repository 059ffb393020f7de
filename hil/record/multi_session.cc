#include "record/multi_session.h"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <atomic>
#include <chrono>
#include <cmath>
#include <limits>
#include <mutex>
#include <thread>

#include "harness/base/error.h"
#include "harness/base/partial_files.h"
#include "lab/analysis.h"
#include "record/envelope_clock.h"

namespace touchstone::hil {
namespace {

constexpr double rate_window_s = 2.0;
// Less than this share of the device's rate is no recording of its stream: another client had it meanwhile.
constexpr double least_rate_share = 0.97;
// Before the line below all arrivals means anything.
constexpr double skew_after_s = 5.0;

std::string now_as_text() {
  return fmt::format("{:%FT%TZ}", fmt::gmtime(std::chrono::system_clock::to_time_t(std::chrono::system_clock::now())));
}

// One device: its thread, its file, and what the screen wants to know of it.
class Lane {
 public:
  Lane(NamedStream named, const std::filesystem::path& folder, const MultiOptions& options)
      : name_(std::move(named.name)),
        stream_(std::move(named.stream)),
        header_(stream_->header()),
        file_(folder / (name_ + ".tsraw")) {
    header_.scheduling = scheduling();
    header_.started = now_as_text();
    recorder_ = std::make_unique<RawRecorder>(file_, header_, options.recorder);
  }

  void run(const std::atomic<bool>& stop, double until_s) {
    last_came_s_ = before_s_ = window_began_s_ = clock_.now_s();
    thread_ = std::thread([this, &stop, until_s] { work(stop, until_s); });
  }

  void join() {
    if (thread_.joinable()) thread_.join();
  }

  [[nodiscard]] bool failed() const {
    const std::lock_guard lock(mutex_);
    return !failure_.empty();
  }

  // Also forgets what came before the window.
  StreamStatus status() {
    StreamStatus s;
    const double now = clock_.now_s();
    const std::lock_guard lock(mutex_);
    s.name = name_;
    s.counters = counters_;
    s.written = recorder_->written();
    s.lost_in_memory = recorder_->lost();
    s.disk_stalled = recorder_->stalled();
    s.nominal_Hz = header_.nominal_rate_Hz;
    s.silent_s = now - last_came_s_;
    const std::uint64_t came = counters_.received;
    if (now - window_began_s_ > rate_window_s) {
      before_s_ = window_began_s_, before_ = window_;
      window_began_s_ = now, window_ = came;
    }
    if (now > before_s_) s.rate_Hz = static_cast<double>(came - before_) / (now - before_s_);
    s.clock_ppm = std::numeric_limits<double>::quiet_NaN();
    const double per_s = header_.clock == StreamClock::ticks ? header_.ticks_per_s : header_.nominal_rate_Hz;
    if (header_.clock != StreamClock::host && per_s > 0.0 && last_arrival_s_ - first_arrival_s_ > skew_after_s) {
      const auto line = envelope_.line();
      s.clock_ppm = 1e6 * (1.0 / (line.seconds_per_sample * per_s) - 1.0);
      s.delay_s = last_arrival_s_ - line.at(last_number_);
    }
    return s;
  }

  // After join(): writes what is left.
  MultiReport::OneStream end() {
    MultiReport::OneStream one;
    one.name = name_;
    one.kind = stream_->kind();
    one.file = file_;
    one.last = status();
    one.failure = failure_;
    try {
      recorder_->finish();
    } catch (const BadData& error) {
      one.failure += (one.failure.empty() ? "" : "; ") + std::string(error.what());
    }
    one.last.written = recorder_->written();
    one.last.lost_in_memory = recorder_->lost();
    one.last.disk_stalled = false;
    if (last_arrival_s_ > first_arrival_s_) {
      one.arrival_rate_Hz = static_cast<double>(one.last.counters.received + one.last.counters.lost - 1) /
                            (last_arrival_s_ - first_arrival_s_);
    }
    return one;
  }

 private:
  void work(const std::atomic<bool>& stop, double until_s) {
    try {
      std::vector<RawSample> samples(1024);
      stream_->start();
      while (!stop) {
        const double now = clock_.now_s();
        if (now >= until_s) break;
        const std::size_t n = stream_->read(samples, std::min(until_s, now + 0.1));
        for (std::size_t i = 0; i < n; ++i) recorder_->push(samples[i]);
        const std::lock_guard lock(mutex_);
        counters_ = stream_->counters();
        for (std::size_t i = 0; i < n; ++i) note(samples[i]);
        if (n > 0) last_came_s_ = clock_.now_s();
      }
      stream_->stop();
    } catch (const std::exception& error) {
      const std::lock_guard lock(mutex_);
      failure_ = error.what();
      if (failure_.empty()) failure_ = "it failed and did not say why";
    }
  }

  void note(const RawSample& sample) {
    const std::uint64_t number = header_.clock == StreamClock::ticks ? sample.ticks : sample.wrench.sequence;
    if (envelope_.samples() == 0) first_arrival_s_ = sample.wrench.t_s;
    if (envelope_.samples() > 0 && number <= last_number_) return;
    envelope_.add(number, sample.wrench.t_s);
    last_number_ = number;
    last_arrival_s_ = sample.wrench.t_s;
  }

  std::string name_;
  std::unique_ptr<Stream> stream_;
  RawHeader header_;
  std::filesystem::path file_;
  std::unique_ptr<RawRecorder> recorder_;
  MonotonicClock clock_;
  std::thread thread_;
  mutable std::mutex mutex_;  // of all below
  std::string failure_;
  StreamCounters counters_;
  EnvelopeClock envelope_;
  std::uint64_t last_number_ = 0, window_ = 0, before_ = 0;
  double first_arrival_s_ = 0.0, last_arrival_s_ = 0.0, last_came_s_ = 0.0;
  double window_began_s_ = 0.0, before_s_ = 0.0;
};

// The lanes' threads end with it, whatever happens meanwhile.
class RunningLanes {
 public:
  RunningLanes(std::vector<std::unique_ptr<Lane>>& lanes, double until_s) : lanes_(&lanes) {
    try {
      for (auto& lane : lanes) lane->run(end_, until_s);
    } catch (...) {
      end();
      throw;
    }
  }
  ~RunningLanes() { end(); }
  RunningLanes(const RunningLanes&) = delete;
  RunningLanes& operator=(const RunningLanes&) = delete;
  void end() noexcept {
    end_ = true;
    for (auto& lane : *lanes_) lane->join();
  }

 private:
  std::vector<std::unique_ptr<Lane>>* lanes_;
  std::atomic<bool> end_{false};
};

std::vector<StreamStatus> status_of(std::vector<std::unique_ptr<Lane>>& lanes) {
  std::vector<StreamStatus> all;
  for (auto& lane : lanes) all.push_back(lane->status());
  return all;
}

std::string problem_of(const MultiReport::OneStream& s, double seconds) {
  if (!s.failure.empty()) return s.failure;
  const StreamCounters& c = s.last.counters;
  if (c.received == 0 && c.foreign_packets > 0) {
    return fmt::format(
        "it sent nothing from its \"address\" in the hardware map, but {} packets came from another one: if its "
        "computer has two network cards, give the address of the one that it sends by",
        c.foreign_packets);
  }
  if (c.received == 0) {
    return "it sent nothing: is another program recording from it (most serve one client), is its stream switched off, "
           "does a firewall stop its packets?";
  }
  if (s.silent)
    return fmt::format("its stream stopped {:.1f} s before the end; what came until then is sound", s.last.silent_s);
  std::string said;
  const auto add = [&](const std::string& text) { said += (said.empty() ? "" : "; ") + text; };
  if (c.lost > 0) add(fmt::format("{} samples were lost on the way", c.lost));
  if (s.last.lost_in_memory > 0) add(fmt::format("{} samples were lost in memory", s.last.lost_in_memory));
  if (c.clock_steps > 0) {
    add(
        fmt::format("the clock of its computer was set {} time{} meanwhile: times from there on are good to some "
                    "milliseconds only; let it be slewed (chrony, ntpd), not stepped, and record again",
                    c.clock_steps, c.clock_steps == 1 ? "" : "s"));
  }
  if (c.device_errors > 0) add(fmt::format("{} samples have the device's error bit", c.device_errors));
  // Over a tenth of a second and more: packets come in lumps.
  if (s.last.nominal_Hz > 0.0 && s.arrival_rate_Hz > 0.0 && s.arrival_rate_Hz < least_rate_share * s.last.nominal_Hz &&
      seconds > std::max(0.1, 10.0 / s.last.nominal_Hz)) {
    add(fmt::format("samples came at {:.1f} Hz, {:.1f} Hz are stated", s.arrival_rate_Hz, s.last.nominal_Hz));
  }
  return said;
}

}  // namespace

std::string status_table(const std::vector<StreamStatus>& streams, double seconds) {
  std::string text = fmt::format("{:>6.0f} s {:<20} {:>10} {:>10} {:>9} {:>8} {:>10} {:>8}\n", seconds, "stream",
                                 "rate Hz", "clock ppm", "delay ms", "lost", "written", "silent s");
  for (const auto& s : streams) {
    text += fmt::format("         {:<20} {:>10.2f} {:>10} {:>9.2f} {:>8} {:>10} {:>8.1f}{}\n", s.name, s.rate_Hz,
                        std::isfinite(s.clock_ppm) ? fmt::format("{:+.1f}", s.clock_ppm) : "-", 1e3 * s.delay_s,
                        s.counters.lost + s.lost_in_memory, s.written, s.silent_s,
                        s.disk_stalled ? "  THE DISK TAKES NOTHING" : "");
  }
  return text;
}

MultiReport record_streams(std::vector<NamedStream> streams, const std::filesystem::path& folder,
                           const MultiOptions& options, const std::function<bool()>& stop) {
  std::error_code error;
  if (std::filesystem::exists(folder, error))
    throw BadData(
        fmt::format("{}: is there already; a recording is never overwritten: choose another name", folder.string()));
  error = make_folders(folder);
  if (error) throw BadData(fmt::format("{}: cannot be made: {}", folder.string(), error.message()));
  std::vector<std::unique_ptr<Lane>> lanes;
  for (auto& named : streams) lanes.push_back(std::make_unique<Lane>(std::move(named), folder, options));

  MonotonicClock clock;
  MultiReport report;
  report.start_s = clock.now_s();
  const double until =
      options.seconds > 0.0 ? report.start_s + options.seconds : std::numeric_limits<double>::infinity();
  RunningLanes running(lanes, until);
  std::vector<bool> silent(lanes.size(), false);
  double shown = report.start_s, stalled_since = std::numeric_limits<double>::infinity();
  for (bool over = false; !over;) {
    clock.sleep_until(clock.now_s() + 0.02);
    const double now = clock.now_s();
    report.stopped = stop();
    over = report.stopped || now >= until;
    const auto status = status_of(lanes);
    bool stalled = false;
    for (std::size_t i = 0; i < lanes.size(); ++i) {
      silent[i] = status[i].silent_s > options.silence_s;
      over = over || silent[i] || lanes[i]->failed();
      stalled = stalled || status[i].disk_stalled;
    }
    stalled_since = stalled ? std::min(stalled_since, now) : std::numeric_limits<double>::infinity();
    over = over || now - stalled_since > options.disk_patience_s;
    if (options.show && (now - shown >= 0.5 || over)) {
      options.show(status, now - report.start_s);
      shown = now;
    }
  }
  running.end();
  report.seconds = clock.now_s() - report.start_s;
  for (std::size_t i = 0; i < lanes.size(); ++i) {
    report.streams.push_back(lanes[i]->end());
    report.streams.back().silent = silent[i];
  }
  return report;
}

std::vector<std::string> MultiReport::problems() const {
  std::vector<std::string> said;
  for (const auto& s : streams) {
    if (const auto problem = problem_of(s, seconds); !problem.empty()) said.push_back(s.name + ": " + problem);
  }
  return said;
}

}  // namespace touchstone::hil
