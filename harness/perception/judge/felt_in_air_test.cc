// Force in free air and on release, hum in the air, and delays: what the presses of one hand give and other hands keep.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>

#include "harness/perception/judge/identical_pairs_for_test.h"
#include "harness/perception/judge/judged_conditions.h"

namespace touchstone::perception {
using recording::Recording;

namespace {

using Change = std::function<void(Recording&)>;

Judgement changed(const Change& change, const PlantedProcess& real = {}, std::uint64_t seed = 31) {
  const RecordingSource again{"again", [&] { return planted(real, seed + 1); }};
  const RecordingSource condition{"condition", [&] {
                                    Recording recording = planted(real, seed + 2);
                                    change(recording);
                                    return recording;
                                  }};
  return judge_conditions(planted(real, seed), {again}, {condition}, Vec3::UnitZ(), {}).conditions[0].judgement;
}

// The force that is added over height above the object and speed of leaving.
Change in_air(const std::function<Vec3(double height_m, double leaving_m_per_s, double t)>& force) {
  return [force](Recording& r) {
    for (std::size_t i = 10; i + 10 < r.size(); ++i) {
      const double z = r.motion.p_W_m[i].z();
      if (z <= 0.0) continue;
      const double speed =
          (r.motion.p_W_m[i + 10].z() - r.motion.p_W_m[i - 10].z()) / (r.motion.t_s[i + 10] - r.motion.t_s[i - 10]);
      r.f_W_N[i] += force(z, speed, r.motion.t_s[i]);
    }
  };
}

TEST(FeltInAir, AForceWhereNothingIsTouchedIsNoticed) {
  for (const double side_N : {0.2, 1.5}) {
    const auto judgement = changed(
        in_air([&](double height_m, double, double) { return Vec3(height_m > 0.001 ? side_N : 0.0, 0.0, 0.0); }));
    EXPECT_EQ(judgement.verdict, Verdict::noticed) << side_N;
    EXPECT_EQ(judgement.gives_away, Channel::air) << side_N;
  }
  EXPECT_NE(changed([](Recording&) {}).verdict, Verdict::noticed);
}

TEST(FeltInAir, APullOnReleaseIsNoticed) {
  for (const double pull_N : {0.4, 1.2}) {
    const auto judgement = changed(in_air([&](double height_m, double leaving_m_per_s, double) {
      const bool pulls = height_m < 0.0015 && leaving_m_per_s > 0.0;
      return Vec3(0.0, 0.0, pulls ? -pull_N * (1.0 - height_m / 0.0015) : 0.0);
    }));
    EXPECT_EQ(judgement.verdict, Verdict::noticed) << pull_N << ": d' " << judgement.d_prime;
  }
}

TEST(FeltInAir, AHumInTheAirAndOneEverywhereAreNoticed) {
  const auto hum = [](double t) { return Vec3(0.0, 0.0, 0.05 * std::sin(2.0 * std::numbers::pi * 130.0 * t)); };
  const auto air = changed(in_air([&](double, double, double t) { return hum(t); }));
  EXPECT_EQ(air.verdict, Verdict::noticed);
  EXPECT_EQ(air.gives_away, Channel::vibration);
  const auto everywhere = changed([&](Recording& r) {
    for (std::size_t i = 0; i < r.size(); ++i) r.f_W_N[i] += hum(r.motion.t_s[i]);
  });
  EXPECT_EQ(everywhere.verdict, Verdict::noticed);
  EXPECT_EQ(everywhere.gives_away, Channel::vibration);
}

// A weight in the air that both have is none of the renderer's, whatever the hand.
TEST(FeltInAir, AForceThatBothHaveIsNoDifference) {
  const PlantedProcess process;
  const auto weigh = [](Recording r) {
    for (std::size_t i = 0; i < r.size(); ++i) {
      if (r.motion.p_W_m[i].z() > 0.0) r.f_W_N[i].x() += 0.3;
    }
    return r;
  };
  const RecordingSource condition{"condition", [&] { return weigh(planted(process, 43)); }};
  const RecordingSource again{"again", [&] { return weigh(planted(process, 42)); }};
  const auto judged = judge_conditions(weigh(planted(process, 41)), {again}, {condition}, Vec3::UnitZ(), {});
  EXPECT_NE(judged.conditions[0].judgement.verdict, Verdict::noticed);
}

// The force of `lag` ago, by whole samples.
Judgement late(int samples, double pace) {
  return changed(
      [samples](Recording& r) {
        const auto force = r.f_W_N;
        for (std::size_t i = 0; i < r.size(); ++i)
          r.f_W_N[i] = force[i < static_cast<std::size_t>(samples) ? 0 : i - static_cast<std::size_t>(samples)];
      },
      {.k_N_per_m = 500.0, .tracker_m = 0.0, .rate_Hz = 1000.0, .pace = pace}, 71);
}

// Rank, Shi, Mueller and Hirche (2010): 36 ms are just noticed; every real device has 1 to 2.
TEST(Delay, GrowsWithTheDelayAndIsOneAtItsThreshold) {
  for (const double pace : {0.7, 1.4, 2.8}) {
    double before = 0.0;
    for (const int ms : {0, 1, 2, 3, 4, 5, 9, 18, 36, 54}) {
      const auto judgement = late(ms, pace);
      EXPECT_GE(judgement.d_prime, before - 0.02) << ms << " ms, pace " << pace;
      const double rate = judgement.channels[static_cast<std::size_t>(Channel::rate)].jnd;
      EXPECT_NEAR(rate, ms / 36.0, 0.03 + 0.1 * ms / 36.0) << ms << " ms, pace " << pace;
      EXPECT_LT(judgement.d_prime, ms <= 5 ? 0.5 : 3.0) << ms << " ms, pace " << pace;
      before = judgement.d_prime;
    }
  }
}

}  // namespace
}  // namespace touchstone::perception
