// The shelf in the spectrum of positions: found with its size where a tracker's noise was low-passed and interpolated,
// and not where there is none. The ten recordings were made by others (TOUCHSTONE_DATA_DIR).
#include "harness/discrepancy/tracker_spectrum.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <numbers>

#include "harness/base/atomic_file.h"
#include "harness/base/random.h"
#include "harness/discrepancy/instrument_description.h"
#include "harness/recording/recording_file.h"
#include "harness/testing/shared_data.h"

namespace touchstone::discrepancy {
namespace {

// A hand that wanders: sums of sines up to 3 Hz whose size falls with the square of the frequency. Positions in files
// of a micrometre's resolution.
MotionColumns hand(double rate_Hz, std::uint64_t seed) {
  Random random(seed);
  struct Sine {
    Vec3 size_m;
    double f_Hz, phase;
  };
  std::vector<Sine> sines;
  for (int k = 0; k < 40; ++k) {
    const double f_Hz = random.uniform(0.1, 3.0);
    sines.push_back({2e-3 / (1.0 + f_Hz * f_Hz) * random.direction(), f_Hz, random.uniform(0.0, 6.28)});
  }
  MotionColumns motion;
  for (int i = 0; i < static_cast<int>(20.0 * rate_Hz); ++i) {
    const double t_s = i / rate_Hz;
    Vec3 p = Vec3::Zero();
    for (const Sine& sine : sines) p += std::sin(2.0 * std::numbers::pi * sine.f_Hz * t_s + sine.phase) * sine.size_m;
    motion.t_s.push_back(t_s);
    motion.p_W_m.push_back(p);
  }
  return motion;
}

MotionColumns as_written(MotionColumns motion) {
  for (Vec3& p : motion.p_W_m) p = (p * 1e6).array().round().matrix() * 1e-6;
  return motion;
}

TEST(TrackerSpectrum, FindsLowPassedNoiseAtSeveralRatesAndSizes) {
  std::uint64_t seed = 1;
  for (const double rate_Hz : {250.0, 1000.0}) {
    for (const double tracker_Hz : {60.0, 100.0}) {
      for (const double noise_m : {20e-6, 100e-6}) {
        SCOPED_TRACE(::testing::Message() << rate_Hz << " Hz, tracker " << tracker_Hz << " Hz, " << noise_m << " m");
        InstrumentDescription tracker;
        tracker.position_noise_m = noise_m;
        tracker.position_rate_Hz = tracker_Hz;
        Random random(++seed);
        const auto found = tracker_noise(as_written(with_position_noise(hand(rate_Hz, seed), tracker, random)));
        ASSERT_TRUE(found);
        EXPECT_NEAR(found->position_noise_m, noise_m, 0.35 * noise_m);
        EXPECT_NEAR(found->position_rate_Hz, tracker_Hz, 0.35 * tracker_Hz);
      }
    }
  }
}

TEST(TrackerSpectrum, IsSilentWhereDifferencesSeeTheNoise) {
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    MotionColumns motion = hand(250.0, seed);
    const auto none = tracker_noise(as_written(motion));
    EXPECT_FALSE(none) << "no noise but rounding, seed " << seed << ": " << none->position_noise_m << " m, corner "
                       << none->corner_Hz;
    Random random(100 + seed);
    for (Vec3& p : motion.p_W_m) p += 30e-6 * Vec3(random.normal(), random.normal(), random.normal());
    EXPECT_FALSE(tracker_noise(motion)) << "white noise, seed " << seed;
  }
  MotionColumns brief = hand(250.0, 9);
  brief.t_s.resize(500);
  brief.p_W_m.resize(500);
  EXPECT_FALSE(tracker_noise(brief));
  EXPECT_FALSE(tracker_noise({}));
}

TEST(TrackerSpectrum, FindsWhatOthersDeclareInTenRecordings) {
  TOUCHSTONE_SHARED_DATA_OR_SKIP(sample, "discrepancy-sample");
  std::size_t seen = 0;
  for (const auto& folder : std::filesystem::directory_iterator(sample)) {
    if (!folder.is_directory()) continue;
    SCOPED_TRACE(folder.path());
    const InstrumentDescription declared = load_instrument(folder.path() / "instrument.json");
    for (const char* const file : {"train.csv", "holdout.csv"}) {
      SCOPED_TRACE(file);
      const MotionColumns motion = recording::load_recording(folder.path() / file).motion;
      const auto found = tracker_noise(motion);
      ASSERT_TRUE(found);
      // Another low-pass than ours, 20 s: 0.62 to 1.2 of what is declared in the twenty files.
      EXPECT_NEAR(found->position_noise_m, declared.position_noise_m, 0.45 * declared.position_noise_m);
      recording::Recording recording;
      recording.motion = motion;
      recording.f_W_N.resize(motion.size());
      EXPECT_LT(estimate_instrument(recording).position_noise_m, 0.02 * declared.position_noise_m);
    }
    ++seen;
  }
  EXPECT_EQ(seen, 10U);
}

TEST(TrackerSpectrum, IsWrittenAsAnInstrumentThatIsReadBack) {
  const auto file = std::filesystem::path(::testing::TempDir()) / "touchstone-suggested-instrument.json";
  InstrumentDescription instrument;
  instrument.force_noise_N = 0.0125;
  instrument.force_step_N = Vec3(0.003, 0.003, 0.0015);
  instrument.position_noise_m = 4.5e-5;
  instrument.position_rate_Hz = 74.25;
  write_file(file, instrument_to_json(instrument));
  const InstrumentDescription back = load_instrument(file);
  EXPECT_EQ(back.force_noise_N, instrument.force_noise_N);
  EXPECT_EQ(back.force_step_N, instrument.force_step_N);
  EXPECT_EQ(back.position_noise_m, instrument.position_noise_m);
  EXPECT_EQ(back.position_rate_Hz, instrument.position_rate_Hz);
}

}  // namespace
}  // namespace touchstone::discrepancy
