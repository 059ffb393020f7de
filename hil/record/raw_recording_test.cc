#include "record/raw_recording.h"

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

#include "harness/base/atomic_file.h"
#include "harness/base/error.h"
#include "harness/base/random.h"
#include "record/raw_recorder.h"

namespace touchstone::hil {
namespace {

using ::testing::HasSubstr;
namespace fs = std::filesystem;

RawSample sample_of(std::uint64_t i) {
  RawSample s;
  s.wrench.t_s = 100.0 + static_cast<double>(i) / 5000.0;
  s.wrench.sequence = i;
  s.wrench.wrench.f_N = Vec3(std::sin(0.001 * static_cast<double>(i)), -1, static_cast<double>(i));
  s.wrench.flags = i % 1000 == 0 ? recording::sample_saturated : recording::sample_ok;
  s.p_W_m = Vec3(0.001 * static_cast<double>(i), 2, 3);
  return s;
}

RawHeader header_of(bool position) {
  RawHeader h;
  h.device = {"ati-netft", "EMU1", "emulated", "none", true};
  h.scheduling = "SCHED_OTHER";
  h.started = "2026-01-01T00:00:00Z";
  h.nominal_rate_Hz = 5000;
  h.position = position;
  return h;
}

// However slowly this machine fills them.
RawRecorderOptions whole_blocks() {
  RawRecorderOptions options;
  options.block_s = 1e9;
  return options;
}

class RawRecordingTest : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() / fmt::format("touchstone-raw-{}-{}", ::getpid(),
                                                      ::testing::UnitTest::GetInstance()->current_test_info()->name());
    fs::remove_all(folder_);
    fs::create_directories(folder_ / "elsewhere");
    std::signal(SIGXFSZ, SIG_IGN);
    ::getrlimit(RLIMIT_FSIZE, &room_);
  }
  void TearDown() override {
    ::setrlimit(RLIMIT_FSIZE, &room_);
    fs::remove_all(folder_);
  }
  [[nodiscard]] fs::path path(const std::string& name = "run.tsraw") const { return folder_ / name; }
  void fill_disk_at(std::uint64_t bytes) const {
    rlimit full = room_;
    full.rlim_cur = bytes;
    ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &full), 0);
  }
  void free_disk() const { ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &room_), 0); }

  void record(std::uint64_t n, bool position = false) const {
    RawRecorder recorder(path(), header_of(position), whole_blocks());
    for (std::uint64_t i = 0; i < n; ++i) {
      while (!recorder.push(sample_of(i))) ::usleep(100);
    }
    recorder.finish();
  }

  fs::path folder_;
  rlimit room_{};
};

// Where the blocks of a recording without positions lie.
const std::size_t start_bytes = raw_format::file_start(header_of(false)).size();
const std::size_t block_bytes = raw_format::block_header_bytes + 500 * header_of(false).sample_bytes();

TEST_F(RawRecordingTest, ComesBackToTheBit) {
  for (const bool position : {false, true}) {
    fs::remove(path());
    record(12345, position);
    std::uint64_t i = 0;
    const auto report = read_raw(path(), [&](const RawSample& s) {
      const RawSample expected = sample_of(i++);
      EXPECT_EQ(s.wrench.t_s, expected.wrench.t_s);
      EXPECT_EQ(s.wrench.sequence, expected.wrench.sequence);
      EXPECT_EQ(s.wrench.wrench.f_N, expected.wrench.wrench.f_N);
      EXPECT_EQ(s.wrench.flags, expected.wrench.flags);
      if (position) {
        EXPECT_EQ(s.p_W_m, expected.p_W_m);
      }
    });
    EXPECT_EQ(report.samples, 12345U);
    EXPECT_EQ(report.missing_samples + report.damaged_bytes, 0U);
    EXPECT_EQ(report.header.device.serial, "EMU1");
    EXPECT_TRUE(report.header.device.emulated);
  }
}

TEST_F(RawRecordingTest, PosesComeBackToTheBit) {
  auto header = header_of(false);
  header.pose = true;
  header.clock = StreamClock::ticks;
  header.ticks_per_s = 3312787;
  const auto pose_of = [](std::uint64_t i) {
    RawSample s = sample_of(i);
    s.q_WB = Quat(Eigen::AngleAxisd(0.01 * static_cast<double>(i), Vec3(1, 2, 3).normalized()));
    s.ticks = 1416497730518U + i;
    return s;
  };
  {
    RawRecorder recorder(path(), header, {});
    for (std::uint64_t i = 0; i < 700; ++i) EXPECT_TRUE(recorder.push(pose_of(i)));
    recorder.finish();
  }
  std::uint64_t i = 0;
  const auto report = read_raw(path(), [&](const RawSample& s) {
    const RawSample expected = pose_of(i++);
    EXPECT_EQ(s.wrench.t_s, expected.wrench.t_s);
    EXPECT_EQ(s.p_W_m, expected.p_W_m);
    EXPECT_EQ(s.q_WB.coeffs(), expected.q_WB.coeffs());
    EXPECT_EQ(s.ticks, expected.ticks);
  });
  EXPECT_EQ(report.samples, 700U);
  EXPECT_EQ(report.header.clock, StreamClock::ticks);
  EXPECT_EQ(report.header.ticks_per_s, 3312787);
}

// A tracker at 60 Hz would fill a block in 8 s; a crash may cost a tenth of a second.
TEST_F(RawRecordingTest, ASlowStreamIsOnDiskWithinATenthOfASecond) {
  RawRecorder recorder(path(), header_of(false), {});
  MonotonicClock clock;
  double worst_s = 0.0;
  for (std::uint64_t i = 0; i < 6; ++i) {
    const double pushed = clock.now_s();
    EXPECT_TRUE(recorder.push(sample_of(i)));
    while (recorder.written() < i + 1 && clock.now_s() < pushed + 5.0) ::usleep(1000);
    worst_s = std::max(worst_s, clock.now_s() - pushed);
  }
  fmt::print("a lone sample was in the file after {:.0f} ms at most\n", 1e3 * worst_s);
  EXPECT_LT(worst_s, 0.1 + 0.4) << "0.1 s, and what a busy machine may hold the writer up";
}

TEST_F(RawRecordingTest, CutAnywhereKeepsEveryWholeBlock) {
  record(2000);
  const auto whole = read_file(path());
  Random random(1);
  for (int trial = 0; trial < 60; ++trial) {
    const std::size_t cut = start_bytes + random.below(whole.size() - start_bytes + 1);
    write_file(path("cut.tsraw"), whole.substr(0, cut));
    std::uint64_t n = 0;
    const auto report = read_raw(path("cut.tsraw"), [&](const RawSample& s) { EXPECT_EQ(s.wrench.sequence, n++); });
    EXPECT_EQ(report.samples, (cut - start_bytes) / block_bytes * 500) << cut;
    EXPECT_EQ(report.damaged_bytes, (cut - start_bytes) % block_bytes) << cut;
  }
}

TEST_F(RawRecordingTest, ADamagedBlockCostsItselfOnly) {
  record(2500);
  const auto bytes = read_file(path());
  Random random(2);
  for (int trial = 0; trial < 40; ++trial) {
    auto damaged = bytes;
    const std::size_t at =
        start_bytes + block_bytes + random.below(3 * block_bytes);  // in the second to fourth of five
    damaged[at] = static_cast<char>(damaged[at] ^ 0x10);
    write_file(path("damaged.tsraw"), damaged);
    const auto report = read_raw(path("damaged.tsraw"), [](const RawSample&) {});
    EXPECT_EQ(report.samples, 2000U) << at;
    EXPECT_EQ(report.missing_samples, 500U) << at;
    EXPECT_EQ(report.damaged_bytes, block_bytes) << at;
  }
}

TEST_F(RawRecordingTest, RefusesWhatIsNotOneAndNeverOverwrites) {
  write_file(path("a.csv"), "t_s,fx_N\n0,1\n");
  EXPECT_THROW(read_raw(path("a.csv"), [](const RawSample&) {}), BadData);
  record(10);
  auto bytes = read_file(path());
  bytes[30] = static_cast<char>(bytes[30] ^ 1);
  write_file(path("header.tsraw"), bytes);
  try {
    read_raw(path("header.tsraw"), [](const RawSample&) {});
    FAIL();
  } catch (const BadData& error) {
    EXPECT_THAT(error.what(), HasSubstr("header is damaged"));
  }
  EXPECT_THROW(RawRecorder(path(), header_of(false), {}), BadData);
}

TEST_F(RawRecordingTest, SurvivesTheProgramsDeath) {
  const pid_t child = ::fork();
  if (child == 0) {
    RawRecorder recorder(path(), header_of(false), whole_blocks());
    for (std::uint64_t i = 0;; ++i) {
      while (!recorder.push(sample_of(i))) ::usleep(50);
    }
  }
  for (int wait = 0; wait < 2000 && (!fs::exists(path()) || fs::file_size(path()) < 400000); ++wait) ::usleep(5000);
  ::kill(child, SIGKILL);
  ::waitpid(child, nullptr, 0);
  std::uint64_t n = 0, wrong = 0;
  const auto report = read_raw(path(), [&](const RawSample& s) { wrong += s.wrench.sequence != n++; });
  EXPECT_EQ(wrong, 0U);
  EXPECT_GE(report.samples, 5000U);
  EXPECT_EQ(report.missing_samples, 0U);
  EXPECT_LT(report.damaged_bytes, block_bytes);
}

TEST_F(RawRecordingTest, ADiskThatIsFullForAWhileLosesNothing) {
  RawRecorder recorder(path(), header_of(false), whole_blocks());
  fill_disk_at(100000);  // in the middle of the third block
  for (std::uint64_t i = 0; i < 5000; ++i) EXPECT_TRUE(recorder.push(sample_of(i)));
  for (int wait = 0; wait < 400 && !recorder.stalled(); ++wait) ::usleep(5000);
  EXPECT_TRUE(recorder.stalled());
  EXPECT_EQ(recorder.written(), 1000U);
  free_disk();
  for (int wait = 0; wait < 400 && recorder.stalled(); ++wait) ::usleep(5000);
  recorder.finish();
  std::uint64_t n = 0;
  const auto report = read_raw(path(), [&](const RawSample& s) { EXPECT_EQ(s.wrench.sequence, n++); });
  EXPECT_EQ(report.samples, 5000U);
  EXPECT_EQ(report.damaged_bytes, 0U);
}

TEST_F(RawRecordingTest, ADiskThatStaysFullSpillsElsewhereAndSaysSo) {
  RawRecorderOptions options = whole_blocks();
  options.spill_folder = folder_ / "elsewhere";
  RawRecorder recorder(path(), header_of(false), options);
  // Four blocks: two fit here, and under the same limit two fit the spill file.
  fill_disk_at(100000);
  for (std::uint64_t i = 0; i < 2000; ++i) EXPECT_TRUE(recorder.push(sample_of(i)));
  for (int wait = 0; wait < 400 && !recorder.stalled(); ++wait) ::usleep(5000);
  std::string complaint;
  try {
    recorder.finish();
  } catch (const BadData& error) {
    complaint = error.what();
  }
  free_disk();
  EXPECT_THAT(complaint, HasSubstr("1000 samples are there and sound, the last 1000 are in"));
  std::uint64_t n = 0;
  read_raw(path(), [&](const RawSample& s) { EXPECT_EQ(s.wrench.sequence, n++); });
  read_raw(options.spill_folder / "run.tsraw.rest", [&](const RawSample& s) { EXPECT_EQ(s.wrench.sequence, n++); });
  EXPECT_EQ(n, 2000U);
}

TEST_F(RawRecordingTest, AFullRingCountsWhatItLoses) {
  RawRecorderOptions options = whole_blocks();
  options.ring_samples = 100;
  options.block_samples = 1000;  // never enough for a block: nothing is taken out
  RawRecorder recorder(path(), header_of(false), options);
  int taken = 0;
  for (std::uint64_t i = 0; i < 150; ++i) taken += recorder.push(sample_of(i));
  EXPECT_EQ(taken, 100);
  EXPECT_EQ(recorder.lost(), 50U);
  recorder.finish();
  EXPECT_EQ(recorder.written(), 100U);
}

// An hour at 5 kHz is 18 million samples; here a minute's, as fast as they go, with memory that does not grow.
TEST_F(RawRecordingTest, AMinuteAtFiveKilohertzCompressed) {
  RawRecorder recorder(path(), header_of(false), whole_blocks());
  const auto memory = recorder.memory_bytes();
  constexpr std::uint64_t n = 300000;
  for (std::uint64_t i = 0; i < n; ++i) {
    while (!recorder.push(sample_of(i))) ::usleep(200);
  }
  recorder.finish();
  EXPECT_EQ(recorder.written(), n);
  EXPECT_LE(recorder.memory_bytes(), memory);
  EXPECT_LT(memory, 80U << 20U);
  std::uint64_t i = 0, wrong = 0;
  const auto report = read_raw(path(), [&](const RawSample& s) { wrong += s.wrench.sequence != i++; });
  EXPECT_EQ(report.samples, n);
  EXPECT_EQ(wrong, 0U);
}

}  // namespace
}  // namespace touchstone::hil
