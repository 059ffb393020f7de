#include "record/record_session.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "emulators/netft_emulator.h"
#include "harness/base/error.h"
#include "record/device_recording.h"
#include "record/stream_export.h"

namespace touchstone::hil {
namespace {

using ::testing::AllOf;
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

// Ten samples a second by an adapter that hands on two at a time, then a pause: as a load cell's sketch that tares.
class TwoAtATime final : public WrenchSource {
 public:
  [[nodiscard]] const DeviceIdentity& identity() const override { return identity_; }
  [[nodiscard]] bool numbers_records() const override { return false; }
  void start() override {}
  void stop() noexcept override {}
  std::size_t read(std::span<WrenchSample> out, double deadline_s) override {
    if (sent_ == 10) {
      MonotonicClock().sleep_until(deadline_s);
      return 0;
    }
    for (std::size_t i = 0; i < 2; ++i, ++sent_) {
      out[i] = {};
      out[i].sequence = sent_;
      out[i].t_s = 100.0 + 0.1 * static_cast<double>(sent_) + (sent_ >= 6 ? 1.0 : 0.0);
      if (sent_ == 9) out[i].t_s = out[i - 1].t_s;
    }
    return 2;
  }
  [[nodiscard]] StreamCounters counters() const override { return {}; }

 private:
  DeviceIdentity identity_{"hx711-serial", "", "", "", true};
  std::uint64_t sent_ = 0;
};

TEST(RecordSession, ASensorThatNumbersNothingKeepsItsArrivals) {
  const auto folder = std::filesystem::temp_directory_path() / fmt::format("touchstone-arrivals-{}", ::getpid());
  std::filesystem::create_directories(folder);
  RecordOptions options;
  options.plot = false;
  options.silence_s = 0.2;
  TwoAtATime source;
  record_session(source, folder / "a.tsraw", options, [] { return false; });
  EXPECT_EQ(read_raw_header(folder / "a.tsraw").clock, StreamClock::host);
  const auto exported = export_raw({folder / "a.tsraw"}, folder / "a.csv");
  EXPECT_EQ(exported.samples, 10U);
  EXPECT_EQ(exported.left_out_samples, 1U);
  EXPECT_THAT(recovery_text(exported, "a.csv"), AllOf(HasSubstr("times are arrivals"), HasSubstr("1 left out")));
  std::ifstream in(folder / "a.csv");
  std::string line;
  std::getline(in, line);
  std::vector<double> times;
  while (std::getline(in, line)) times.push_back(std::atof(line.c_str()));
  ASSERT_EQ(times.size(), 9U);
  for (std::size_t i = 1; i < times.size(); ++i) EXPECT_NEAR(times[i] - times[i - 1], i == 6 ? 1.1 : 0.1, 1e-6) << i;
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
