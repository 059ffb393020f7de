#include "experiments/perception_bench.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <set>

#include "experiments/planted_cases.h"
#include "experiments/published_cases.h"
#include "harness/base/error.h"
#include "harness/perception/judge/judge.h"

namespace touchstone::experiments {
namespace {

namespace pc = perception;

const PlantedCase& planted_named(const std::vector<PlantedCase>& cases, const std::string& name) {
  return *std::find_if(cases.begin(), cases.end(), [&](const auto& c) { return c.name == name; });
}

TEST(PlantedCases, HaveTheLiteraturesDifferenceAndNames) {
  const auto cases = planted_cases();
  std::set<std::string> names;
  for (const auto& c : cases) EXPECT_TRUE(names.insert(c.name).second) << c.name;
  const PlantedSetup setup;
  const pc::Thresholds thresholds;
  const auto d = [&](const std::string& name) {
    return planted_d_prime(planted_named(cases, name), setup, thresholds);
  };
  EXPECT_EQ(d("repeat"), 0.0);
  EXPECT_EQ(d("pressed twice as fast"), 0.0);
  // 3.2 N instead of 4 N: 22 % of the compliance.
  EXPECT_NEAR(d("softer by 20 %"), std::log(1.25) / std::log(1.22), 1e-3);
  EXPECT_NEAR(d("buzz at 200 Hz, 1 of the threshold"), 1.0, 0.02);
  EXPECT_NEAR(d("force turned by 25.6 degrees"), 1.0, 1e-3);
  EXPECT_NEAR(d("contact 12.0 mm late"), 12.0 / 3.0, 1e-9);
  // Of a force of 2.5 N and more 7 % are noticed; the peak of the press does not enter.
  EXPECT_NEAR(d("friction of 0.02"), 0.02 / 0.07, 1e-9);
}

TEST(PlantedCases, RecordingsRepeatToTheBitAndShowWhatIsPlanted) {
  const PlantedSetup setup;
  const auto cases = planted_cases();
  const auto a = record_planted(cases.front(), setup, 5);
  const auto b = record_planted(cases.front(), setup, 5);
  EXPECT_EQ(a.f_W_N, b.f_W_N);
  EXPECT_EQ(a.motion.p_W_m, b.motion.p_W_m);
  const auto sideways = record_planted(planted_named(cases, "5.0 N sideways"), setup, 5);
  // It grows with the depth, as the normal force does: 5 N where that has its peak. The hand may press deeper.
  const auto deepest = std::max_element(sideways.f_W_N.begin(), sideways.f_W_N.end(),
                                        [](const Vec3& l, const Vec3& r) { return l.z() < r.z(); });
  ASSERT_GT(deepest->z(), 0.9 * setup.peak_N);
  EXPECT_NEAR(deepest->y() / deepest->z(), 5.0 / setup.peak_N, 0.01);
}

// The bars of the whole bench on one seed of one setup would be a matter of chance; these are the failures that were
// seen of the metric before.
TEST(PerceptionBench, ABuzzSidewaysForceAndADelayNeverRankBeforeARepeat) {
  PerceptionBenchOptions options;
  options.seeds = 1;
  options.first_seed = 7001;
  options.other_metrics = false;
  const auto bench = run_perception_bench(options);
  ASSERT_EQ(bench.runs.size(), bench_setups().size());
  for (const auto& run : bench.runs) {
    const double repeat = run.cases.front().d_prime;
    for (const auto& own : run.cases) {
      EXPECT_TRUE(std::isfinite(own.d_prime)) << own.planted.name;
      if (own.literature > 3.0) {
        EXPECT_GT(own.d_prime, repeat) << own.planted.name << " k " << run.setup.stiffness_N_per_m << " noise "
                                       << run.setup.force_noise_N;
      }
    }
  }
  EXPECT_GE(static_cast<double>(bench.scores.front().right), 0.99 * static_cast<double>(bench.scores.front().pairs));
  EXPECT_GE(static_cast<double>(bench.called_indistinguishable), 0.95 * static_cast<double>(bench.below_threshold));
}

// The numbers of the abstracts, typed once more: what is planted does not follow the judge's thresholds.
TEST(PublishedCases, PlantWhatTheExperimentsFound) {
  const auto cases = published_cases();
  const auto at = [&](const std::string& name, double times) -> const PublishedCase& {
    return *std::find_if(cases.begin(), cases.end(), [&](const auto& c) {
      return published_experiments()[c.experiment].name == name && c.times == times;
    });
  };
  EXPECT_NEAR(1.0 / (1.0 - at("force", 1.0).rendered.softer), 1.07, 1e-12);
  EXPECT_NEAR(1.0 / (1.0 - at("compliance, any depth", 1.0).rendered.softer), 1.22, 1e-12);
  EXPECT_NEAR(at("friction", 1.0).rendered.friction / at("friction", 0.0).rendered.friction, 1.2, 1e-12);
  EXPECT_NEAR(at("delay of a spring", 1.0).rendered.delay_s, 0.036, 1e-12);
  EXPECT_NEAR(at("place of the surface", 3.0).rendered.late_m, 1.2e-3, 1e-12);
  EXPECT_NEAR(at("strength of vibration", 1.0).d_prime, std::sqrt(2.0) * 0.8193, 1e-3);  // Phi(0.8193) = 0.7937
  EXPECT_EQ(at("force", 1.0).rendered.plateau_N, 5.0);
  for (const auto& own : cases) EXPECT_EQ(own.rendered.family == "repeat", own.times == 0.0) << own.rendered.name;
}

// Differences that people tell apart for certain come before a repeat on every setup. Training seed.
TEST(PerceptionBench, OrdersWhatPublishedExperimentsCallClear) {
  PerceptionBenchOptions options;
  options.truth = BenchTruth::experiments;
  options.seeds = 1;
  options.first_seed = 7001;
  options.other_metrics = false;
  const auto bench = run_perception_bench(options);
  ASSERT_EQ(bench.runs.size(), bench_setups(BenchTruth::experiments).size());
  EXPECT_GT(bench.scores.front().pairs, 40u);
  EXPECT_GE(static_cast<double>(bench.scores.front().right), 0.99 * static_cast<double>(bench.scores.front().pairs));
}

TEST(PerceptionBench, ASeedComesBackFromItsDocument) {
  const auto truth = BenchTruth::experiments;
  const auto runs = run_bench_seed(truth, 7001, true);
  const auto document = bench_runs_to_json(runs);
  const auto back = bench_runs_from_json(truth, nlohmann::ordered_json::parse(document.dump()));
  EXPECT_EQ(bench_runs_to_json(back), document);
  const PerceptionBenchOptions options{.truth = truth};
  const auto was = gather_bench(options, runs);
  const auto is = gather_bench(options, back);
  EXPECT_EQ(is.metrics, was.metrics);
  EXPECT_EQ(is.scores.back().by_family, was.scores.back().by_family);
  EXPECT_EQ(is.largest_miscalibration, was.largest_miscalibration);
  EXPECT_GT(was.largest_miscalibration, 0.0);
  auto short_of_one = document;
  short_of_one.erase(0);
  EXPECT_THROW((void)bench_runs_from_json(truth, short_of_one), BadData);
}

// One and three published differences read as d' 1 and 3 of the experiment's procedure. `compliance, equal depth` is
// the one whose figure is no constant of the judge: what people need there is 14 % more than it predicts from force.
TEST(PerceptionBench, ReadsAPublishedDifferenceAsItsSize) {
  PerceptionBenchOptions options;
  options.truth = BenchTruth::experiments;
  options.seeds = 3;
  options.first_seed = 7101;
  options.other_metrics = false;
  const auto bench = run_perception_bench(options);
  const auto cases = published_cases();
  for (std::size_t c = 0; c < cases.size(); ++c) {
    if (cases[c].times < 1.0) continue;
    double mean = 0.0;
    for (const auto& run : bench.runs) mean += run.cases[c].d_prime / static_cast<double>(bench.runs.size());
    EXPECT_NEAR(mean, cases[c].d_prime, 0.15 * cases[c].d_prime) << cases[c].rendered.name;
  }
}

}  // namespace
}  // namespace touchstone::experiments
