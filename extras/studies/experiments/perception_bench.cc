#include "experiments/perception_bench.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <map>
#include <optional>

#include "experiments/published_cases.h"
#include "harness/base/error.h"
#include "harness/base/in_parallel.h"
#include "harness/base/progress.h"
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

BenchedRun run_setup(const PlantedSetup& setup, std::uint64_t seed, BenchTruth truth, bool other_metrics) {
  BenchedRun run{setup, seed, {"judge"}, {}};
  recording::Recording real;
  std::optional<pc::JudgedProcess> reference;
  std::size_t recorded = 0;
  std::uint64_t stream = 0;
  for (const auto& asked : asked_of(setup, truth)) {
    stop_if_asked();
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
    if (other_metrics) {
      run.metrics.resize(1);
      for (const auto& other : pc::other_metrics(real, recording, Vec3::UnitZ())) {
        run.metrics.push_back(other.name);
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

std::vector<BenchedRun> run_bench_seed(BenchTruth truth, std::uint64_t seed, bool other_metrics,
                                       const std::function<void()>& run_done) {
  const auto setups = bench_setups(truth);
  std::vector<BenchedRun> runs(setups.size());
  const auto run_one = [&](std::size_t i) {
    runs[i] = run_setup(setups[i], seed, truth, other_metrics);
    if (run_done) run_done();
  };
  in_parallel(runs.size(), run_one, 1);
  return runs;
}

PerceptionBench gather_bench(const PerceptionBenchOptions& options, std::vector<BenchedRun> runs) {
  PerceptionBench bench;
  bench.options = options;
  bench.metrics = runs.front().metrics;
  bench.runs = std::move(runs);
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

PerceptionBench run_perception_bench(const PerceptionBenchOptions& options) {
  std::vector<BenchedRun> runs;
  for (std::uint64_t seed = options.first_seed; seed < options.first_seed + options.seeds; ++seed) {
    auto own = run_bench_seed(options.truth, seed, options.other_metrics);
    std::move(own.begin(), own.end(), std::back_inserter(runs));
  }
  return gather_bench(options, std::move(runs));
}

nlohmann::ordered_json bench_runs_to_json(const std::vector<BenchedRun>& runs) {
  const auto number = [](double value) {
    return std::isfinite(value) ? nlohmann::ordered_json(value) : nlohmann::ordered_json();
  };
  nlohmann::ordered_json document = nlohmann::ordered_json::array();
  for (const auto& run : runs) {
    nlohmann::ordered_json cases = nlohmann::ordered_json::array();
    for (const auto& own : run.cases) {
      nlohmann::ordered_json costs = nlohmann::ordered_json::object();
      for (std::size_t m = 0; m < own.cost.size(); ++m) costs[run.metrics[m]] = number(own.cost[m]);
      cases.push_back({{"name", own.planted.name},
                       {"family", own.planted.family},
                       {"reference", own.reference},
                       {"literature_d_prime", own.literature},
                       {"d_prime", own.d_prime},
                       {"d_prime_interval95", {own.low95, own.high95}},
                       {"probability", own.probability},
                       {"noticed", own.noticed},
                       {"costs", costs}});
    }
    document.push_back({{"seed", run.seed},
                        {"stiffness_N_per_m", run.setup.stiffness_N_per_m},
                        {"rate_Hz", run.setup.rate_Hz},
                        {"force_noise_N", run.setup.force_noise_N},
                        {"cases", cases}});
  }
  return document;
}

std::vector<BenchedRun> bench_runs_from_json(BenchTruth truth, const nlohmann::ordered_json& document) {
  const auto setups = bench_setups(truth);
  if (document.size() != setups.size())
    throw BadData(fmt::format("{} runs of a seed, {} were expected", document.size(), setups.size()));
  std::vector<BenchedRun> runs;
  for (std::size_t i = 0; i < setups.size(); ++i) {
    BenchedRun run{setups[i], document[i].at("seed").get<std::uint64_t>(), {}, {}};
    const auto asked = asked_of(setups[i], truth);
    const auto& cases = document[i].at("cases");
    if (cases.size() != asked.size())
      throw BadData(fmt::format("{} cases of a run, {} were expected", cases.size(), asked.size()));
    for (std::size_t c = 0; c < asked.size(); ++c) {
      BenchedCase own;
      own.planted = asked[c].rendered;
      own.reference = asked[c].reference;
      own.literature = asked[c].d_prime;
      own.d_prime = cases[c].at("d_prime").get<double>();
      own.probability = cases[c].at("probability").get<double>();
      own.low95 = cases[c].at("d_prime_interval95").at(0).get<double>();
      own.high95 = cases[c].at("d_prime_interval95").at(1).get<double>();
      own.noticed = cases[c].at("noticed").get<bool>();
      run.metrics.clear();
      for (const auto& [metric, value] : cases[c].at("costs").items()) {
        run.metrics.push_back(metric);
        own.cost.push_back(value.is_null() ? std::nan("") : value.get<double>());
      }
      run.cases.push_back(std::move(own));
    }
    runs.push_back(std::move(run));
  }
  return runs;
}

}  // namespace touchstone::experiments
