#include "hil/record/record_session.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "harness/base/error.h"
#include "hil/emulators/netft_emulator.h"
#include "hil/record/stream_export.h"

namespace touchstone::hil {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

// Most sensors serve one client. The one that gets nothing must not pass, nor the one whose stream was taken away.
TEST(RecordSession, ASilentStreamIsNoSuccess) {
  const auto folder = std::filesystem::temp_directory_path() / fmt::format("touchstone-silent-{}", ::getpid());
  std::filesystem::create_directories(folder);
  NetFtFaults faults;
  faults.newest_client_wins = true;
  NetFtEmulator emulator(1000, faults, [](double) { return Wrench{}; });
  const auto first = open_netft(emulator.address(), 2.0, true), second = open_netft(emulator.address(), 2.0, true);
  first->start();
  second->start();
  RecordOptions options;
  options.plot = false;
  options.seconds = 20.0;
  options.silence_s = 0.5;
  // Without start(): the newest client has the stream already.
  struct Started final : WrenchSource {
    explicit Started(WrenchSource& s) : source(s) {}
    [[nodiscard]] const DeviceIdentity& identity() const override { return source.identity(); }
    void start() override {}
    void stop() noexcept override {}
    std::size_t read(std::span<WrenchSample> out, double deadline_s) override { return source.read(out, deadline_s); }
    [[nodiscard]] StreamCounters counters() const override { return source.counters(); }
    WrenchSource& source;
  } robbed(*first);
  for (std::vector<WrenchSample> old(64); first->read(old, MonotonicClock().now_s() + 0.2) > 0;) {
  }
  const auto report = record_session(robbed, folder / "a.tsraw", options, [] { return false; });
  EXPECT_LT(report.seconds, 15.0);
  EXPECT_TRUE(report.silent);
  EXPECT_EQ(report.written, 0U);
  EXPECT_THAT(report.problems(), ElementsAre(HasSubstr("sent nothing")));
  std::filesystem::remove_all(folder);
}

TEST(RecordSession, AThirdOfTheStreamIsNotAllOfIt) {
  RecordReport report;
  report.written = 20000;
  report.seconds = 6.0;
  report.device_rate_Hz = report.arrival_rate_Hz = 5000;
  EXPECT_THAT(report.problems(), IsEmpty());
  report.arrival_rate_Hz = 3333;
  EXPECT_THAT(report.problems(), ElementsAre(HasSubstr("another client")));
}

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
  EXPECT_NEAR(exported.rate_Hz, 5000, 0.005 * 5000);
  EXPECT_LE(exported.mean_delay_s, exported.worst_delay_s);
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
  options.silence_s = 1.0;
  const auto report = record_session(*source, folder / "b.tsraw", options, [] { return false; });
  EXPECT_TRUE(report.silent);
  EXPECT_EQ(report.written, 2000U);
  EXPECT_THAT(report.problems(), ElementsAre(HasSubstr("the stream stopped")));
  std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace touchstone::hil
