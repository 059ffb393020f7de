// One surface recorded by a hand that presses twice as hard or twice as fast: what rings, blows and pulls goes with the
// hand.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "harness/perception/judge/growth.h"
#include "harness/perception/judge/identical_pairs_for_test.h"
#include "harness/perception/judge/judged_conditions.h"

namespace touchstone::perception {
namespace {

using ::testing::HasSubstr;

Judgement judged_again(const PlantedProcess& real, const PlantedProcess& other, std::uint64_t seed) {
  const RecordingSource again{"again", [&] { return planted(real, seed + 1); }};
  const RecordingSource condition{"condition", [&] { return planted(other, seed + 2); }};
  return judge_conditions(planted(real, seed), {again}, {condition}, Vec3::UnitZ(), {}).conditions[0].judgement;
}

PlantedProcess by(PlantedProcess process, double load, double pace) {
  process.load = load;
  process.pace = pace;
  return process;
}

TEST(OtherHand, OneSurfacePressedHarderOrFasterIsNotNoticed) {
  int noticed = 0;
  int pairs = 0;
  for (const double noise_N : {0.001, 0.005}) {
    for (PlantedProcess surface : {PlantedProcess{.ring_N_s_per_m = 4.0}, PlantedProcess{.damping_N_s_per_m = 15.0},
                                   PlantedProcess{.damping_N_s_per_m = 30.0}, PlantedProcess{.hum_N = 0.02}}) {
      surface.noise_N = noise_N;
      for (const auto& [load, pace] : {std::pair{2.0, 1.0}, std::pair{1.0, 2.0}, std::pair{1.0, 0.5}}) {
        for (std::uint64_t seed = 41000; seed < 41050; seed += 10) {
          const auto judgement = judged_again(surface, by(surface, load, pace), seed);
          ++pairs;
          if (judgement.verdict != Verdict::noticed) continue;
          ++noticed;
          std::cout << "ring " << surface.ring_N_s_per_m << " damping " << surface.damping_N_s_per_m << " hum "
                    << surface.hum_N << " load " << load << " pace " << pace << " seed " << seed << ": "
                    << judgement.d_prime << '\n';
        }
      }
    }
  }
  EXPECT_LE(noticed, pairs / 20) << pairs << " pairs";
}

TEST(OtherHand, AMissingRingIsNoticedAllTheSame) {
  for (const double load : {1.0, 2.0}) {
    for (std::uint64_t seed = 42000; seed < 42030; seed += 10) {
      const auto judgement = judged_again({.ring_N_s_per_m = 4.0}, by({}, load, 1.0), seed);
      EXPECT_EQ(judgement.verdict, Verdict::noticed) << load << " " << seed;
      EXPECT_EQ(judgement.gives_away, Channel::transient);
    }
  }
}

TEST(OtherHand, SaysAtWhichSpeedsContactsWouldTell) {
  const PlantedProcess ring{.ring_N_s_per_m = 4.0, .noise_N = 0.001};
  const auto judgement = judged_again(ring, by(ring, 2.0, 1.0), 43000);
  ASSERT_EQ(judgement.verdict, Verdict::cannot_tell);
  EXPECT_THAT(judgement.open, HasSubstr("transient may differ"));
  EXPECT_THAT(judgement.open, HasSubstr("meet the object at like speeds"));
  EXPECT_THAT(judgement.open, HasSubstr("By the other channels: not-noticed"));
}

TEST(Growth, IsTheLawWhereSpeedsAgreeAndWideWhereTheyDoNot) {
  const auto same = growth_bounds(1.0, 2.0);
  EXPECT_EQ(same.least, 1.0);
  EXPECT_EQ(same.most, 1.0);
  const auto twice = growth_bounds(2.0, 2.0);
  EXPECT_DOUBLE_EQ(twice.by_law, 4.0);
  EXPECT_DOUBLE_EQ(twice.least, 1.0);
  EXPECT_DOUBLE_EQ(twice.most, 1024.0);
  const auto half = growth_bounds(0.5, 2.0);
  EXPECT_DOUBLE_EQ(half.most, 1.0);
  EXPECT_DOUBLE_EQ(half.least, 1.0 / 1024.0);
  const auto near = growth_bounds(1.05, 2.0);
  EXPECT_NEAR(near.most / near.least, 1.0, 0.05);
}

}  // namespace
}  // namespace touchstone::perception
