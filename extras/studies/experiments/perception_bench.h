// The validation bench of perception: every metric on presses with planted differences, over stiffnesses, rates, levels
// of noise and seeds. A pair of conditions is clear if its two d' are more than 2 apart; a metric should order it so.
// The d' that a difference should have comes from the judge's own thresholds (planted_cases.h: is the estimator right?)
// or from what published experiments found (published_cases.h: are thresholds, channels and combination right?).
#pragma once

#include <cstdint>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "experiments/planted_cases.h"
#include "harness/report/page.h"
#include "harness/report/provenance.h"

namespace touchstone::experiments {

enum class BenchTruth : unsigned char { thresholds, experiments };

struct PerceptionBenchOptions {
  BenchTruth truth = BenchTruth::thresholds;
  std::uint64_t first_seed = 1;
  std::size_t seeds = 3;
  bool other_metrics = true;  // else the judge alone
};

// One planted case of one setup and seed.
struct BenchedCase {
  PlantedCase planted;
  std::size_t reference = 0;  // which real process it is held against: the published experiment, else 0
  double literature = 0.0;    // d' by the thresholds, or by the experiment
  double d_prime = 0.0;       // judged
  double probability = 0.5;
  double low95 = 0.0;
  double high95 = 0.0;
  bool noticed = false;      // the verdict
  std::vector<double> cost;  // by metric: larger is further from the real process; NaN where undefined
};

struct BenchedRun {
  PlantedSetup setup;
  std::uint64_t seed = 0;
  std::vector<std::string> metrics;  // of BenchedCase::cost; "judge" first
  std::vector<BenchedCase> cases;
};

// How one metric orders the clear pairs.
struct MetricScore {
  std::string metric;
  std::size_t pairs = 0;
  std::size_t right = 0;
  std::size_t undefined = 0;  // neither right nor wrong: the metric has no value; counted as not right
  std::vector<std::pair<std::string, double>> by_family;  // share ordered rightly against repeats, by planted family
};

struct CalibrationBin {
  double from = 0.5;
  double to = 1.0;
  std::size_t cases = 0;
  double stated = 0.0;      // mean probability that the judge states
  double literature = 0.0;  // mean probability by the thresholds
  double simulated = 0.0;   // share of right answers of simulated observers who feel the planted difference
};

struct PerceptionBench {
  PerceptionBenchOptions options;
  std::vector<std::string> metrics;  // "judge" first
  std::vector<BenchedRun> runs;
  std::vector<MetricScore> scores;
  std::size_t below_threshold = 0;  // cases with d' < 0.5
  std::size_t called_indistinguishable = 0;
  std::size_t covered = 0;  // cases whose interval holds the literature's d'
  std::size_t cases = 0;
  std::vector<CalibrationBin> calibration;
  double largest_miscalibration = 0.0;  // over bins of 20 cases or more
};

// Setups that every seed goes through.
std::vector<PlantedSetup> bench_setups(BenchTruth truth = BenchTruth::thresholds);
std::vector<BenchedRun> run_bench_seed(BenchTruth truth, std::uint64_t seed, bool other_metrics,
                                       const std::function<void()>& run_done = {});
// The runs of every seed of `options`, at least one.
PerceptionBench gather_bench(const PerceptionBenchOptions& options, std::vector<BenchedRun> runs);
// One seed after the other, in memory.
PerceptionBench run_perception_bench(const PerceptionBenchOptions& options);

// Runs as JSON, and back: those of one seed, in the order of bench_setups(). Throws BadData for what is none.
nlohmann::ordered_json bench_runs_to_json(const std::vector<BenchedRun>& runs);
std::vector<BenchedRun> bench_runs_from_json(BenchTruth truth, const nlohmann::ordered_json& document);

}  // namespace touchstone::experiments
