// What a repeat of the recording changes in the verdict: every branch, on findings made by hand.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <nlohmann/json.hpp>

#include "harness/discrepancy/findings.h"
#include "harness/discrepancy/time_budget.h"

namespace touchstone::discrepancy {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

// A search that left 0.10 N of 0.40 N held out, where noise gives `goodness` in square.
Findings left_over(double repeat_floor_N, double goodness = 9.0) {
  Findings f;
  f.gap.holdout_before_N = 0.40;
  f.gap.holdout_after_N = 0.10;
  f.gap.noise_floor_N = 0.03;
  f.gap.repeat_floor_N = repeat_floor_N;
  f.search.goodness = goodness;
  f.search.goodness_threshold = 1.5;
  f.search.structured_threshold = 1.5;
  return f;
}

FoundEffect effect(const std::string& name) {
  FoundEffect found;
  found.name = name;
  return found;
}

TEST(FindingsRepeat, AboveTheFloorItIsSaidHowManyTimes) {
  Findings f = left_over(0.05);
  conclude(f, {});
  EXPECT_EQ(f.verdict, FindingsVerdict::unexplained);
  EXPECT_THAT(f.explanation, HasSubstr("0.1 N is 2 times what one recording does not repeat, 0.05 N"));
}

TEST(FindingsRepeat, WithinTheFloorNothingIsMissing) {
  Findings f = left_over(0.12);
  conclude(f, {});
  EXPECT_EQ(f.verdict, FindingsVerdict::consistent);
  EXPECT_THAT(f.explanation,
              HasSubstr("Nothing is missing that this object repeats. The noise of the sensor alone is "
                        "less. The held-out error of 0.1 N is within what one recording does not repeat, 0.12 N."));
  Findings exactly = left_over(0.10);
  conclude(exactly, {});
  EXPECT_EQ(exactly.verdict, FindingsVerdict::consistent);
}

TEST(FindingsRepeat, WithinTheFloorWhatWasFoundExplains) {
  Findings f = left_over(0.12);
  f.search.found = {effect("coulomb-friction")};
  conclude(f, {});
  EXPECT_EQ(f.verdict, FindingsVerdict::explained);
  EXPECT_THAT(f.explanation, HasSubstr("With coulomb-friction nothing is missing that this object repeats."));
}

// A search over many effects that ran out of time says how much it did not try, and names little of it.
TEST(FindingsOfLimitedTime, NameFewOfManyTrials) {
  Findings f = left_over(0.05);
  f.search.time_limit_s = 60.0;
  f.search.not_tried = {"a", "b", "c", "d"};
  Findings many = f;
  for (int i = 0; i < 90; ++i) many.search.not_tried.push_back("trial " + std::to_string(i));
  conclude(f, {});
  EXPECT_THAT(f.explanation, HasSubstr("The time limit of 60 s ended the search: this is the best answer until then; "
                                       "not tried: a, b, c, d."));
  conclude(many, {});
  EXPECT_THAT(many.explanation,
              HasSubstr("not tried: a, b, c, d and 90 more (time_limit.not_tried in findings.json)."));
  EXPECT_THAT(many.explanation, Not(HasSubstr("trial")));
}

// A limit counts from when the files were read; what the answer needs is kept back, of it the values' part until the
// search is over.
TEST(TimeBudget, KeepsBackWhatTheAnswerNeeds) {
  constexpr double limit_s = 1e7, checks_s = 1e6;
  const auto allowed = [](double taken_s, bool values) {
    const auto begin = TimeBudget::Clock::now() - std::chrono::duration<double>(taken_s);
    TimeBudget budget(limit_s, std::chrono::time_point_cast<TimeBudget::Clock::duration>(begin), checks_s);
    if (values) budget.turn_to_values();
    const bool allows = budget.allows("a trial");
    EXPECT_EQ(budget.not_tried().size(), allows ? 0U : 1U);
    return allows;
  };
  EXPECT_TRUE(allowed(7.9e6, false));
  EXPECT_FALSE(allowed(8.1e6, false));
  EXPECT_TRUE(allowed(8.9e6, true));
  EXPECT_FALSE(allowed(9.1e6, true));
}

// An interval of too few simulated recordings would be too narrow: it is open, and the reason is said.
TEST(FindingsOfLimitedTime, LeaveAnIntervalOpenThatTheyCouldNotWorkOut) {
  rendering::Candidate candidate;
  candidate.name = "viscosity";
  candidate.parameters = {{"b", "N s/m", 0.0, 10.0, 0.0, ""}};
  for (const bool cut_short : {false, true}) {
    Findings f = left_over(0.05);
    f.search.found = {effect("viscosity")};
    f.search.model.effects = {{"viscosity", {{"b", 2.0}}, ""}};
    f.search.fit.model = f.search.model;
    f.search.intervals_cut_short = cut_short;
    conclude(f, {candidate});
    const FoundParameter& b = f.parameters.at(0).at(0);
    EXPECT_EQ(b.undetermined.empty(), !cut_short);
    EXPECT_EQ(std::isinf(b.high95), cut_short);
    EXPECT_EQ(b.value, 2.0);
  }
}

// Where a damper passes the tracker's noise on, single samples have their own sentence; without it the error rises.
TEST(FindingsOfMeans, WhatSingleSamplesLeaveIsSaidBeside) {
  Findings f = left_over(0.05, 1.0);
  f.gap.repeat_floor_N.reset();
  f.search.found = {effect("normal-damping")};
  f.gap.means = SingleSamples{8, 0.42, 0.61};
  conclude(f, {});
  EXPECT_EQ(f.verdict, FindingsVerdict::explained);
  EXPECT_THAT(f.explanation, HasSubstr("With it the held-out error falls from 0.4 N to 0.1 N. These errors are of "
                                       "means over 8 samples, as the search saw them. At single samples the error "
                                       "rises from 0.42 N to 0.61 N"));
  const std::string json = findings_to_json(f, "");
  EXPECT_THAT(json, HasSubstr("\"means_over\": 8"));
  EXPECT_THAT(json, HasSubstr("\"single_samples\": {"));
  Findings raised = left_over(0.05, 1.0);
  raised.gap.repeat_floor_N.reset();
  raised.search.found = {effect("normal-damping")};
  raised.gap.holdout_after_N = 0.41;
  conclude(raised, {});
  EXPECT_EQ(raised.verdict, FindingsVerdict::unexplained);
  EXPECT_THAT(raised.explanation, HasSubstr("the error rises from 0.4 N to 0.41 N"));
}

// A verdict that was none of "unexplained" stays as it was.
TEST(FindingsRepeat, WithinTheFloorOtherVerdictsStay) {
  Findings consistent = left_over(0.12, 1.0);
  conclude(consistent, {});
  EXPECT_EQ(consistent.verdict, FindingsVerdict::consistent);
  EXPECT_THAT(consistent.explanation, HasSubstr("as the noise does"));
  EXPECT_THAT(consistent.explanation, HasSubstr("within what one recording does not repeat"));
  Findings explained = left_over(0.12, 1.0);
  explained.search.found = {effect("coulomb-friction")};
  conclude(explained, {});
  EXPECT_EQ(explained.verdict, FindingsVerdict::explained);
  EXPECT_THAT(explained.explanation, HasSubstr("was missing"));
  Findings indistinguishable = left_over(0.12, 1.0);
  indistinguishable.search.found = {effect("coulomb-friction")};
  Rival rival;
  rival.name = "viscous-friction";
  rival.indistinguishable = true;
  indistinguishable.search.found.front().rivals = {rival};
  conclude(indistinguishable, {});
  EXPECT_EQ(indistinguishable.verdict, FindingsVerdict::not_identifiable);
  EXPECT_THAT(indistinguishable.explanation, HasSubstr("within what one recording does not repeat"));
}

TEST(FindingsRepeat, ALineAndAValueHardToBelieveStayOpenWithinTheFloor) {
  Findings line = left_over(0.12, 1.0);
  SpectralPeak peak;
  peak.frequency_Hz = 60.0;
  peak.rms_N = 0.05;
  peak.name = "mains hum";
  line.search.spectrum.peaks = {peak};
  line.search.spectrum.share = 0.5;
  ASSERT_TRUE(line.search.spectrum.peaks_matter());
  conclude(line, {});
  EXPECT_EQ(line.verdict, FindingsVerdict::unexplained);
  EXPECT_THAT(line.explanation, HasSubstr("mains hum of 60"));
  EXPECT_THAT(line.explanation, HasSubstr("within what one recording does not repeat"));
  Findings question = left_over(0.12, 1.0);
  question.search.found = {effect("pre-sliding")};
  question.search.questions = {{"pre-sliding", "it is longer than the tip"}};
  conclude(question, {});
  EXPECT_EQ(question.verdict, FindingsVerdict::unexplained);
  EXPECT_THAT(question.explanation, HasSubstr("A value to question"));
}

TEST(FindingsRepeat, DataThatSeemWrongAreHeldAgainstNothing) {
  for (const double floor_N : {0.05, 0.12}) {
    Findings f = left_over(floor_N);
    f.search.data_fault = "the force pulls.";
    conclude(f, {});
    EXPECT_EQ(f.verdict, FindingsVerdict::unexplained);
    EXPECT_THAT(f.explanation, Not(HasSubstr("repeat")));
  }
}

TEST(FindingsRepeat, WithoutARepeatNothingIsSaidOfOne) {
  Findings f = left_over(0.0);
  f.gap.repeat_floor_N.reset();
  conclude(f, {});
  EXPECT_EQ(f.verdict, FindingsVerdict::unexplained);
  EXPECT_THAT(f.explanation, Not(HasSubstr("repeat")));
  EXPECT_THAT(findings_to_json(f, ""), Not(HasSubstr("repeat_floor")));
}

// A coefficient of 1 N s/m of which the fit's covariance knows the standard deviation.
FoundParameter fitted_coefficient(double deviation, std::string* explanation) {
  const std::string damping = "normal-damping";
  const std::string name = "coefficient_N_s_per_m";
  Findings f = left_over(0.12);
  f.search.found = {effect(damping)};
  f.search.model.effects = {{damping, {{name, 1.0}}, "/found", {}, {}}};
  f.search.fit.model = f.search.model;
  f.search.fit.u = Eigen::VectorXd::Constant(1, 1.0);
  f.search.fit.covariance = Eigen::MatrixXd::Constant(1, 1, deviation * deviation);
  f.search.fit.at_bound = {false};
  f.search.parameters = {linear_parameter(damping, name, 1.0, 0.0, 1e4)};
  conclude(f, {{damping, rendering::Side::contact, {{name, "N s/m", 0.0, 1e4, 0.0, "b"}}}});
  *explanation = f.explanation;
  EXPECT_EQ(
      nlohmann::json::parse(findings_to_json(f, ""))["effects"][0]["parameters"][0].value("may_be_nothing", false),
      f.parameters[0][0].size == FoundParameter::Size::may_be_nothing);
  return f.parameters[0][0];
}

TEST(FindingsIntervals, EndWhereTheValuesDoAndSayThatNothingIsInThem) {
  std::string said;
  const FoundParameter sure = fitted_coefficient(0.1, &said);
  EXPECT_NEAR(sure.low95, 1.0 - 0.196, 1e-3);
  EXPECT_EQ(sure.size, FoundParameter::Size::sure);
  EXPECT_THAT(said, Not(HasSubstr("may be none")));
  const FoundParameter wide = fitted_coefficient(2.0, &said);
  EXPECT_EQ(wide.low95, 0.0);
  EXPECT_NEAR(wide.high95, 1.0 + 3.92, 1e-2);
  EXPECT_EQ(wide.size, FoundParameter::Size::may_be_nothing);
  EXPECT_THAT(said, HasSubstr("normal-damping may be none"));
}

// Where a bump is says nothing of whether there is one.
TEST(FindingsIntervals, APlaceThatIsKnownIsNoSize) {
  Findings f = left_over(0.12);
  f.search.found = {effect("stiffness-map")};
  f.search.model.effects = {{"stiffness-map", {{"amplitude", 0.5}, {"x_m", 0.1}}, "/found", {}, {}}};
  f.search.fit.model = f.search.model;
  f.search.fit.u = Eigen::Vector2d(0.5, 0.1);
  f.search.fit.covariance = Eigen::Vector2d(1.0, 1e-6).asDiagonal();
  f.search.fit.at_bound = {false, false};
  f.search.parameters = {linear_parameter("stiffness-map", "amplitude", 1.0, -1.0, 10.0),
                         linear_parameter("stiffness-map", "x_m", 1.0, -1.0, 1.0)};
  conclude(f, {{"stiffness-map",
                rendering::Side::contact,
                {{"amplitude", "1", -0.99, 100.0, 0.0, "a"}, {"x_m", "m", -1e3, 1e3, 0.0, "place"}}}});
  EXPECT_THAT(f.explanation, HasSubstr("stiffness-map may be none"));
  EXPECT_EQ(f.parameters[0][1].size, FoundParameter::Size::none);
}

}  // namespace
}  // namespace touchstone::discrepancy
