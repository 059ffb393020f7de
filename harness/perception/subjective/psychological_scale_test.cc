#include "harness/perception/subjective/psychological_scale.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <limits>

#include "harness/base/atomic_file.h"
#include "harness/base/error.h"
#include "harness/base/random.h"
#include "harness/perception/subjective/simulated_observer.h"
#include "harness/stats/summary.h"

namespace touchstone::perception {
namespace {

using ::testing::HasSubstr;

const std::vector<std::string> six{"a", "b", "c", "d", "e", "f"};
const std::vector<double> true_distances{0.0, 0.4, 0.9, 1.2, 1.9, 2.4};

// Answers in the exact proportions of a model: `n` repetitions of each ordered pair, rounded nowhere because the wins
// are given as weights of repeated answers.
PairedComparisons proportions(const std::vector<std::vector<int>>& first_wins, int repetitions) {
  PairedComparisons result;
  result.subjects = {"s"};
  for (std::size_t i = 0; i < first_wins.size(); ++i) {
    result.conditions.push_back(std::string(1, static_cast<char>('a' + i)));
    for (std::size_t j = 0; j < first_wins.size(); ++j) {
      if (i == j) continue;
      for (int r = 0; r < repetitions; ++r) result.answers.push_back({0, i, j, r < first_wins[i][j]});
    }
  }
  return result;
}

TEST(BradleyTerry, TwoConditionsHaveAClosedForm) {
  // a first: a wins 80 of 100; b first: b wins 40 of 100. logit .8 = d + g, logit .4 = -d + g.
  const auto scale = bradley_terry(proportions({{0, 80}, {40, 0}}, 100));
  const double up = std::log(0.8 / 0.2);
  const double down = std::log(0.4 / 0.6);
  EXPECT_NEAR(scale.value[0] - scale.value[1], 0.5 * (up - down), 1e-9);
  EXPECT_NEAR(scale.order_effect, 0.5 * (up + down), 1e-9);
  EXPECT_NEAR(scale.misfit, 0.0, 1e-9);  // two answers, two parameters
  EXPECT_EQ(scale.degrees_of_freedom, 0.0);
  EXPECT_TRUE(scale.standard_error.empty());  // one subject cannot be left out
}

TEST(BradleyTerry, TheScoreVanishesAtTheMaximum) {
  const auto answers = simulate_answers(six, true_distances, 40, {1.0, 0.0, 0.3, 0.0}, 11);
  const auto scale = bradley_terry(answers);
  EXPECT_THAT(scale.remark, "");
  // Likelihood equations: every condition wins as often as the model expects, and so does what comes first.
  std::vector<double> expected(6, 0.0);
  std::vector<double> won(6, 0.0);
  double first_expected = 0.0;
  double first_won = 0.0;
  for (const auto& a : answers.answers) {
    const double p = 1.0 / (1.0 + std::exp(-(scale.value[a.first] - scale.value[a.second] + scale.order_effect)));
    expected[a.first] += p;
    expected[a.second] += 1.0 - p;
    won[a.first_chosen ? a.first : a.second] += 1.0;
    first_expected += p;
    first_won += a.first_chosen ? 1.0 : 0.0;
  }
  for (std::size_t i = 0; i < 6; ++i) EXPECT_NEAR(expected[i], won[i], 1e-7);
  EXPECT_NEAR(first_expected, first_won, 1e-7);
  EXPECT_NEAR(stats::mean(scale.value), 0.0, 1e-12);
}

TEST(Scales, RecoverTheSimulatedDistancesAndTheOrderEffect) {
  // Thurstone's unit is the standard deviation of one difference: sqrt(2) of the noise of one felt distance.
  const double noise = 1.0 / std::sqrt(2.0);
  const auto answers = simulate_answers(six, true_distances, 400, {noise, 0.0, 0.25, 0.0}, 5);
  const auto thurstone = thurstone_case_v(answers);
  const auto terry = bradley_terry(answers);
  for (std::size_t i = 1; i < 6; ++i) {
    const double reach = 4.0 * std::hypot(thurstone.standard_error[i], thurstone.standard_error[0]) + 0.04;
    EXPECT_NEAR(thurstone.value[0] - thurstone.value[i], true_distances[i], reach);
    EXPECT_LT(terry.value[i], terry.value[i - 1]);
    // The logistic is close to the normal of 1.7 times the scale, not equal.
    EXPECT_NEAR(terry.value[0] - terry.value[i], 1.7 * true_distances[i], 0.25 + 0.1 * true_distances[i]);
  }
  EXPECT_NEAR(terry.order_effect, 1.7 * 0.25, 4.0 * terry.order_effect_error + 0.03);
  EXPECT_GT(terry.order_effect, 5.0 * terry.order_effect_error);
  EXPECT_GT(terry.misfit_p, 1e-4);
}

TEST(Scales, TheJackknifeTellsTheSpreadOverRepetitions) {
  std::vector<double> values;
  std::vector<double> errors;
  for (std::uint64_t seed = 0; seed < 60; ++seed) {
    const auto scale = bradley_terry(simulate_answers(six, true_distances, 20, {1.0, 0.0, 0.0, 0.2}, 100 + seed));
    values.push_back(scale.value[0]);
    errors.push_back(scale.standard_error[0]);
  }
  const double spread = stats::standard_deviation(values);
  EXPECT_GT(stats::mean(errors), 0.7 * spread);
  EXPECT_LT(stats::mean(errors), 1.4 * spread);
}

TEST(Scales, AMisfitIsNoticed) {
  // a beats b, b beats c, c beats a, nearly always: no scale describes that.
  const auto circle = proportions({{0, 19, 1}, {1, 0, 19}, {19, 1, 0}}, 20);
  EXPECT_LT(bradley_terry(circle).misfit_p, 1e-6);
  EXPECT_LT(thurstone_case_v(circle).misfit_p, 1e-6);
}

// Whichever of the two always wins; and one win of twenty is none of it.
TEST(Scales, OnlyUnanimousPairsAreCalledSo) {
  EXPECT_THAT(thurstone_case_v(proportions({{0, 20}, {0, 0}}, 20)).remark, ::testing::HasSubstr("unanimous"));
  EXPECT_THAT(thurstone_case_v(proportions({{0, 0}, {20, 0}}, 20)).remark, ::testing::HasSubstr("unanimous"));
  EXPECT_THAT(thurstone_case_v(proportions({{0, 1}, {20, 0}}, 20)).remark, "");
  EXPECT_THAT(thurstone_case_v(proportions({{0, 19}, {0, 0}}, 20)).remark, "");
}

TEST(Scales, UnanimousAnswersStayFiniteAndSaySo) {
  const auto sure =
      simulate_answers({"x", "y", "z"}, std::vector<double>{0.0, 50.0, 100.0}, 5, {1.0, 0.0, 0.0, 0.0}, 1);
  for (const auto& scale : {bradley_terry(sure), thurstone_case_v(sure)}) {
    EXPECT_FALSE(scale.remark.empty());
    for (const double value : scale.value) EXPECT_TRUE(std::isfinite(value));
    EXPECT_TRUE(scale.value[0] > scale.value[1] && scale.value[1] > scale.value[2]);
  }
  EXPECT_THAT(sure.fraction_preferred(), ::testing::ElementsAre(1.0, 0.5, 0.0));
}

TEST(Scales, ConditionsThatWereNeverComparedHaveNoScale) {
  PairedComparisons islands{
      {"a", "b", "c", "d"}, {"s"}, {{0, 0, 1, true}, {0, 1, 0, true}, {0, 2, 3, true}, {0, 3, 2, true}}};
  EXPECT_THROW(bradley_terry(islands), BadData);
  EXPECT_THROW(thurstone_case_v(islands), BadData);
  islands.answers.push_back({0, 1, 2, true});
  EXPECT_NO_THROW(bradley_terry(islands));           // connected by way of b and c
  EXPECT_THROW(thurstone_case_v(islands), BadData);  // a and c were still not compared
}

TEST(Scales, TheCurveGoesThroughTheFittedFractions) {
  const auto answers = simulate_answers(six, true_distances, 200, {1.0, 0.0, 0.0, 0.0}, 21);
  const auto fractions = answers.fraction_preferred();
  const auto scale = bradley_terry(answers);
  for (std::size_t i = 0; i < 6; ++i) {
    // For balanced orders the likelihood equations make the expected fraction the observed one.
    EXPECT_NEAR(expected_fraction_of(scale, i), fractions[i], 1e-6);
  }
  EXPECT_LT(expected_fraction(scale, -50.0), 1e-6);
  EXPECT_GT(expected_fraction(scale, 50.0), 1.0 - 1e-6);
}

TEST(CircularTriads, KnownCounts) {
  // Transitive: none. A full circle of three: one, as many as there can be.
  const auto transitive =
      simulate_answers({"x", "y", "z"}, std::vector<double>{0, 50, 100}, 1, {1.0, 0.0, 0.0, 0.0}, 1);
  EXPECT_EQ(circular_triads(transitive)[0].complete_rounds, 2u);
  EXPECT_EQ(circular_triads(transitive)[0].triads, 0.0);
  EXPECT_EQ(circular_triads(transitive)[0].consistence, 1.0);
  const PairedComparisons circle{{"x", "y", "z"}, {"s"}, {{0, 0, 1, true}, {0, 1, 2, true}, {0, 2, 0, true}}};
  EXPECT_EQ(circular_triads(circle)[0].triads, 1.0);
  EXPECT_EQ(circular_triads(circle)[0].consistence, 0.0);
  // Guessing: the expected number of circular triads is a quarter of all triads (Kendall and Babington Smith).
  const auto guesses = simulate_answers(six, std::vector<double>(6, 1.0), 400, {1.0, 1e9, 0.0, 0.0}, 9);
  double sum = 0.0;
  for (const auto& own : circular_triads(guesses)) sum += own.triads / 400.0;
  EXPECT_NEAR(sum, 20.0 / 4.0, 0.25);
  const PairedComparisons partial{{"x", "y", "z"}, {"s"}, {{0, 0, 1, true}}};
  EXPECT_EQ(circular_triads(partial)[0].complete_rounds, 0u);
  EXPECT_TRUE(std::isnan(circular_triads(partial)[0].consistence));
}

TEST(SimulatedObserver, AJustNoticeableDifferenceMakesGuesses) {
  const std::vector<std::string> two{"near", "far"};
  const std::vector<double> distances{0.0, 0.5};
  const auto fraction = [&](double jnd, std::uint64_t seed) {
    return simulate_answers(two, distances, 2000, {0.01, jnd, 0.0, 0.0}, seed).fraction_preferred()[0];
  };
  EXPECT_EQ(fraction(0.0, 1), 1.0);
  EXPECT_NEAR(fraction(1.0, 1), 0.5, 4.0 * 0.5 / std::sqrt(4000.0));
  const auto once = simulate_answers(two, distances, 3, {1.0, 0.1, 0.0, 0.1}, 7);
  const auto again = simulate_answers(two, distances, 3, {1.0, 0.1, 0.0, 0.1}, 7);
  EXPECT_EQ(format_answers(once), format_answers(again));
}

class Answers : public ::testing::Test {
 protected:
  std::filesystem::path write(const std::string& text) const {
    auto file = std::filesystem::path(::testing::TempDir()) /
                (std::string("answers-") + ::testing::UnitTest::GetInstance()->current_test_info()->name() + ".csv");
    write_file(file, text);
    return file;
  }
  std::string refused(const std::string& text) const {
    try {
      read_answers(write(text), {"a", "b"});
    } catch (const BadData& error) {
      return error.what();
    }
    return "no error";
  }
};

TEST_F(Answers, GoRoundThroughTheFile) {
  const auto answers = simulate_answers(six, true_distances, 3, {1.0, 0.0, 0.0, 0.0}, 3);
  const auto read = read_answers(write(format_answers(answers)));
  EXPECT_EQ(format_answers(read), format_answers(answers));
  EXPECT_EQ(read.wins(), answers.wins());
  EXPECT_EQ(read.answers.size(), 3u * 30u);
}

TEST_F(Answers, SaysFileLineAndValue) {
  const std::string header = "subject,first,second,chosen\n";
  EXPECT_THAT(refused("who,first,second,chosen\n"), HasSubstr(":1: the header is"));
  EXPECT_THAT(refused(header + "s,a,b,a\ns,a,b,c\n"), HasSubstr(":3: 'c' was chosen, which is neither 'a' nor 'b'"));
  EXPECT_THAT(refused(header + "s,a,a,a\n"), HasSubstr("compared with itself"));
  EXPECT_THAT(refused(header + "s,a,c,a\n"), HasSubstr("'c' is no condition"));
  EXPECT_THAT(refused(header + "s,a,b\n"), HasSubstr("3 cells"));
  EXPECT_THAT(refused(header + ",a,b,a\n"), HasSubstr("column 1 is empty"));
  EXPECT_THAT(refused(header), HasSubstr("no answers"));
  EXPECT_THAT(refused(header + "s,a,b,a\r\n"), "no error");
}

}  // namespace
}  // namespace touchstone::perception
