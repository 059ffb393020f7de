// What a fit says of itself: misfit beyond noise, intervals that hold the truth, motion without its noise.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <utility>
#include <vector>

#include "harness/discrepancy/evidence.h"
#include "harness/discrepancy/misfit.h"
#include "harness/discrepancy/model_edit.h"
#include "harness/discrepancy/parameter_intervals.h"
#include "harness/discrepancy/plane_for_test.h"
#include "harness/discrepancy/smooth_motion.h"

namespace touchstone::discrepancy {
using rendering::Model;

namespace {

Model plane(double stiffness) {
  Model model;
  model.renderer = "plane";
  model.parameters["stiffness_N_per_m"] = stiffness;
  return model;
}

// Blocks on a motion with force noise of a given size and what a model lacks: one more spread per direction.
struct NoisyBlocks {
  PlanePredictor predictor;
  FitData data;

  NoisyBlocks(double unit, double noise_N, const Misfit& lacking, std::uint64_t seed) : predictor(hand(0.0, unit)) {
    const MotionColumns motion = hand(0.0, unit);
    const rendering::Prediction truth = predictor.predict(plane(900.0 / unit));
    data.predictor = &predictor;
    data.blocks = make_blocks(motion, 1.0 / 30.0);
    data.measured_N = block_means(data.blocks, truth.f_W_N);
    const auto normals = block_means(data.blocks, truth.n_W);
    Random random(seed);
    for (std::size_t b = 0; b < data.blocks.size(); ++b) {
      BlockNoise noise;
      noise.n_W = normals[b].norm() > 0.0 ? Vec3(normals[b].normalized()) : Vec3(Vec3::Zero());
      noise.along_normal_N = noise.tangential_N = noise_N;
      const bool free = noise.n_W.isZero();
      const double across = std::hypot(noise_N, free ? lacking.free_N : lacking.tangential_N);
      const double along = std::hypot(noise_N, free ? lacking.free_N : lacking.along_normal_N);
      data.measured_N[b] += Vec3(across * random.normal(), across * random.normal(), along * random.normal());
      data.noise.push_back(noise);
    }
  }
};

TEST(Misfit, IsFoundInTheGroupThatHasItAtEveryUnit) {
  for (const double unit : {1e-3, 1.0, 1e3}) {
    NoisyBlocks blocks(unit, 0.01 * unit, {0.0, 0.0, 0.08 * unit}, 5);
    const Misfit found = estimate_misfit(blocks.data, plane(900.0 / unit));
    EXPECT_NEAR(found.tangential_N / unit, 0.08, 0.012) << unit;
    EXPECT_LT(found.along_normal_N / unit, 0.006) << unit;
    EXPECT_LT(found.free_N / unit, 0.006) << unit;
    // With it, every group's chi-squared comes to its degrees of freedom.
    add_misfit(blocks.data, found);
    const double freedom = 3.0 * static_cast<double>(blocks.data.blocks.size());
    EXPECT_NEAR(chi_squared(blocks.data, plane(900.0 / unit)) / freedom, 1.0, 0.08) << unit;
  }
}

TEST(Misfit, OfAGroupOfAFewBlocksIsThatOfTheOthers) {
  NoisyBlocks blocks(1.0, 0.01, {0.0, 0.1, 0.1}, 6);
  std::size_t free = 0;
  for (std::size_t b = blocks.data.blocks.size(); b-- > 0;) {
    if (!blocks.data.noise[b].n_W.isZero() || ++free <= 3) continue;
    const auto at = static_cast<std::ptrdiff_t>(b);
    blocks.data.blocks.erase(blocks.data.blocks.begin() + at);
    blocks.data.measured_N.erase(blocks.data.measured_N.begin() + at);
    blocks.data.noise.erase(blocks.data.noise.begin() + at);
  }
  const Misfit found = estimate_misfit(blocks.data, plane(900.0));
  EXPECT_DOUBLE_EQ(found.free_N, std::max(found.along_normal_N, found.tangential_N));
}

TEST(Misfit, LeavesTheBetterOfTwoModelsTheLesserDeviance) {
  NoisyBlocks blocks(1.0, 0.01, {}, 7);
  const auto under_own_misfit = [&](double stiffness) {
    FitData data = blocks.data;
    add_misfit(data, estimate_misfit(data, plane(stiffness)));
    return deviance(data, plane(stiffness));
  };
  EXPECT_LT(under_own_misfit(900.0), under_own_misfit(960.0) - 100.0);
  EXPECT_LT(under_own_misfit(960.0), under_own_misfit(1200.0) - 100.0);
}

// Recordings of one damper with noise in force and position, as large as declared or larger: the interval holds the
// truth as often as it says.
class IntervalsUnder : public ::testing::TestWithParam<double> {};

TEST_P(IntervalsUnder, HoldTheTruthInNineOfTenRecordings) {
  InstrumentDescription instrument;
  instrument.force_noise_N = 0.01;
  instrument.force_noise_time_constant_s = 0.01;
  instrument.position_noise_m = 5e-5;
  constexpr double truth_N_s_per_m = 12.0;
  Model truth = plane(900.0);
  truth.effects.push_back({"viscous-friction", {{"coefficient_N_s_per_m", truth_N_s_per_m}}, "/effects/0"});
  const std::vector<FreeParameter> parameters{
      log_base_parameter("stiffness_N_per_m", 90.0, 9000.0),
      linear_parameter("viscous-friction", "coefficient_N_s_per_m", 10.0, 0.0, 200.0)};
  const rendering::MakePredictor make = [](const MotionColumns& motion) {
    return std::make_unique<PlanePredictor>(motion);
  };
  constexpr int recordings = 20;
  int inside = 0;
  double width = 0.0;
  for (int i = 0; i < recordings; ++i) {
    Random random(100 + static_cast<std::uint64_t>(i));
    const MotionColumns path = hand(0.05 * i, 1.0);
    InstrumentDescription real = instrument;
    real.force_noise_N *= GetParam();
    real.position_noise_m *= GetParam();
    recording::Recording recording;
    recording.f_W_N = PlanePredictor(path).predict(truth).f_W_N;
    recording.motion = with_position_noise(path, real, random);
    const auto noise = force_noise(path, real, random);
    for (std::size_t k = 0; k < noise.size(); ++k) recording.f_W_N[k] += noise[k];
    const auto predictor = make(recording.motion);
    NoiseModel model_of_noise(recording.motion, predictor->predict(truth).n_W, instrument, make, 1, 3);
    const Evidence evidence{&recording, predictor.get(), &model_of_noise, {}};
    const FitData data = fit_data(evidence, truth, 1.0 / 30.0);
    const JointFit fit = fit_jointly(data, truth, parameters, 12, true);
    ASSERT_TRUE(fit.ok);
    const auto draws = bootstrap_fits(evidence, data, fit, parameters, 6);
    const Interval interval = interval95(fit, parameters, draws, "viscous-friction", "coefficient_N_s_per_m",
                                         excess_over(draws, fit), noisier_fits(evidence, data, fit, parameters, 6));
    inside += interval.low <= truth_N_s_per_m && truth_N_s_per_m <= interval.high ? 1 : 0;
    width += (interval.high - interval.low) / truth_N_s_per_m / recordings;
  }
  EXPECT_GE(inside, 18);
  EXPECT_LT(width, 0.25 * GetParam() * GetParam());  // and is worth stating
}

INSTANTIATE_TEST_SUITE_P(TimesTheDeclaredNoise, IntervalsUnder, ::testing::Values(1.0, 1.5, 2.0));

// Noise of four times the variance of the acceleration weakens a mass to a fifth, of eight times to a ninth.
TEST(Intervals, ReachTheTruthBeyondAWeakenedValueOfEitherSign) {
  for (const double truth : {0.25, -0.25}) {
    JointFit fit;
    fit.ok = true;
    fit.model.instrument.push_back({"tool-inertia", {{"mass_kg", truth / 5.0}}, ""});
    const std::vector<FreeParameter> parameters{linear_parameter("tool-inertia", "mass_kg", 0.1, -5.0, 5.0)};
    Model noisier = fit.model;
    noisier.instrument.front().parameters["mass_kg"] = truth / 9.0;
    const Interval interval = interval95(fit, parameters, {}, "tool-inertia", "mass_kg", 1.0, {noisier});
    EXPECT_NEAR(truth > 0.0 ? interval.high : -interval.low, 0.25, 1e-12);
    EXPECT_NEAR(truth > 0.0 ? interval.low : -interval.high, 0.05, 1e-12);
    // So much weaker that nothing is known of the size: to twenty times the value.
    noisier.instrument.front().parameters["mass_kg"] = truth / 11.0;
    const Interval open = interval95(fit, parameters, {}, "tool-inertia", "mass_kg", 1.0, {noisier});
    EXPECT_NEAR(truth > 0.0 ? open.high : -open.low, 1.0, 1e-12);
  }
}

// Nine draws in a world whose fits leave a quarter of what the fit leaves: the noise is twice the declared one, its
// spread twice what the draws show, and what it has done to the value four times what noise of the declared size adds
// at noisier positions. A fit that leaves less narrows nothing.
TEST(Intervals, GrowWithWhatTheModelLeavesBeyondTheSimulations) {
  constexpr double value = 20.0, added = 0.3, half_of_nine = 2.306;  // Student's, 8 degrees of freedom
  JointFit fit;
  fit.ok = true;
  fit.model.instrument.push_back({"force-bias", {{"fx_N", value}}, ""});
  const std::vector<FreeParameter> parameters{linear_parameter("force-bias", "fx_N", 1.0, -100.0, 100.0)};
  std::vector<NullFit> draws;
  double squares = 0.0;
  for (int world = 0; world < 9; ++world) {
    const double off = 0.1 * (world - 4);
    squares += off * off;
    Model drawn = fit.model;
    drawn.instrument.front().parameters["fx_N"] = value + off;
    draws.push_back({static_cast<std::size_t>(world), drawn, 100.0});
  }
  Model noisier = fit.model;
  noisier.instrument.front().parameters["fx_N"] = value + added;
  const double deviation = std::sqrt(squares / 8.0 * (1.0 + 1.0 / 9.0));
  for (const auto& [left, excess] : {std::pair(400.0, 4.0), std::pair(100.0, 1.0), std::pair(50.0, 1.0)}) {
    fit.chi_squared = left;
    EXPECT_NEAR(excess_over(draws, fit), excess, 1e-12);
    const Interval interval =
        interval95(fit, parameters, draws, "force-bias", "fx_N", excess_over(draws, fit), {noisier});
    const double half = half_of_nine * std::sqrt(excess) * deviation;
    EXPECT_NEAR(interval.low, value - excess * added - half, 1e-3);
    EXPECT_NEAR(interval.high, value + half, 1e-3);
  }
}

// Thirty-two runs of eight blocks.
std::pair<std::vector<double>, std::vector<double>> runs_that_gain(const std::vector<double>& gains) {
  std::vector<double> before;
  std::vector<double> after;
  for (const double gain : gains) {
    before.insert(before.end(), blocks_in_run, 100.0 + gain / static_cast<double>(blocks_in_run));
    after.insert(after.end(), blocks_in_run, 100.0);
  }
  return {before, after};
}

TEST(Differences, OfRunsWithoutTheirBestAndWorstAreThoseOfTheRest) {
  std::vector<double> gains(32, 10.0);
  for (std::size_t i = 0; i < gains.size(); i += 2) gains[i] = 6.0;
  gains[3] = -400.0;  // one turn of the tip in noise
  const auto [before, after] = runs_that_gain(gains);
  const auto [all, error] = paired_difference(before, after);
  EXPECT_NEAR(all, 16.0 * 6.0 + 15.0 * 10.0 - 400.0, 1e-9);
  EXPECT_LT(all, 0.0);
  // 16 runs of 6 and 14 of 10 are left; Winsor's 32 are 17 of 6 and 15 of 10.
  const auto [trimmed, trimmed_error] = trimmed_difference(before, after);
  EXPECT_NEAR(trimmed, 32.0 * (16.0 * 6.0 + 14.0 * 10.0) / 30.0, 1e-9);
  EXPECT_NEAR(trimmed_error, 32.0 * std::sqrt(17.0 * 15.0 * 16.0 / 32.0 / (30.0 * 29.0)), 1e-9);
  EXPECT_GT(error, 10.0 * trimmed_error);
}

TEST(Differences, OfOneRunThatGainsAllIsNoGainOfTheRest) {
  std::vector<double> gains(32, 0.0);
  gains[7] = 500.0;
  const auto [before, after] = runs_that_gain(gains);
  const auto [gain, error] = trimmed_difference(before, after);
  EXPECT_NEAR(gain, 0.0, 1e-9);
  EXPECT_NEAR(error, 0.0, 1e-9);
}

TEST(Differences, OfFewRunsAreNotTrimmed) {
  const auto [before, after] = runs_that_gain({1.0, 2.0, 3.0, 4.0, 5.0, 6.0, -100.0});
  EXPECT_EQ(trimmed_difference(before, after), paired_difference(before, after));
}

// The corner of the tracker's low-pass, beside a hand's motion, and of a size that is declared a sixth too small.
TEST(TrackerNoise, HasTheCornerThatPositionsShow) {
  for (const double corner : {0.2, 0.25, 0.35, 0.45}) {
    InstrumentDescription real;
    real.position_noise_m = 1e-4;
    real.position_low_pass = corner;
    Random random(4);
    const MotionColumns noisy = with_position_noise(hand(0.0, 1.0), real, random);
    InstrumentDescription declared = real;
    declared.position_low_pass = 0.25;
    EXPECT_NEAR(measured_low_pass(noisy, declared), corner, 0.1 * corner);
    declared.position_noise_m /= 1.2;
    EXPECT_NEAR(measured_low_pass(noisy, declared), corner, 0.2 * corner);
  }
}

TEST(SmoothMotion, TakesMostOfTheNoiseAndLeavesTheMotion) {
  for (const double unit : {1e-3, 1.0, 1e3}) {
    const MotionColumns path = hand(0.0, unit);
    InstrumentDescription instrument;
    instrument.position_noise_m = 1e-4 * unit;
    Random random(9);
    const MotionColumns noisy = with_position_noise(path, instrument, random);
    const MotionColumns smooth = smoothed_motion(noisy, instrument);
    double before = 0.0;
    double after = 0.0;
    for (std::size_t i = 0; i < path.size(); ++i) {
      before += (noisy.p_W_m[i] - path.p_W_m[i]).squaredNorm();
      after += (smooth.p_W_m[i] - path.p_W_m[i]).squaredNorm();
    }
    EXPECT_LT(std::sqrt(after / before), 0.6) << unit;
    instrument.position_noise_m = 0.0;
    EXPECT_EQ(smoothed_motion(noisy, instrument).p_W_m[7], noisy.p_W_m[7]);
  }
}

}  // namespace
}  // namespace touchstone::discrepancy
