// Emulated devices through driver, recorder and disk in real time, for TOUCHSTONE_SOAK_SECONDS (60): five kilohertz
// alone, in bounded memory; five kilohertz and a tracker's 60 Hz together beside busy threads, every lost sample
// counted; and twenty disturbed runs (of a third of that time each), whose time axes are held against the emulators'
// own clocks.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

#include <atomic>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <thread>
#include <vector>

#include "drivers/natnet.h"
#include "emulators/natnet_emulator.h"
#include "emulators/netft_emulator.h"
#include "harness/base/random.h"
#include "record/drifting_clock.h"
#include "record/multi_session.h"
#include "record/record_session.h"

namespace touchstone::hil {
namespace {

TEST(Soak, FiveKilohertzIsRecordedWithoutLoss) {
  const char* const text = std::getenv("TOUCHSTONE_SOAK_SECONDS");
  const double seconds = text != nullptr ? std::atof(text) : 60.0;
  const auto file = std::filesystem::temp_directory_path() / fmt::format("touchstone-soak-{}.tsraw", ::getpid());
  NetFtEmulator emulator(5000, {}, [](double t) { return Wrench{Vec3(t, 1, 2), Vec3(3, 4, 5)}; });
  const auto source = open_netft(emulator.address(), 2.0, true);
  RecordOptions options;
  options.seconds = seconds;
  options.plot = false;
  const auto report = record_session(*source, file, options, [] { return false; });
  std::uint64_t n = 0, gaps = 0, last = 0;
  const auto recovered = read_raw(file, [&](const RawSample& s) {
    gaps += n > 0 && s.wrench.sequence != last + 1;
    last = s.wrench.sequence;
    ++n;
  });
  rusage usage{};
  ::getrusage(RUSAGE_SELF, &usage);
  fmt::print(
      "emulated soak: {:.0f} s, {} samples written, lost on the way {}, lost in memory {}, gaps {}, file {:.1f} MB, "
      "largest memory {:.1f} MB\n",
      report.seconds, report.written, report.stream.lost, report.lost_in_memory, gaps,
      1e-6 * static_cast<double>(std::filesystem::file_size(file)), static_cast<double>(usage.ru_maxrss) / 1024);
  std::filesystem::remove(file);
  EXPECT_EQ(report.stream.lost + report.lost_in_memory + gaps + recovered.missing_samples + recovered.damaged_bytes,
            0U);
  EXPECT_GE(static_cast<double>(report.written), 0.99 * 5000 * seconds);
  EXPECT_LT(usage.ru_maxrss, 200 * 1024);
}

// Threads that take what processor there is, in turns of 20 ms.
class Load {
 public:
  explicit Load(int threads) {
    for (int i = 0; i < threads; ++i)
      threads_.emplace_back([this] {
        MonotonicClock clock;
        while (!stop_) {
          for (const double until = clock.now_s() + 0.02; clock.now_s() < until;) {
          }
          clock.sleep_until(clock.now_s() + 0.002);
        }
      });
  }
  ~Load() {
    stop_ = true;
    for (auto& thread : threads_) thread.join();
  }
  Load(const Load&) = delete;
  Load& operator=(const Load&) = delete;

 private:
  std::atomic<bool> stop_{false};
  std::vector<std::thread> threads_;
};

double soak_seconds() {
  const char* const text = std::getenv("TOUCHSTONE_SOAK_SECONDS");
  return text != nullptr ? std::atof(text) : 60.0;
}

struct TwoDevices {
  double force_ppm = 0.0, tracker_ppm = 0.0, tracker_drift_ppm_per_s = 0.0;
  std::uint32_t drop_every = 0;
};

// What the two streams of a run came to.
struct Outcome {
  MultiReport report;
  // The time axis against the emulator's own clock: largest distance, and error of the rate; of force and tracker.
  double axis_s[2] = {0.0, 0.0}, rate_ppm[2] = {0.0, 0.0};
  std::uint64_t uncounted = 0;  // samples that neither came nor were counted as lost
};

Outcome record_two(const TwoDevices& plan, double seconds) {
  const auto folder = std::filesystem::temp_directory_path() / fmt::format("touchstone-two-{}", ::getpid());
  std::filesystem::remove_all(folder);
  NetFtFaults force_faults;
  force_faults.clock_ppm = plan.force_ppm;
  force_faults.drop_every = plan.drop_every;
  NatNetFaults tracker_faults;
  tracker_faults.clock_ppm = plan.tracker_ppm;
  tracker_faults.drift_ppm_per_s = plan.tracker_drift_ppm_per_s;
  tracker_faults.drop_every = plan.drop_every;
  NetFtEmulator sensor(5000, force_faults, [](double t) { return Wrench{Vec3(t, 1, 2), Vec3(3, 4, 5)}; });
  NatNetEmulator motive(60, tracker_faults, [](double t) {
    return EmulatedPose{Vec3(t, 0, 0), Quat::Identity(), true};
  });
  std::vector<NamedStream> streams;
  streams.push_back({"force", stream_of(open_netft(sensor.address(), 5.0, true))});
  streams.push_back({"tracker", stream_of(open_natnet({"127.0.0.1", motive.command_port(), "probe", 5.0, 60.0}))});
  MultiOptions options;
  options.seconds = seconds;
  options.silence_s = 10.0;
  Outcome outcome;
  outcome.report = record_streams(std::move(streams), folder, options, [] { return false; });
  for (int which = 0; which < 2; ++which) {
    DriftingClock clock;
    std::uint64_t first = 0, last = 0, n = 0;
    read_raw(folder / (which == 0 ? "force.tsraw" : "tracker.tsraw"), [&](const RawSample& s) {
      clock.add(which == 0 ? s.wrench.sequence : s.ticks, s.wrench.t_s);
      first = n++ == 0 ? s.wrench.sequence : first;
      last = s.wrench.sequence;
    });
    const auto axis = clock.axis();
    // When the emulator was due to send it, by this machine's clock.
    const auto truth = [&](std::uint64_t number) {
      if (which == 0)
        return sensor.started_s() + static_cast<double>(number - 1) / 5000.0 / (1.0 + 1e-6 * plan.force_ppm);
      const double own = static_cast<double>(number) / NatNetEmulator::ticks_per_s - NatNetEmulator::epoch_s +
                         NatNetEmulator::latency_s;
      const double a = 0.5e-6 * plan.tracker_drift_ppm_per_s, b = 1.0 + 1e-6 * plan.tracker_ppm;
      return motive.began_s() + (a == 0.0 ? own / b : (std::sqrt(b * b + 4.0 * a * own) - b) / (2.0 * a));
    };
    for (int k = 0; k <= 1000; ++k) {
      const std::uint64_t number = axis.first + (axis.last - axis.first) * static_cast<std::uint64_t>(k) / 1000;
      outcome.axis_s[which] = std::max(outcome.axis_s[which], std::abs(axis.at(number) - truth(number)));
    }
    outcome.rate_ppm[which] =
        1e6 * std::abs((truth(axis.last) - truth(axis.first)) / (axis.at(axis.last) - axis.at(axis.first)) - 1.0);
    const auto& stream = outcome.report.streams[static_cast<std::size_t>(which)];
    const std::uint64_t known = n + stream.last.counters.lost + stream.last.lost_in_memory;
    outcome.uncounted += last - first + 1 > known ? last - first + 1 - known : 0;
  }
  std::filesystem::remove_all(folder);
  return outcome;
}

TEST(Soak, ForceAndTrackerTogetherUnderLoad) {
  const Load load(2);
  const auto outcome = record_two({.force_ppm = 30.0, .tracker_ppm = -45.0}, soak_seconds());
  for (const auto& s : outcome.report.streams) {
    fmt::print(
        "emulated soak of both: {}: {:.0f} s, {} written, lost on the way {}, in memory {}, repeated {}, late {}\n",
        s.name, outcome.report.seconds, s.last.written, s.last.counters.lost, s.last.lost_in_memory,
        s.last.counters.repeated, s.last.counters.reordered);
  }
  fmt::print("axes within {:.3f} and {:.3f} ms, rates within {:.2f} and {:.2f} ppm; {} samples uncounted\n",
             1e3 * outcome.axis_s[0], 1e3 * outcome.axis_s[1], outcome.rate_ppm[0], outcome.rate_ppm[1],
             outcome.uncounted);
  EXPECT_EQ(outcome.uncounted, 0U);
  for (const auto& s : outcome.report.streams) {
    EXPECT_EQ(s.failure, "");
    EXPECT_EQ(s.last.written, s.last.counters.received) << s.name;
    EXPECT_EQ(s.last.lost_in_memory, 0U);
  }
}

TEST(Soak, TwentyDisturbedRunsKeepAxisAndRate) {
  const Load load(2);
  Random random(4401);
  double axis_s = 0.0, rate_ppm = 0.0;
  for (int run = 0; run < 20; ++run) {
    const TwoDevices plan{.force_ppm = random.uniform(-100, 100),
                          .tracker_ppm = random.uniform(-100, 100),
                          .tracker_drift_ppm_per_s = random.uniform(-0.05, 0.05),
                          .drop_every = static_cast<std::uint32_t>(20 + random.below(100))};
    const auto outcome = record_two(plan, soak_seconds() / 3.0);
    fmt::print("disturbed run {}: axes within {:.3f} and {:.3f} ms, rates within {:.2f} and {:.2f} ppm, {} uncounted\n",
               run, 1e3 * outcome.axis_s[0], 1e3 * outcome.axis_s[1], outcome.rate_ppm[0], outcome.rate_ppm[1],
               outcome.uncounted);
    EXPECT_EQ(outcome.uncounted, 0U);
    axis_s = std::max({axis_s, outcome.axis_s[0], outcome.axis_s[1]});
    rate_ppm = std::max({rate_ppm, outcome.rate_ppm[0], outcome.rate_ppm[1]});
  }
  fmt::print("20 disturbed runs: axes within {:.3f} ms, rates within {:.2f} ppm\n", 1e3 * axis_s, rate_ppm);
  EXPECT_LT(axis_s, 1e-3);
  EXPECT_LT(rate_ppm, 5.0);
}

}  // namespace
}  // namespace touchstone::hil
