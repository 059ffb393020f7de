#include "hil/record/record_session.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "harness/base/error.h"
#include "hil/emulators/netft_emulator.h"

namespace touchstone::hil {
namespace {

TEST(RecordSession, RecordsAnEmulatedSensorAndExportsWhatAcquireReads) {
  const auto folder = std::filesystem::temp_directory_path() / fmt::format("touchstone-session-{}", ::getpid());
  std::filesystem::create_directories(folder);
  NetFtEmulator emulator(5000, {}, [](double t) { return Wrench{Vec3(t, 0, 1), Vec3::Zero()}; });
  const auto source = open_netft(emulator.address(), 2.0, true);
  RecordOptions options;
  options.seconds = 1.0;
  options.nominal_rate_Hz = 5000;
  options.plot = false;
  const auto report = record_session(*source, folder / "a.tsraw", options, [] { return false; });
  EXPECT_FALSE(report.stopped);
  EXPECT_EQ(report.lost_in_memory, 0U);
  EXPECT_EQ(report.written, report.stream.received);
  EXPECT_GT(report.written, 4000U);
  const auto exported = export_raw({folder / "a.tsraw"}, folder / "a.csv");
  EXPECT_EQ(exported.samples, report.written);
  EXPECT_TRUE(exported.emulated);
  EXPECT_NEAR(exported.rate_Hz, 5000, 250);
  // Time increases evenly although samples came in packets.
  std::ifstream in(folder / "a.csv");
  std::string line;
  std::getline(in, line);
  EXPECT_EQ(line, "t_s,fx_N,fy_N,fz_N,tx_Nm,ty_Nm,tz_Nm,flags");
  double last = -1;
  while (std::getline(in, line)) {
    const double t = std::atof(line.c_str());
    EXPECT_GT(t, last);
    last = t;
  }
  std::filesystem::remove_all(folder);
}

TEST(RecordSession, TheExportSaysHowManySamplesNeverArrived) {
  const auto folder = std::filesystem::temp_directory_path() / fmt::format("touchstone-lost-{}", ::getpid());
  std::filesystem::create_directories(folder);
  RawRecorder recorder(folder / "c.tsraw", {}, {});
  for (std::uint64_t sequence = 100; sequence < 400; ++sequence) {
    if (sequence == 150 || sequence == 151 || sequence == 333) continue;
    RawSample sample;
    sample.wrench.sequence = sequence;
    sample.wrench.t_s = 1e-3 * static_cast<double>(sequence);
    recorder.push(sample);
  }
  recorder.finish();
  const auto exported = export_raw({folder / "c.tsraw"}, folder / "c.csv");
  EXPECT_EQ(exported.samples, 297U);
  EXPECT_EQ(exported.missing_samples, 3U);
  EXPECT_EQ(exported.damaged_bytes, 0U);
  std::filesystem::remove_all(folder);
}

TEST(RecordSession, KeepsWhatCameBeforeTheDeviceWent) {
  const auto folder = std::filesystem::temp_directory_path() / fmt::format("touchstone-gone-{}", ::getpid());
  std::filesystem::create_directories(folder);
  NetFtFaults faults;
  faults.silent_after = 2000;
  NetFtEmulator emulator(5000, faults, [](double) { return Wrench{}; });
  const auto source = open_netft(emulator.address(), 2.0, true);
  RecordOptions options;
  options.plot = false;
  MonotonicClock clock;
  // A while after the last was sent, however slow this machine is.
  double last_s = clock.now_s();
  const auto stop = [&] {
    if (emulator.sent() < faults.silent_after) last_s = clock.now_s();
    return clock.now_s() > last_s + 1.0;
  };
  const auto report = record_session(*source, folder / "b.tsraw", options, stop);
  EXPECT_TRUE(report.stopped);
  EXPECT_EQ(report.written, 2000U);
  std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace touchstone::hil
