// What is written is read back to the bit, and what other programs write is understood.
#include "harness/recording/recording_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <bit>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <thread>

#include "harness/base/atomic_file.h"
#include "harness/base/error.h"
#include "harness/base/random.h"
#include "harness/recording/recording_stream.h"
#include "harness/recording/recording_writer.h"
#include "harness/testing/shared_data.h"

namespace touchstone::recording {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

std::filesystem::path temporary(const std::string& name) {
  const auto folder = std::filesystem::path(::testing::TempDir()) / "touchstone-recording-file" /
                      ::testing::UnitTest::GetInstance()->current_test_info()->name();
  ensure_writable_folder(folder);
  return folder / name;
}

// Numbers of every size and sign, as awkward to write as doubles come.
double awkward(Random& random) {
  const double magnitude = random.log_uniform(1e-300, 1e200);
  return random.uniform() < 0.5 ? -magnitude : magnitude;
}

Vec3 awkward_vector(Random& random) { return {awkward(random), awkward(random), awkward(random)}; }

Recording awkward_recording(std::size_t n, std::uint64_t seed) {
  Random random(seed);
  Recording recording;
  double t_s = -1.0 / 3.0;
  for (std::size_t i = 0; i < n; ++i) {
    t_s += random.log_uniform(1e-6, 1.0);
    recording.motion.t_s.push_back(t_s);
    recording.motion.p_W_m.push_back(awkward_vector(random));
    recording.motion.q_WS.push_back(random.rotation());
    recording.f_W_N.push_back(awkward_vector(random));
    recording.torque_W_Nm.push_back(awkward_vector(random));
  }
  recording.f_W_N[0] = {-0.0, 5e-324, 1.7976931348623157e308};
  return recording;
}

std::uint64_t bits(double value) { return std::bit_cast<std::uint64_t>(value); }

void expect_same_bits(const Vec3& a, const Vec3& b) {
  for (int axis = 0; axis < 3; ++axis)
    EXPECT_EQ(bits(a[axis]), bits(b[axis])) << a.transpose() << " | " << b.transpose();
}

class RoundTrip : public ::testing::TestWithParam<const char*> {};

TEST_P(RoundTrip, RecordingComesBackToTheBit) {
  const auto file = temporary(std::string("r") + GetParam());
  // More than one chunk and one block of every reader and writer.
  const Recording written = awkward_recording(17000, 1);
  save_recording(file, written);
  const Recording read = load_recording(file);
  ASSERT_EQ(read.size(), written.size());
  ASSERT_EQ(read.torque_W_Nm.size(), written.size());
  ASSERT_EQ(read.motion.q_WS.size(), written.size());
  EXPECT_EQ(read.source, file.string());
  for (std::size_t i = 0; i < read.size(); ++i) {
    ASSERT_EQ(bits(read.motion.t_s[i]), bits(written.motion.t_s[i]));
    expect_same_bits(read.motion.p_W_m[i], written.motion.p_W_m[i]);
    expect_same_bits(read.f_W_N[i], written.f_W_N[i]);
    expect_same_bits(read.torque_W_Nm[i], written.torque_W_Nm[i]);
    ASSERT_LE((read.motion.q_WS[i].coeffs() - written.motion.q_WS[i].coeffs()).norm(), 1e-15);
  }
  // Orientation is normalised where it was not; from then on it stays.
  const auto again = temporary(std::string("again") + GetParam());
  save_recording(again, read);
  const Recording second = load_recording(again);
  for (std::size_t i = 0; i < read.size(); ++i) {
    ASSERT_EQ(second.motion.q_WS[i].coeffs(), read.motion.q_WS[i].coeffs());
  }
}

TEST_P(RoundTrip, RenderedComesBackToTheBit) {
  const auto file = temporary(std::string("out") + GetParam());
  std::filesystem::remove(file);
  Random random(2);
  RenderedTrajectory written;
  RenderedWriter writer(file, true);
  for (int i = 0; i < 9000; ++i) {
    written.t_s.push_back(i * 1e-3);
    written.tip_W_m.push_back(awkward_vector(random));
    written.contact_W_m.push_back(awkward_vector(random));
    written.f_W_N.push_back(awkward_vector(random));
    written.contact.push_back(random.below(2) == 1 ? 1 : 0);
    written.cost_us.push_back(random.uniform());
    writer.append(written.t_s.back(), written.tip_W_m.back(), written.contact_W_m.back(), written.f_W_N.back(),
                  written.contact.back() == 1, written.cost_us.back());
  }
  EXPECT_FALSE(std::filesystem::exists(file)) << "the file appears only when it is complete";
  writer.commit();
  const auto whole = temporary(std::string("whole") + GetParam());
  save_rendered(whole, written);
  for (const auto& path : {file, whole}) {
    const RenderedTrajectory read = load_rendered(path);
    EXPECT_EQ(read.t_s, written.t_s);
    EXPECT_EQ(read.tip_W_m, written.tip_W_m);
    EXPECT_EQ(read.contact_W_m, written.contact_W_m);
    EXPECT_EQ(read.f_W_N, written.f_W_N);
    EXPECT_EQ(read.contact, written.contact);
    EXPECT_EQ(read.cost_us, written.cost_us);
  }
}

TEST_P(RoundTrip, TrajectoryWithAndWithoutOrientation) {
  for (const bool oriented : {false, true}) {
    const auto file = temporary(std::string(oriented ? "q" : "p") + GetParam());
    Random random(3);
    InTrajectory written;
    TrajectoryWriter writer(file, oriented);
    for (int i = 0; i < 10; ++i) {
      written.motion.t_s.push_back(0.1 * i);
      written.motion.p_W_m.push_back(awkward_vector(random));
      const Quat q = random.rotation();
      if (oriented) written.motion.q_WS.push_back(q);
      writer.append(written.motion.t_s.back(), written.motion.p_W_m.back(), q);
    }
    writer.commit();
    const auto whole = temporary(std::string(oriented ? "wq" : "wp") + GetParam());
    save_trajectory(whole, written);
    for (const auto& path : {file, whole}) {
      const InTrajectory read = load_trajectory(path);
      EXPECT_EQ(read.motion.t_s, written.motion.t_s);
      EXPECT_EQ(read.motion.p_W_m, written.motion.p_W_m);
      EXPECT_EQ(read.motion.q_WS.size(), written.motion.q_WS.size());
    }
  }
}

TEST_P(RoundTrip, OtherUnitsReadBackToRounding) {
  const auto file = temporary(std::string("mm") + GetParam());
  const Recording written = [] {
    Recording recording = awkward_recording(100, 4);
    recording.f_W_N[0].setOnes();
    return recording;
  }();
  save_recording(file, written, {.time = "ms", .length = "mm", .force = "mN", .torque = "Nmm"});
  const Recording read = load_recording(file);
  for (std::size_t i = 0; i < read.size(); ++i) {
    // One rounding when written, one when read.
    EXPECT_LE((read.motion.p_W_m[i] - written.motion.p_W_m[i]).norm(), 2.3e-16 * written.motion.p_W_m[i].norm());
    EXPECT_LE((read.f_W_N[i] - written.f_W_N[i]).norm(), 2.3e-16 * written.f_W_N[i].norm());
    EXPECT_LE(std::abs(read.motion.t_s[i] - written.motion.t_s[i]), 2.3e-16 * std::abs(written.motion.t_s[i]));
  }
}

INSTANTIATE_TEST_SUITE_P(Formats, RoundTrip, ::testing::Values(".csv", ".csv.gz", ".h5", ".hdf5"),
                         [](const auto& format) {
                           std::string name(format.param + 1);
                           std::erase(name, '.');
                           return name;
                         });

TEST(RecordingFile, TheSameRecordingGivesTheSameBytes) {
  const Recording recording = awkward_recording(1000, 5);
  for (const char* name : {"a.csv", "a.h5"}) {
    save_recording(temporary(name), recording);
    const std::string first = read_file(temporary(name));
    // A time stamp in the file would have changed by then.
    std::this_thread::sleep_for(std::chrono::milliseconds(1100));
    save_recording(temporary(name), recording);
    EXPECT_EQ(first, read_file(temporary(name))) << name;
  }
}

TEST(RecordingFile, ReadsWhatOtherProgramsWrite) {
  // Any column order, units, byte-order mark, CRLF, blanks, plus signs, quotes, semicolons, no last line end.
  const auto file = temporary("r.csv");
  write_file(file,
             "\xef\xbb\xbf\"fz_mN\"; x_mm ;y_mm;z_mm;t_ms;fx_mN;fy_mN\r\n"
             " +1000; \"4.459\";0;-1e-3;\"0\";2;3 \r\n"
             "2000;4;5;6;1.5;7;8\r\n\r\n");
  const auto loaded = load_recording(file, ClockPolicy{});
  const Recording& recording = loaded.value;
  EXPECT_THAT(recording.motion.t_s, ElementsAre(0.0, 1.5e-3));
  EXPECT_EQ(recording.motion.p_W_m[0], Vec3(4.459 / 1e3, 0.0, -1e-3 / 1e3));
  EXPECT_EQ(recording.f_W_N[0], Vec3(2e-3, 3e-3, 1.0));
  EXPECT_THAT(loaded.notes, ElementsAre(HasSubstr("semicolons")));
  write_file(file, "t_s,x_m,y_m,z_m\n0,1,2,3\n1,\"1,2,4\n");
  EXPECT_THROW(load_trajectory(file, ClockPolicy{}), BadData) << "a quote that does not end";
  write_file(file, "t_s\tx_m\ty_m\tz_m\n0\t1\t2\t3\n1\t 1 \t2\t4");
  const auto tabs = load_trajectory(file, ClockPolicy{});
  EXPECT_EQ(tabs.value.motion.p_W_m[1], Vec3(1, 2, 4));
  EXPECT_THAT(tabs.notes, ElementsAre(HasSubstr("tabs"), HasSubstr("no line end after the last line")));
}

TEST(RecordingFile, TrajectoryChecksTheColumnsThatItIgnores) {
  const auto file = temporary("r.csv");
  write_file(file, "t_s,x_m,y_m,z_m,fx_N,fy_N,fz_N\n0,0,0,0,1,2,3\n1,0,0,0,1,2,3\n");
  EXPECT_THAT(load_trajectory(file, ClockPolicy{}).notes, ElementsAre(HasSubstr("not used: fx, fy, fz")));
  write_file(file, "t_s,x_m,y_m,z_m,fx_N,fy_N,fz_N\n0,0,0,0,1,2,3\n1,0,0,0,1,nan,3\n");
  EXPECT_THROW(load_trajectory(file), BadData);
}

TEST(RecordingFile, RepeatedTimesAreRefusedOrHandledAndSaid) {
  const auto file = temporary("r.csv");
  write_file(file,
             "t_s,x_m,y_m,z_m,fx_N,fy_N,fz_N,qw,qx,qy,qz\n0,0,0,0,0,0,0,1,0,0,0\n1,1,0,0,1,0,0,1,0,0,0\n"
             "1,3,0,0,2,0,0,-1,0,0,0\n2,4,0,0,0,0,0,1,0,0,0\n2,6,0,0,0,0,0,1,0,0,0\n");
  EXPECT_THROW(load_recording(file), BadData);
  const auto first = load_recording(file, {.on_duplicate = OnDuplicate::first});
  EXPECT_THAT(first.value.motion.t_s, ElementsAre(0, 1, 2));
  EXPECT_EQ(first.value.motion.p_W_m[1].x(), 1.0);
  EXPECT_EQ(first.clock.duplicates, 2U);
  EXPECT_THAT(first.notes, ElementsAre(HasSubstr("2 samples with a repeated time left out (the first of each stays), "
                                                 "the first in line 4")));
  const auto mean = load_recording(file, {.on_duplicate = OnDuplicate::mean});
  EXPECT_THAT(mean.value.motion.t_s, ElementsAre(0, 1, 2));
  EXPECT_EQ(mean.value.motion.p_W_m[1].x(), 2.0);
  EXPECT_EQ(mean.value.motion.p_W_m[2].x(), 5.0);
  EXPECT_EQ(mean.value.f_W_N[1].x(), 1.5);
  EXPECT_EQ(mean.value.motion.q_WS[1].w(), 1.0) << "q and -q are one orientation";
  EXPECT_THAT(mean.notes, ElementsAre(HasSubstr("merged into means")));
  // However the file is cut into blocks.
  for (const auto policy : {OnDuplicate::first, OnDuplicate::mean}) {
    for (std::size_t size = 1; size < 6; ++size) {
      auto stream = RecordingStream::open(file, {.clock = {.on_duplicate = policy}});
      SampleBlock all;
      SampleBlock block;
      while (stream.next(block, size)) {
        EXPECT_LE(block.size(), size);
        EXPECT_EQ(block.first_sample, all.size());
        all.append(block);
      }
      EXPECT_EQ(all.motion.t_s, mean.value.motion.t_s);
      EXPECT_EQ(all.motion.p_W_m, policy == OnDuplicate::first ? first.value.motion.p_W_m : mean.value.motion.p_W_m);
      EXPECT_EQ(stream.samples(), 3U);
      EXPECT_FALSE(stream.next(block, size)) << "the end stays the end";
    }
  }
}

TEST(RecordingFile, GapsAreKeptAndSaidSplitOrRefused) {
  const auto file = temporary("r.csv");
  std::string text = "t_s,x_m,y_m,z_m,fx_N,fy_N,fz_N\n";
  for (const char* t : {"0", "1", "2", "10", "11", "12", "13"}) text += std::string(t) + ",0,0,0,0,0,0\n";
  write_file(file, text);
  const auto kept = load_recording(file, ClockPolicy{});
  EXPECT_EQ(kept.clock.gap_count, 1U);
  EXPECT_THAT(kept.notes,
              ElementsAre(HasSubstr("1 gap longer than 5 median intervals, the first of 8 s after t = 2 s")));
  const auto split = load_recording(file, {.on_gap = OnGap::split});
  EXPECT_THAT(split.segment_starts, ElementsAre(0U, 3U));
  EXPECT_THROW(load_recording(file, {.on_gap = OnGap::refuse}), BadData);
  EXPECT_TRUE(load_recording(file, {.gap_factor = 9.0}).notes.empty());
  EXPECT_THROW(load_recording(file, {.gap_factor = 1.0}), UsageError);
}

TEST(RecordingFile, QuaternionsAreNormalisedWithinTheTolerance) {
  const auto file = temporary("r.csv");
  const std::string head = "t_s,x_m,y_m,z_m,qw,qx,qy,qz\n0,0,0,0,1,0,0,0\n";
  write_file(file, head + "1,0,0,0,0.6003,0,0.8004,0\n");
  const auto loaded = load_trajectory(file, ClockPolicy{});
  EXPECT_NEAR(loaded.value.motion.q_WS[1].norm(), 1.0, 1e-15);
  EXPECT_THAT(loaded.notes,
              ElementsAre(HasSubstr("quaternions normalised; their length differed from 1 by at most 0.0005")));
  write_file(file, head + "1,0,0,0,0.61,0,0.81,0\n");
  EXPECT_THROW(load_trajectory(file), BadData);
}

TEST(RecordingFile, AWriterRefusesWhatNoReaderAccepts) {
  const auto file = temporary("r.csv");
  write_file(file, "as it was");
  Recording recording = awkward_recording(3, 6);
  recording.f_W_N[1].y() = std::nan("");
  EXPECT_THROW(save_recording(file, recording), BadData);
  recording = awkward_recording(3, 6);
  recording.motion.t_s[2] = recording.motion.t_s[1];
  EXPECT_THROW(save_recording(file, recording), BadData);
  recording.motion.t_s.pop_back();
  EXPECT_THROW(save_recording(file, recording), std::invalid_argument);
  EXPECT_THROW(save_recording(temporary("r.txt"), awkward_recording(3, 6)), BadData);
  EXPECT_THROW(save_recording(temporary("no-such-folder") / "r.csv", awkward_recording(3, 6)), BadData);
  EXPECT_THROW(save_recording(temporary("no-such-folder") / "r.h5", awkward_recording(3, 6)), BadData);
  EXPECT_THROW(save_recording(file, awkward_recording(3, 6), {.length = "inch"}), UsageError);
  EXPECT_EQ(read_file(file), "as it was");
}

TEST(RecordingFile, RealPalpationRuns) {
  TOUCHSTONE_SHARED_DATA_OR_SKIP(path, "palpation/ContPalpRAL18T1.csv");
  const auto loaded = load_recording(path, ClockPolicy{});
  EXPECT_EQ(loaded.value.size(), 25941U);
  EXPECT_EQ(loaded.value.motion.p_W_m[0], Vec3(-4.4590 / 1e3, -44.0096 / 1e3, -126.7893 / 1e3));
  EXPECT_NEAR(loaded.clock.nominal_rate_Hz, 66.0, 7.0);
  EXPECT_EQ(loaded.clock.duplicates, 0U);
}

}  // namespace
}  // namespace touchstone::recording
