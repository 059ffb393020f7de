// Several emulated devices in one run: what they send is what the files hold, whatever happens to one of them, to the
// program or to the disk.
#include "record/multi_session.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <csignal>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <sstream>
#include <thread>

#include "drivers/natnet.h"
#include "drivers/ndi.h"
#include "emulators/haptic_emulator.h"
#include "emulators/natnet_emulator.h"
#include "emulators/ndi_emulator.h"
#include "emulators/netft_emulator.h"
#include "emulators/scheduling_lateness.h"
#include "harness/base/atomic_file.h"
#include "harness/base/error.h"
#include "harness/base/thread_sanitizer.h"
#include "record/device_recording.h"
#include "record/stream_export.h"

namespace touchstone::hil {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

Wrench ramp(double t) { return {Vec3(t, 1, 2), Vec3::Zero()}; }
EmulatedPose walk(double t) { return {Vec3(0.01 * t, std::sin(t), 0), Quat::Identity(), true}; }

class MultiSession : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() / fmt::format("touchstone-multi-{}-{}", ::getpid(),
                                                      ::testing::UnitTest::GetInstance()->current_test_info()->name());
    fs::remove_all(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  static NamedStream force_of(const NetFtEmulator& emulator) {
    return {"force", stream_of(open_netft(emulator.address(), 3.0, true))};
  }
  static NamedStream tracker_of(const NatNetEmulator& emulator, double rate_Hz) {
    return {"tracker", stream_of(open_natnet({"127.0.0.1", emulator.command_port(), "probe", 3.0, rate_Hz}))};
  }
  static std::uint64_t samples_in(const fs::path& file) {
    std::uint64_t n = 0;
    try {
      read_raw(file, [&](const RawSample&) { ++n; });
    } catch (const BadData&) {
      return 0;  // not there yet, or without its head
    }
    return n;
  }

  static constexpr double busy_s = 30.0;  // silence that no busy machine makes
  fs::path folder_;
};

TEST_F(MultiSession, ForceTrackerAndHandleTogether) {
  NetFtEmulator sensor(5000, {}, ramp);
  NatNetEmulator motive(60, {}, walk);
  std::vector<NamedStream> streams;
  streams.push_back(force_of(sensor));
  streams.push_back(tracker_of(motive, 60));
  const fs::path plant_file = folder_.string() + "-plant";
  const EmulatedHapticPlant plant(plant_file, 0.0);
  streams.push_back({"handle", stream_of(open_emulated_haptic(plant_file), 500.0)});
  MultiOptions options;
  options.silence_s = busy_s;
  std::string screen;
  bool enough = false;
  options.show = [&](const std::vector<StreamStatus>& status, double seconds) {
    screen = status_table(status, seconds);
    enough = status[0].written > 8000 && status[1].written > 100 && status[2].written > 200;
  };
  const auto report = record_streams(std::move(streams), folder_, options, [&] { return enough; });
  EXPECT_THAT(screen, AllOf(HasSubstr("force"), HasSubstr("tracker"), HasSubstr("handle"), HasSubstr("silent s")));
  ASSERT_EQ(report.streams.size(), 3U);
  for (const auto& s : report.streams) {
    EXPECT_EQ(s.failure, "");
    EXPECT_EQ(s.last.written, s.last.counters.received) << s.name;
    EXPECT_EQ(s.last.lost_in_memory, 0U);
  }

  const auto session = export_session(folder_);
  ASSERT_EQ(session.tables.size(), 3U);  // in the order of their names
  const auto &force = session.tables[0], &handle = session.tables[1], &tracker = session.tables[2];
  EXPECT_EQ(force.name, "force");
  EXPECT_EQ(handle.report.header.clock, StreamClock::host);
  EXPECT_EQ(tracker.report.header.clock, StreamClock::ticks);
  EXPECT_NEAR(force.report.rate_Hz, 5000, 5);
  EXPECT_NEAR(tracker.report.rate_Hz, 60, 0.2);
  EXPECT_NEAR(tracker.report.clock_ppm, 0.0, 1000.0);
  EXPECT_TRUE(force.report.emulated && tracker.report.emulated);
  const auto json = nlohmann::json::parse(read_file(folder_ / "session.json"));
  EXPECT_EQ(json["schema"], "touchstone-session/1");
  EXPECT_EQ(json["streams"].size(), 3U);
  EXPECT_EQ(read_file(tracker.csv).substr(0, 50), "t_s,x_m,y_m,z_m,qw,qx,qy,qz,tracked,device_status\n");
}

// A Polaris that tracks at half its counter's rate, of which the hardware map says nothing: no rate is held against it,
// and no clock's error is made up.
TEST_F(MultiSession, ATrackerWhoseRateNobodyStatesIsTakenAsItComes) {
  const NdiEmulator polaris(30.0, {}, walk);
  MappedDevice mapped;
  mapped.id = "ndi-polaris";
  mapped.address = "127.0.0.1";
  mapped.port = polaris.port();
  std::vector<NamedStream> streams;
  streams.push_back({"tracker", open_stream(mapped, {})});
  MultiOptions options;
  options.seconds = 1.5;
  const auto report = record_streams(std::move(streams), folder_, options, [] { return false; });
  EXPECT_THAT(report.problems(), IsEmpty());
  const auto session = export_session(folder_);
  EXPECT_NEAR(session.tables.at(0).report.rate_Hz, 30.0, 1.0);
  EXPECT_TRUE(nlohmann::json::parse(read_file(folder_ / "session.json"))["streams"][0]["clock_ppm"].is_null());
  EXPECT_THAT(session_text(session), HasSubstr("rate not stated"));
}

// What a screen throws ends the run, not the program: the threads are joined, and what came is on disk.
TEST_F(MultiSession, AScreenThatFailsEndsTheRunInOrder) {
  NetFtEmulator sensor(1000, {}, ramp);
  std::vector<NamedStream> streams;
  streams.push_back(force_of(sensor));
  MultiOptions options;
  options.seconds = 5.0;
  options.show = [](const std::vector<StreamStatus>&, double) { throw std::runtime_error("no screen"); };
  EXPECT_THROW(record_streams(std::move(streams), folder_, options, [] { return false; }), std::runtime_error);
  EXPECT_GT(export_session(folder_).tables.at(0).report.samples, 100U);
}

// What the tracker's frames say of its time, and this machine's clock, agree to the least delay of a frame.
TEST_F(MultiSession, TheAxisIsTheDevicesOwnTime) {
  NatNetFaults faults;
  faults.clock_ppm = 400.0;
  NatNetEmulator motive(200, faults, walk);
  std::vector<NamedStream> streams;
  streams.push_back(tracker_of(motive, 200));
  MultiOptions options;
  options.seconds = 6.0;
  record_streams(std::move(streams), folder_, options, [] { return false; });
  const auto session = export_session(folder_);
  const auto& report = session.tables[0].report;
  EXPECT_NEAR(report.clock_ppm, 400.0, 100.0);  // in six seconds on a machine that does other things
  // x is 10 mm for each second of Motive's own time.
  std::istringstream table(read_file(session.tables[0].csv));
  std::string line;
  std::getline(table, line);
  double t0 = 0.0, x0 = 0.0, t = 0.0, x = 0.0;
  for (int row = 0; std::getline(table, line); ++row) {
    ASSERT_EQ(std::sscanf(line.c_str(), "%lf,%lf", &t, &x), 2);
    if (row == 0) t0 = t, x0 = x;
  }
  EXPECT_NEAR((x - x0) / 0.01 / (t - t0), 1.0 + 400e-6, 100e-6);
}

TEST_F(MultiSession, AStreamThatStopsEndsTheRunOfAll) {
  NetFtEmulator sensor(1000, {}, ramp);
  NatNetEmulator motive(120, {}, walk);
  std::vector<NamedStream> streams;
  streams.push_back(force_of(sensor));
  streams.push_back(tracker_of(motive, 120));
  MultiOptions options;
  options.show = [&](const std::vector<StreamStatus>& status, double) {
    if (status[1].written > 0) motive.fall_silent();
  };
  const auto report = record_streams(std::move(streams), folder_, options, [] { return false; });
  EXPECT_FALSE(report.stopped);
  EXPECT_FALSE(report.streams[0].silent);
  EXPECT_TRUE(report.streams[1].silent);
  EXPECT_GT(report.streams[1].last.written, 0U);
  EXPECT_THAT(report.problems(), ElementsAre(HasSubstr("tracker: its stream stopped")));
}

TEST_F(MultiSession, ADeviceThatIsUnpluggedCostsNothingThatCame) {
  NetFtEmulator sensor(1000, {}, ramp);
  NatNetEmulator motive(120, {}, walk);
  std::vector<NamedStream> streams;
  streams.push_back(force_of(sensor));
  streams.push_back(tracker_of(motive, 120));
  MultiOptions options;
  options.silence_s = busy_s;
  const SchedulingLateness machine;
  double unplugged_s = 0.0;
  options.show = [&](const std::vector<StreamStatus>& status, double) {
    if (status[0].written == 0 || status[1].written == 0 || unplugged_s > 0.0) return;
    unplugged_s = MonotonicClock().now_s();
    sensor.unplug();
  };
  const auto report = record_streams(std::move(streams), folder_, options, [] { return false; });
  EXPECT_FALSE(report.stopped);
  EXPECT_THAT(report.problems(), ElementsAre(HasSubstr("force:")));
  double last_s = 0.0;
  std::uint64_t n = 0;
  read_raw(folder_ / "force.tsraw", [&](const RawSample& s) { last_s = s.wrench.t_s, ++n; });
  EXPECT_EQ(n, report.streams[0].last.counters.received);
  fmt::print("unplugged: the last sample in the file is {:.1f} ms older than the cable's pull\n",
             1e3 * (unplugged_s - last_s));
  EXPECT_LT(unplugged_s - last_s, 0.1 + 2 * machine.worst_s());
}

// The whole program dies; what is missing is what came in the last tenth of a second.
TEST_F(MultiSession, AKilledProgramLosesATenthOfASecond) {
#ifdef TOUCHSTONE_THREAD_SANITIZER
  GTEST_SKIP() << "the thread sanitizer ends a process that starts threads after a fork beside threads";
#endif
  const SchedulingLateness machine;
  double worst_s = 0.0;
  for (int run = 0; run < 3; ++run) {
    const fs::path folder = folder_.string() + fmt::format("-{}", run);
    fs::remove_all(folder);
    int port[2];
    ASSERT_EQ(::pipe(port), 0);
    const pid_t child = ::fork();
    if (child == 0) {
      NetFtEmulator sensor(5000, {}, ramp);
      NatNetEmulator motive(60, {}, walk);
      std::vector<NamedStream> streams;
      streams.push_back(force_of(sensor));
      streams.push_back(tracker_of(motive, 60));
      [[maybe_unused]] const auto n = ::write(port[1], "r", 1);
      MultiOptions options;
      options.silence_s = busy_s;
      record_streams(std::move(streams), folder, options, [] { return false; });
      ::_exit(0);
    }
    ::close(port[1]);  // else a child that dies is waited for without end
    char ready = 0;
    ASSERT_EQ(::read(port[0], &ready, 1), 1) << "the recording program died at its start";
    MonotonicClock clock;
    while (samples_in(folder / "force.tsraw") < 10 || samples_in(folder / "tracker.tsraw") < 10) {
      ASSERT_EQ(::waitpid(child, nullptr, WNOHANG), 0) << "the recording program died";
      clock.sleep_until(clock.now_s() + 0.02);
    }
    clock.sleep_until(clock.now_s() + 0.13 * run);  // anywhere between two blocks
    const double killed_s = clock.now_s();
    ::kill(child, SIGKILL);
    ::waitpid(child, nullptr, 0);
    ::close(port[0]);
    for (const char* const name : {"force.tsraw", "tracker.tsraw"}) {
      double last_s = 0.0;
      read_raw(folder / name, [&](const RawSample& s) { last_s = std::max(last_s, s.wrench.t_s); });
      worst_s = std::max(worst_s, killed_s - last_s);
    }
    EXPECT_EQ(export_session(folder).tables.size(), 2U);
    fs::remove_all(folder);
  }
  fmt::print("killed: at worst {:.1f} ms are missing; threads woke up to {:.1f} ms late\n", 1e3 * worst_s,
             1e3 * machine.worst_s());
  // Reader and writer may each be held up by a busy machine.
  EXPECT_LT(worst_s, 0.1 + 2 * machine.worst_s());
}

TEST_F(MultiSession, AFullDiskEndsTheRunAndSavesWhatWaits) {
  std::signal(SIGXFSZ, SIG_IGN);
  rlimit room{};
  ::getrlimit(RLIMIT_FSIZE, &room);
  NetFtEmulator sensor(5000, {}, ramp);
  std::vector<NamedStream> streams;
  streams.push_back(force_of(sensor));
  MultiOptions options;
  options.silence_s = busy_s;
  options.disk_patience_s = 0.5;
  const fs::path elsewhere = folder_.string() + "-elsewhere";
  fs::create_directories(elsewhere);
  options.recorder.spill_folder = elsewhere;
  rlimit full = room;
  full.rlim_cur = 400000;
  ::setrlimit(RLIMIT_FSIZE, &full);
  const auto report = record_streams(std::move(streams), folder_, options, [] { return false; });
  ::setrlimit(RLIMIT_FSIZE, &room);
  EXPECT_FALSE(report.stopped);
  EXPECT_THAT(report.problems(), ElementsAre(HasSubstr("the disk would not take more")));
  const std::uint64_t n = samples_in(folder_ / "force.tsraw") + samples_in(elsewhere / "force.tsraw.rest");
  // A busy machine may let more wait than the limit leaves room for elsewhere: that is said.
  if (n != report.streams[0].last.counters.received) {
    EXPECT_THAT(report.problems(), ElementsAre(HasSubstr("later ones are lost")));
  }
  // Beside its beginning the rest is found.
  fs::rename(elsewhere / "force.tsraw.rest", folder_ / "force.tsraw.rest");
  EXPECT_EQ(export_session(folder_).tables[0].report.samples, n);
  EXPECT_EQ(export_raw({folder_ / "force.tsraw"}, folder_ / "force.csv").samples, n);
  fs::remove_all(elsewhere);
}

TEST_F(MultiSession, NothingIsOverwritten) {
  fs::create_directories(folder_);
  try {
    record_streams({}, folder_, {}, [] { return true; });
    FAIL();
  } catch (const BadData& error) {
    EXPECT_THAT(error.what(), HasSubstr("is there already"));
  }
  EXPECT_THROW(export_session(folder_), BadData);
}

}  // namespace
}  // namespace touchstone::hil
