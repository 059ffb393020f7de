// Force in free air and on release, hum in the air, and delays: what the presses of one hand give and other hands keep.
#include <gmock/gmock.h>
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

// An offset of the sensor, or a weight, along the direction of pressing: contact begins where the force changes.
TEST(FeltInAir, AnOffsetIsNoContact) {
  for (const double offset_N : {-0.2, 0.1, 0.3}) {
    const auto offset = [offset_N](Recording r) {
      for (Vec3& f : r.f_W_N) f.z() += offset_N;
      return r;
    };
    const PlantedProcess process{.friction = 0.3, .slides = true};
    PlantedProcess hand = process;
    hand.load = 1.4;
    hand.pace = 0.8;
    const RecordingSource again{"again", [&] { return offset(planted(process, 52)); }};
    const RecordingSource same{"same", [&] { return offset(planted(hand, 53)); }};
    const auto judged = judge_conditions(offset(planted(process, 51)), {again}, {same}, Vec3::UnitZ(), {});
    const auto& channels = judged.conditions[0].judgement.channels;
    EXPECT_NE(judged.conditions[0].judgement.verdict, Verdict::noticed) << offset_N;
    EXPECT_TRUE(channels[static_cast<std::size_t>(Channel::position)].known) << offset_N;
    EXPECT_TRUE(channels[static_cast<std::size_t>(Channel::air)].known) << offset_N;
    EXPECT_LT(channels[static_cast<std::size_t>(Channel::position)].jnd, 0.1) << offset_N;
  }
}

// The whole force of a tool that is dragged through oil, and of its mass, beside presses of a hand that moves on in the
// air.
Recording with_tool(const PlantedProcess& process, std::uint64_t seed, double drag_N_s_per_m, double mass_kg) {
  Recording recording = planted(process, seed);
  // The planted hand without its noise of the tracker, smoothed.
  const auto& p = recording.motion.p_W_m;
  const std::vector<Vec3> force = recording.f_W_N;
  for (std::size_t i = 20; i + 20 < recording.size(); ++i) {
    constexpr double step_s = 0.02;
    const Vec3 velocity = (p[i + 10] - p[i - 10]) / step_s;
    const Vec3 acceleration = (p[i + 20] - 2.0 * p[i] + p[i - 20]) / (step_s * step_s);
    recording.f_W_N[i] = force[i] - drag_N_s_per_m * velocity - mass_kg * acceleration;
  }
  return recording;
}

TEST(FeltInAir, DragAndMassOfTheToolAreNamedAndAreNotTheObjects) {
  const PlantedProcess process{.tracker_m = 0.0};
  struct Case {
    double drag_N_s_per_m, mass_kg;
    const char* name;
  };
  for (const Case& own : {Case{12.0, 0.0, "a drag of 12 N s/m"}, Case{0.0, 0.8, "a mass of 0.8"}}) {
    const RecordingSource again{"again", [&] { return planted(process, 62); }};
    const RecordingSource tool{"tool", [&] { return with_tool(process, 63, own.drag_N_s_per_m, own.mass_kg); }};
    const auto judged = judge_conditions(planted(process, 61), {again}, {tool}, Vec3::UnitZ(), {});
    const auto& judgement = judged.conditions[0].judgement;
    const auto& air = judgement.channels[static_cast<std::size_t>(Channel::air)];
    EXPECT_THAT(air.what, ::testing::HasSubstr(own.name));
    EXPECT_EQ(judgement.verdict, Verdict::noticed) << own.name;
    EXPECT_EQ(judgement.gives_away, Channel::air) << own.name;
    for (const Channel c : {Channel::force, Channel::stiffness, Channel::rate, Channel::position})
      EXPECT_LT(judgement.channels[static_cast<std::size_t>(c)].jnd, 0.3) << own.name << " " << name_of(c);
    // The same tool in both, under another hand.
    PlantedProcess hand = process;
    hand.load = 1.3;
    hand.pace = 1.3;
    const RecordingSource twice{"twice", [&] { return with_tool(process, 65, own.drag_N_s_per_m, own.mass_kg); }};
    const RecordingSource other{"other", [&] { return with_tool(hand, 66, own.drag_N_s_per_m, own.mass_kg); }};
    const auto alike =
        judge_conditions(with_tool(process, 64, own.drag_N_s_per_m, own.mass_kg), {twice}, {other}, Vec3::UnitZ(), {});
    EXPECT_NE(alike.conditions[0].judgement.verdict, Verdict::noticed) << own.name;
  }
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
