#include "experiments/perception_bench.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <mutex>
#include <optional>

#include "experiments/published_cases.h"
#include "harness/base/in_parallel.h"
#include "harness/perception/judge/forced_choice.h"
#include "harness/perception/judge/judged_conditions.h"

namespace touchstone::experiments {
namespace {

namespace pc = perception;

constexpr double clear = 2.0;
constexpr double below = 0.5;
constexpr std::size_t trials = 200;
constexpr std::size_t fewest_in_bin = 20;

// A condition, what it is held against, and the answer.
struct Asked {
  std::size_t reference = 0;
  PlantedCase real;
  PlantedCase rendered;
  double d_prime = 0.0;
  void (*setting)(pc::Thresholds&) = nullptr;  // of the published experiment
};

std::vector<Asked> asked_of(const PlantedSetup& setup, BenchTruth truth) {
  std::vector<Asked> asked;
  if (truth == BenchTruth::experiments) {
    for (const auto& own : published_cases()) {
      const auto& experiment = published_experiments()[own.experiment];
      asked.push_back({own.experiment, experiment.real, own.rendered, own.d_prime, experiment.setting});
    }
    return asked;
  }
  for (const auto& planted : planted_cases()) {
    // A buzz above half the rate is another buzz once sampled.
    if (planted.buzz_Hz > 0.45 * setup.rate_Hz) continue;
    asked.push_back({0, {}, planted, planted_d_prime(planted, setup, pc::Thresholds{})});
  }
  return asked;
}

constexpr std::uint64_t streams = 1000;         // of a seed
constexpr std::uint64_t first_reference = 900;  // streams from here on are those of further real processes

BenchedRun run_setup(const PlantedSetup& setup, std::uint64_t seed, const PerceptionBenchOptions& bench,
                     std::vector<std::string>& metrics) {
  BenchedRun run;
  run.setup = setup;
  run.seed = seed;
  recording::Recording real;
  std::optional<pc::JudgedProcess> reference;
  std::size_t recorded = 0;
  std::uint64_t stream = 0;
  metrics = {"judge"};
  for (const auto& asked : asked_of(setup, bench.truth)) {
    pc::JudgeOptions options;
    if (asked.setting != nullptr) asked.setting(options.thresholds);
    if (!reference || recorded != asked.reference) {
      recorded = asked.reference;
      real = record_planted(asked.real, setup, seed * streams + (recorded == 0 ? 0 : first_reference + recorded));
      reference = pc::judged_process(pc::felt_series(real, Vec3::UnitZ()), options.thresholds);
    }
    const recording::Recording recording = record_planted(asked.rendered, setup, seed * streams + ++stream);
    const auto process = pc::judged_process(pc::felt_series(recording, Vec3::UnitZ()), options.thresholds, &*reference);
    const auto judgement = pc::judge(*reference, process, {}, options);
    BenchedCase own;
    own.planted = asked.rendered;
    own.reference = asked.reference;
    own.literature = asked.d_prime;
    own.d_prime = judgement.d_prime;
    own.probability = judgement.noticed_probability;
    own.low95 = judgement.d_prime_low95;
    own.high95 = judgement.d_prime_high95;
    own.noticed = judgement.verdict == pc::Verdict::noticed;
    own.cost.push_back(judgement.d_prime);
    if (bench.other_metrics) {
      metrics.resize(1);
      for (const auto& other : pc::other_metrics(real, recording, Vec3::UnitZ())) {
        metrics.push_back(other.name);
        const double value = other.value.value_or(std::numeric_limits<double>::quiet_NaN());
        own.cost.push_back(other.larger_is_better ? -value : value);
      }
    }
    run.cases.push_back(std::move(own));
  }
  return run;
}

MetricScore score_of(const PerceptionBench& bench, std::size_t metric) {
  MetricScore score;
  score.metric = bench.metrics[metric];
  std::map<std::string, std::pair<double, double>> families;  // right, pairs
  for (const auto& run : bench.runs) {
    for (const auto& near : run.cases) {
      for (const auto& far : run.cases) {
        if (near.reference != far.reference || !(far.literature - near.literature > clear)) continue;
        ++score.pairs;
        const double a = near.cost[metric];
        const double b = far.cost[metric];
        const bool known = std::isfinite(a) && std::isfinite(b);
        const bool right = known && a < b;
        score.right += right ? 1 : 0;
        score.undefined += known ? 0 : 1;
        if (near.planted.family != "repeat") continue;
        auto& [rights, pairs] = families[far.planted.family];
        rights += right ? 1.0 : 0.0;
        pairs += 1.0;
      }
    }
  }
  for (const auto& [family, counts] : families) score.by_family.emplace_back(family, counts.first / counts.second);
  return score;
}

void calibrate(PerceptionBench& bench) {
  constexpr double bin_width = 0.1;
  for (int b = 0; b < 5; ++b) {
    CalibrationBin bin;
    bin.from = 0.5 + bin_width * b;
    bin.to = bin.from + bin_width;
    std::uint64_t seed = 0;
    for (const auto& run : bench.runs) {
      for (const auto& own : run.cases) {
        ++seed;
        const bool inside = own.probability >= bin.from && (own.probability < bin.to || b == 4);
        if (!inside) continue;
        ++bin.cases;
        bin.stated += own.probability;
        bin.literature += pc::forced_choice_probability(own.literature);
        const double evidence[] = {own.literature};
        bin.simulated += pc::simulated_forced_choice(evidence, trials, run.seed * 100000 + seed);
      }
    }
    if (bin.cases > 0) {
      for (double* sum : {&bin.stated, &bin.literature, &bin.simulated}) *sum /= static_cast<double>(bin.cases);
    }
    if (bin.cases >= fewest_in_bin)
      bench.largest_miscalibration = std::max(bench.largest_miscalibration, std::abs(bin.stated - bin.simulated));
    bench.calibration.push_back(bin);
  }
}

}  // namespace

std::vector<PlantedSetup> bench_setups(BenchTruth truth) {
  std::vector<PlantedSetup> setups;
  if (truth == BenchTruth::experiments) {
    for (const double stiffness : {200.0, 500.0, 2000.0}) {
      PlantedSetup setup;
      setup.stiffness_N_per_m = stiffness;
      setup.force_noise_N = 0.0005;
      setup.peak_N = 8.0;  // in the range of the experiments on force
      setups.push_back(setup);
    }
    return setups;
  }
  for (const double stiffness : {200.0, 500.0, 2000.0}) {
    for (const double noise : {0.0005, 0.002}) {
      PlantedSetup setup;
      setup.stiffness_N_per_m = stiffness;
      setup.force_noise_N = noise;
      setups.push_back(setup);
    }
  }
  for (const double rate : {2000.0, 4000.0}) {
    PlantedSetup setup;
    setup.rate_Hz = rate;
    setup.force_noise_N = 0.001;
    setups.push_back(setup);
  }
  // The noise of a common six-axis sensor: vibration at threshold drowns in it.
  PlantedSetup noisy;
  noisy.force_noise_N = 0.005;
  setups.push_back(noisy);
  return setups;
}

std::size_t bench_runs(const PerceptionBenchOptions& options) {
  return bench_setups(options.truth).size() * options.seeds;
}

PerceptionBench run_perception_bench(const PerceptionBenchOptions& options,
                                     const std::function<void(std::size_t done)>& progress) {
  PerceptionBench bench;
  bench.options = options;
  const auto setups = bench_setups(options.truth);
  bench.runs.resize(bench_runs(options));
  std::mutex mutex;
  std::size_t done = 0;
  const auto run_one = [&](std::size_t i) {
    std::vector<std::string> metrics;
    bench.runs[i] = run_setup(setups[i % setups.size()], options.first_seed + i / setups.size(), options, metrics);
    const std::scoped_lock lock(mutex);
    bench.metrics = metrics;
    if (progress) progress(++done);
  };
  in_parallel(bench.runs.size(), run_one, 1);
  for (std::size_t m = 0; m < bench.metrics.size(); ++m) bench.scores.push_back(score_of(bench, m));
  for (const auto& run : bench.runs) {
    for (const auto& own : run.cases) {
      ++bench.cases;
      bench.covered += own.low95 <= own.literature && own.literature <= own.high95 ? 1 : 0;
      if (own.literature >= below) continue;
      ++bench.below_threshold;
      bench.called_indistinguishable += own.noticed ? 0 : 1;
    }
  }
  calibrate(bench);
  return bench;
}

}  // namespace touchstone::experiments
