// The search on a predictor small enough to know by heart: a plane z = 0, a stiffness, a tangential damper and a bias.
#include "harness/discrepancy/effect_search.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "harness/base/error.h"
#include "harness/discrepancy/catalogue_for_test.h"
#include "harness/discrepancy/findings.h"
#include "harness/discrepancy/plane_for_test.h"
#include "harness/discrepancy/two_recordings_for_test.h"

namespace touchstone::discrepancy {
using recording::Recording;
using rendering::Model;

namespace {

const std::vector<rendering::Candidate> candidates{
    {"viscous-friction",
     rendering::Side::contact,
     {{"coefficient_N_s_per_m", "N s/m", 0.0, 1e4, 0.0, "b"}},
     traits_of("viscous-friction")},
    {"force-bias",
     rendering::Side::instrument,
     {{"fx_N", "N", -1e3, 1e3, 0.0, ""}, {"fy_N", "N", -1e3, 1e3, 0.0, ""}, {"fz_N", "N", -1e3, 1e3, 0.0, ""}},
     traits_of("force-bias")},
};

Model truth(double scale);

struct World {
  double scale;
  InstrumentDescription instrument;
  Recording train;
  Recording holdout;
  Model start;

  World(const Model& truth, double unit) : scale(unit), instrument(small_noise(unit)), start(truth) {
    train = measure(truth, 0.0, 21);
    holdout = measure(truth, 1.1, 22);
    start.effects.clear();
    start.instrument.clear();
    start.parameters["stiffness_N_per_m"] *= 1.08;
  }

  [[nodiscard]] Recording measure(const Model& truth, double phase, std::uint64_t seed) const {
    const MotionColumns path = hand(phase, scale);
    return measured(path, PlanePredictor(path).predict(truth).f_W_N, instrument, seed);
  }

  [[nodiscard]] Findings find(const std::vector<rendering::Candidate>& library = candidates) const {
    const TwoRecordings recordings(train, holdout, instrument, truth(scale), [](const MotionColumns& motion) {
      return std::make_unique<PlanePredictor>(motion);
    });
    Findings findings;
    findings.search = search_effects(recordings.data, start, library, {}, [](const std::string&) {});
    conclude(findings, library);
    return findings;
  }
};

Model truth(double scale) {
  Model model;
  model.renderer = "plane";
  model.parameters["stiffness_N_per_m"] = 900.0 / scale;
  return model;
}

class SearchAtScale : public ::testing::TestWithParam<double> {};

TEST_P(SearchAtScale, NamesNothingWhereNothingIsMissingAndRefitsTheStiffness) {
  const World world(truth(GetParam()), GetParam());
  const Findings findings = world.find();
  EXPECT_EQ(findings.verdict, FindingsVerdict::consistent);
  // Noise in the depth dilutes the slope by up to its variance over the depth's (Fuller, Measurement Error Models,
  // 1987, eq 1.1.6); one tracker sample's variance is the upper bound, since the filter passes less of it.
  double sum = 0.0;
  double squares = 0.0;
  double count = 0.0;
  for (const Vec3& p : world.train.motion.p_W_m) {
    if (p.z() >= 0.0) continue;
    sum += p.z();
    squares += p.z() * p.z();
    count += 1.0;
  }
  const double variance = squares / count - sum * sum / (count * count);
  const double dilution = world.instrument.position_noise_m * world.instrument.position_noise_m / variance;
  const double stiffness = findings.search.model.parameters.at("stiffness_N_per_m") * GetParam();
  EXPECT_GT(stiffness, 900.0 * (1.0 - dilution - 0.003));
  EXPECT_LT(stiffness, 900.0 * 1.003);
  EXPECT_LT(dilution, 0.05);
  EXPECT_LT(findings.search.goodness, 2.0);
}

TEST_P(SearchAtScale, NamesTheDamperWithItsCoefficientInItsInterval) {
  const double b = 4.0 / GetParam();
  Model hidden = truth(GetParam());
  hidden.effects = {{"viscous-friction", {{"coefficient_N_s_per_m", b}}, "/effects/0"}};
  const World world(hidden, GetParam());
  const Findings findings = world.find();
  ASSERT_EQ(findings.verdict, FindingsVerdict::explained);
  ASSERT_EQ(findings.search.found.size(), 1U);
  EXPECT_EQ(findings.search.found[0].name, "viscous-friction");
  const FoundParameter& found = findings.parameters[0][0];
  EXPECT_NEAR(found.value, b, 0.05 * b);
  EXPECT_LT(found.low95, found.value);
  EXPECT_GT(found.high95, found.value);
  // The same search, had the held-out error grown: that is no explanation.
  Findings worse;
  worse.search = findings.search;
  worse.gap.holdout_before_N = 0.218;
  worse.gap.holdout_after_N = 0.281;
  conclude(worse, candidates);
  EXPECT_EQ(worse.verdict, FindingsVerdict::unexplained);
  EXPECT_THAT(worse.explanation, ::testing::HasSubstr("rises from 0.218 N to 0.281 N"));
}

TEST_P(SearchAtScale, NamesTwoAtOnce) {
  Model hidden = truth(GetParam());
  hidden.effects = {{"viscous-friction", {{"coefficient_N_s_per_m", 4.0 / GetParam()}}, "/effects/0"}};
  hidden.instrument = {{"force-bias", {{"fx_N", 0.1}, {"fy_N", -0.05}, {"fz_N", 0.08}}, "/instrument/0"}};
  const Findings findings = World(hidden, GetParam()).find();
  ASSERT_EQ(findings.verdict, FindingsVerdict::explained);
  std::vector<std::string> names;
  for (const auto& found : findings.search.found) names.push_back(found.name);
  EXPECT_THAT(names, ::testing::UnorderedElementsAre("viscous-friction", "force-bias"));
}

INSTANTIATE_TEST_SUITE_P(Units, SearchAtScale, ::testing::Values(1.0, 1e3));

// Forces that no model of the library makes, in the samples of the part.
void spoil(Recording& recording, const Part& part) {
  const auto& t_s = recording.motion.t_s;
  for (std::size_t i = 0; i < recording.size(); ++i) {
    if (part.contains(t_s[i], t_s.front())) recording.f_W_N[i] = -1.7 * recording.f_W_N[i] + Vec3(0.4, t_s[i], 1.0);
  }
}

// What was named, with values and intervals, and the model as it is written.
std::string chosen(const Findings& findings) {
  std::string text = model_to_json(findings.search.model);
  for (std::size_t e = 0; e < findings.search.found.size(); ++e) {
    text += findings.search.found[e].name;
    for (const FoundParameter& p : findings.parameters[e]) {
      text += fmt::format(" {}={} [{}, {}]", p.name, p.value, p.low95, p.high95);
    }
    for (const Rival& rival : findings.search.found[e].rivals)
      text += fmt::format(" {}{}", rival.name, rival.indistinguishable);
  }
  return text;
}

Model with_damper_and_bias() {
  Model hidden = truth(1.0);
  hidden.effects = {{"viscous-friction", {{"coefficient_N_s_per_m", 4.0}}, "/effects/0"}};
  hidden.instrument = {{"force-bias", {{"fx_N", 0.1}, {"fy_N", -0.05}, {"fz_N", 0.08}}, "/instrument/0"}};
  return hidden;
}

TEST(Parts, SpoiltHeldOutForcesChangeNoNameValueOrInterval) {
  World world(with_damper_and_bias(), 1.0);
  const Findings clean = world.find();
  ASSERT_EQ(clean.verdict, FindingsVerdict::explained);
  ASSERT_EQ(clean.search.found.size(), 2U);
  spoil(world.holdout, {});
  const Findings spoilt = world.find();
  EXPECT_EQ(spoilt.verdict, FindingsVerdict::unexplained);  // they are looked at, once
  EXPECT_EQ(chosen(spoilt), chosen(clean));
}

TEST(Parts, SpoiltBlocksThatAreHeldBackFromTheOneRecordingChangeNothingEither) {
  const World world(with_damper_and_bias(), 1.0);
  const Part held_back{{2.0, true}, {}};
  const auto find = [&](const Recording& recording) {
    PlanePredictor predictor(recording.motion);
    const rendering::MakePredictor make = [](const MotionColumns& motion) {
      return std::make_unique<PlanePredictor>(motion);
    };
    NoiseModel noise(recording.motion, predictor.predict(truth(1.0)).n_W, world.instrument, make, 1, 3);
    SearchData data = divide({&recording, &predictor, &noise, {{2.0, false}, {}}},
                             {&recording, &predictor, &noise, held_back}, block_window_s(60.0, recording.motion));
    data.force_floor_N = 0.06;
    data.position_noise_m = world.instrument.position_noise_m;
    Findings findings;
    findings.search = search_effects(data, world.start, candidates, {}, [](const std::string&) {});
    conclude(findings, candidates);
    return findings;
  };
  const Findings clean = find(world.train);
  ASSERT_EQ(clean.search.found.size(), 2U);
  Recording recording = world.train;
  spoil(recording, held_back);
  const Findings spoilt = find(recording);
  EXPECT_EQ(spoilt.verdict, FindingsVerdict::unexplained);
  EXPECT_EQ(chosen(spoilt), chosen(clean));
}

TEST(Parts, AnEffectThatTheHeldOutRecordingContradictsIsSaidToBe) {
  World world(with_damper_and_bias(), 1.0);
  Model without_bias = with_damper_and_bias();
  without_bias.instrument.clear();
  world.holdout = world.measure(without_bias, 1.1, 22);
  const Findings findings = world.find();
  ASSERT_EQ(findings.search.found.size(), 2U);
  for (const FoundEffect& effect : findings.search.found) {
    EXPECT_EQ(effect.contradicted(), effect.name == "force-bias") << effect.name;
  }
  EXPECT_THAT(findings.explanation, ::testing::HasSubstr("contradict force-bias"));
}

TEST(Parts, OfALearntPartEverySampleIsForTrainingOrForValidation) {
  for (const double block_s : {0.0, 0.05, 0.7, 2.0, 6.0}) {
    Recording recording;
    recording.motion = hand(0.0, 1.0);
    const SearchData data = divide({&recording, nullptr, nullptr, {{block_s, false}, {}}}, {}, 0.033);
    double trained = 0.0;
    double validated = 0.0;
    for (const double t_s : recording.motion.t_s) {
      const bool train = data.train.part.contains(t_s, 0.0);
      const bool validation = data.validation.part.contains(t_s, 0.0);
      EXPECT_EQ(train || validation, data.learning.part.contains(t_s, 0.0)) << block_s << " " << t_s;
      EXPECT_FALSE(train && validation) << block_s << " " << t_s;
      trained += train ? 1.0 : 0.0;
      validated += validation ? 1.0 : 0.0;
    }
    EXPECT_NEAR(trained, validated, 0.15 * trained) << block_s;
  }
}

TEST(Search, AForceThatNoCandidateMakesIsUnexplained) {
  const World plain(truth(1.0), 1.0);
  World world = plain;
  for (auto* recording : {&world.train, &world.holdout}) {
    for (std::size_t i = 0; i < recording->size(); ++i) {
      recording->f_W_N[i].y() += 0.3 * std::sin(40.0 * recording->motion.t_s[i]);
    }
  }
  const Findings findings = world.find();
  EXPECT_EQ(findings.verdict, FindingsVerdict::unexplained);
  EXPECT_TRUE(findings.search.found.empty());
}

TEST(Search, WhatTheStartingModelHasIsNotFound) {
  Model hidden = truth(1.0);
  hidden.effects = {{"viscous-friction", {{"coefficient_N_s_per_m", 4.0}}, "/effects/0"}};
  World world(hidden, 1.0);
  world.start.effects = hidden.effects;
  const Findings findings = world.find();
  EXPECT_EQ(findings.verdict, FindingsVerdict::consistent);
  EXPECT_TRUE(findings.search.found.empty());
  ASSERT_EQ(findings.search.model.effects.size(), 1U);
  EXPECT_EQ(findings.search.model.effects[0].parameters.at("coefficient_N_s_per_m"), 4.0);
}

TEST(Search, ForcesInAWrongOrderAreBlamedAndNothingIsNamed) {
  Model hidden = truth(1.0);
  hidden.effects = {{"viscous-friction", {{"coefficient_N_s_per_m", 4.0}}, "/effects/0"}};
  World world(hidden, 1.0);
  for (auto* recording : {&world.train, &world.holdout}) {
    // Runs of 1.1 s, the first last: not a multiple of the motion's periods.
    std::rotate(recording->f_W_N.begin(), recording->f_W_N.begin() + 275, recording->f_W_N.end());
  }
  const Findings findings = world.find();
  EXPECT_EQ(findings.verdict, FindingsVerdict::unexplained);
  EXPECT_TRUE(findings.search.found.empty());
  ASSERT_TRUE(findings.search.data_fault.has_value());
  EXPECT_THAT(findings.explanation, ::testing::HasSubstr("does not follow the position"));
}

TEST(Search, AViscosityThatDrivesTheMotionIsAFaultOfTheData) {
  Model hidden = truth(1.0);
  hidden.effects = {{"viscous-friction", {{"coefficient_N_s_per_m", -5.0}}, "/effects/0"}};
  const Findings findings = World(hidden, 1.0).find();
  EXPECT_EQ(findings.verdict, FindingsVerdict::unexplained);
  EXPECT_TRUE(findings.search.found.empty());
  EXPECT_THAT(findings.search.data_fault.value_or(""), ::testing::HasSubstr("viscosity"));
}

TEST(Search, FindingsDoNotDependOnTheOrderOfTheLibrary) {
  Model hidden = truth(1.0);
  hidden.effects = {{"viscous-friction", {{"coefficient_N_s_per_m", 4.0}}, "/effects/0"}};
  const World world(hidden, 1.0);
  const Findings once = world.find();
  const Findings reversed = world.find({candidates[1], candidates[0]});
  EXPECT_EQ(findings_to_json(once, "").size(), findings_to_json(reversed, "").size());
  ASSERT_EQ(reversed.search.found.size(), 1U);
  EXPECT_EQ(reversed.search.found[0].name, "viscous-friction");
  EXPECT_EQ(reversed.parameters[0][0].value, once.parameters[0][0].value);
}

TEST(Search, AModelWithoutAStiffnessIsRefused) {
  World world(truth(1.0), 1.0);
  world.start.parameters.clear();
  EXPECT_THROW(static_cast<void>(world.find()), BadData);
}

TEST(Blocks, CoverEverySampleOnceAndKeepTheMean) {
  const MotionColumns motion = hand(0.0, 1.0);
  const auto blocks = make_blocks(motion, 0.033);
  std::size_t next = 0;
  for (const ResidualBlock& block : blocks) {
    EXPECT_EQ(block.begin, next);
    EXPECT_GT(block.end, block.begin);
    next = block.end;
  }
  EXPECT_EQ(next, motion.size());
  for (const Vec3& mean : block_means(blocks, std::vector<Vec3>(motion.size(), Vec3(1, 2, 3)))) {
    EXPECT_NEAR((mean - Vec3(1, 2, 3)).norm(), 0.0, 1e-15);
  }
}

TEST(InstrumentNoise, HasTheDeclaredDeviation) {
  InstrumentDescription instrument;
  instrument.force_noise_N = 0.02;
  instrument.force_noise_time_constant_s = 0.01;
  Random random(3);
  const auto noise = force_noise(hand(0.0, 1.0), instrument, random);
  double squares = 0.0;
  for (const Vec3& n : noise) squares += n.squaredNorm() / 3.0;
  // Coloured: about 2.5 samples to an independent one, so a standard error near 2 %.
  EXPECT_NEAR(std::sqrt(squares / static_cast<double>(noise.size())), 0.02, 0.002);
}

TEST(InstrumentNoise, IsEstimatedFromTheAxesThatWereMeasured) {
  Random random(5);
  Recording recording;
  recording.motion = hand(0.0, 1.0);
  for (Vec3& p : recording.motion.p_W_m) p.x() = p.y() = 0.0;
  for (const Vec3& p : recording.motion.p_W_m) {
    recording.f_W_N.emplace_back(0.0, 0.0, 900.0 * std::max(0.0, -p.z()) + 0.02 * random.normal());
  }
  EXPECT_NEAR(estimate_instrument(recording).force_noise_N, 0.02, 0.002);
}

}  // namespace
}  // namespace touchstone::discrepancy
