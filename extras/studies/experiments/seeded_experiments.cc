#include "experiments/seeded_experiments.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "experiments/scan_pages.h"
#include "experiments/spring_seed.h"

namespace touchstone::experiments {
namespace {

template <class Finding>
std::vector<std::string> statements(const std::vector<Finding>& findings) {
  std::vector<std::string> texts;
  texts.reserve(findings.size());
  for (const auto& own : findings) texts.push_back(own.statement);
  return texts;
}

template <class Finding>
std::vector<bool> held(const std::vector<Finding>& findings) {
  std::vector<bool> all;
  all.reserve(findings.size());
  for (const auto& own : findings) all.push_back(own.holds);
  return all;
}

template <class Value>
void append(std::vector<Value>& all, const std::vector<Value>& more) {
  all.insert(all.end(), more.begin(), more.end());
}

std::vector<std::string> words(const std::string& name, std::uint64_t first_seed, std::uint64_t seeds) {
  return {"experiment", name, "--seed", fmt::format("{}", first_seed), "--seeds", fmt::format("{}", seeds)};
}

// The parts of a seed of the perception experiment, by their keys in its document.
constexpr std::array<std::pair<BenchTruth, const char*>, 2> bench_truths{
    {{BenchTruth::thresholds, "thresholds"}, {BenchTruth::experiments, "experiments"}}};

// An experiment without numbers: the statements do not depend on them.
VoxelExperiment voxel_without_numbers() {
  VoxelExperiment e;
  for (const auto& [renderer, resolution] : {std::pair{"god-object", 0}, {"voxel", 32}, {"voxel", 64}}) {
    e.rows.emplace_back();
    e.rows.back().renderer = renderer;
    e.rows.back().resolution = resolution;
  }
  return e;
}

DensityExperiment density_without_numbers() { return {0, std::vector<DensityPoint>(published_density.size())}; }

// Of both commands, experiment 3 first.
std::vector<std::string> density_statements() {
  auto all = statements(density_findings(density_without_numbers()));
  append(all, statements(shading_findings(density_without_numbers())));
  return all;
}

constexpr std::array voxel_values{": RMS force error [N]", ": own part [N]", ": operations per step"};

std::vector<double> voxel_numbers(const VoxelExperiment& e) {
  std::vector<double> values;
  for (const VoxelRow& row : e.rows) {
    if (row.renderer == "voxel-sparse") continue;  // the same forces to the bit
    append<double>(values, {row.rms_N, row.own_rms_N, row.operations ? row.operations->mean : std::nan("")});
  }
  return values;
}

std::vector<double> friction_numbers(const FrictionExperiment& e) {
  std::vector<double> values;
  for (const FrictionFit& fit : e.fits) {
    for (const FrictionAtStiffness* const probe : {&fit.soft, &fit.stiff})
      append<double>(values, {probe->fitted_mu, probe->without.mean_N, probe->with.mean_N});
    append<double>(values, {fit.estimate.mu, fit.estimate.standard_error});
  }
  return values;
}

}  // namespace

SeededExperiment seeded_voxel(const VoxelExperimentOptions& options, std::uint64_t seeds) {
  SeededExperiment own;
  own.name = "voxel";
  own.settings = fmt::format(R"({{"triangles":{},"resolutions":[{}],"reach_m":{}}})", options.triangles,
                             fmt::join(options.resolutions, ","), options.reach_m);
  own.first_seed = options.seed;
  own.seeds = seeds;
  std::vector<std::string> renderers{"god-object"};
  for (const int resolution : options.resolutions) renderers.push_back(fmt::format("voxel {}^3", resolution));
  for (const std::string& renderer : renderers) {
    for (const char* const value : voxel_values) own.values.push_back(renderer + value);
  }
  own.findings = statements(voxel_findings(voxel_without_numbers()));
  own.timed_finding = timed_voxel_finding;
  own.words = words("voxel", options.seed, seeds);
  append(own.words, std::vector<std::string>{"--triangles", fmt::format("{}", options.triangles)});
  own.alone = true;  // it measures times
  own.parts = 1 + 2 * options.resolutions.size();
  own.run = [options](std::uint64_t number, const runs::PartDone& part_done) {
    VoxelExperimentOptions settings = options;
    settings.seed += number;
    const VoxelExperiment e = run_voxel_experiment(settings, [&](std::size_t, std::size_t) { part_done(); });
    return SeedResult{voxel_numbers(e), held(e.findings), voxel_document(e, number == 0), voxel_times(e)};
  };
  return own;
}

SeededExperiment seeded_friction(std::uint64_t first_seed, std::uint64_t seeds) {
  SeededExperiment own;
  own.name = "friction";
  own.settings = fmt::format(R"({{"mu":[{}]}})", fmt::join(friction_coefficients, ","));
  own.first_seed = first_seed;
  own.seeds = seeds;
  own.seed_step = friction_coefficients.size();
  for (const double mu : friction_coefficients) {
    for (const double stiffness : {soft_probe_N_per_m, stiff_probe_N_per_m}) {
      for (const char* const value : {"fitted mu", "without [N]", "with [N]"})
        own.values.push_back(fmt::format("mu {:.2f}, probe of {:.0f} N/m: {}", mu, stiffness, value));
    }
    for (const char* const value : {"estimated mu", "standard error"})
      own.values.push_back(fmt::format("mu {:.2f}: {}", mu, value));
  }
  own.findings = statements(friction_findings({}));
  own.words = words("friction", first_seed, seeds);
  own.parts = friction_coefficients.size() * friction_replays;
  own.bytes = 300'000'000;
  own.run = [first_seed](std::uint64_t number, const runs::PartDone& part_done) {
    FrictionExperiment e;
    for (std::size_t i = 0; i < friction_coefficients.size(); ++i) {
      e.fits.push_back(
          fit_friction(first_seed + friction_coefficients.size() * number + i, friction_coefficients[i], part_done));
    }
    return SeedResult{friction_numbers(e), held(friction_findings(e)), friction_to_json(e), ""};
  };
  return own;
}

SeededExperiment seeded_density(std::uint64_t first_seed, std::uint64_t seeds, bool shading) {
  SeededExperiment own;
  own.name = "density";
  const auto sizes = density_triangles();
  own.settings = fmt::format(R"({{"triangles":[{}]}})", fmt::join(sizes, ","));
  own.first_seed = first_seed;
  own.seeds = seeds;
  for (const std::size_t size : sizes) {
    own.values.push_back(fmt::format("{} triangles: proxy [N]", size));
    own.values.push_back(fmt::format("{} triangles: with shading [N]", size));
  }
  own.findings = density_statements();
  own.words = words(shading ? "shading" : "density", first_seed, seeds);
  own.bytes = 500'000'000;
  own.run = [first_seed](std::uint64_t number, const runs::PartDone&) {
    const DensityExperiment e = run_density_experiment(first_seed + number);
    std::vector<double> values;
    for (const DensityPoint& point : e.points) append<double>(values, {point.plain.mean_N, point.shaded.mean_N});
    auto findings = held(density_findings(e));
    append(findings, held(shading_findings(e)));
    return SeedResult{values, findings, density_to_json(e), ""};
  };
  return own;
}

SpreadPart density_part(bool shading) {
  SpreadPart part;
  for (std::size_t v = 0; v < 2 * published_density.size(); v += shading ? 1 : 2) part.values.push_back(v);
  const std::size_t of_density = density_findings(density_without_numbers()).size();
  const std::size_t all = density_statements().size();
  for (std::size_t f = shading ? of_density : 0; f < (shading ? all : of_density); ++f) part.findings.push_back(f);
  return part;
}

SeededExperiment seeded_springs(std::uint64_t first_seed, std::uint64_t seeds) {
  SeededExperiment own;
  own.name = "springs";
  own.settings = fmt::format(R"({{"scanned_seeds":{}}})", scan_seeds);
  own.first_seed = first_seed;
  own.seeds = seeds;
  const auto variants = spring_variants();
  const auto& methods = perception::statistical_methods();
  for (const Variant& variant : variants) {
    own.values.push_back(fmt::format("{}: {}, Spearman's rho with the paper's order", variant.name,
                                     perception::perception_space_method.name));
    for (const auto& method : methods)
      own.values.push_back(
          fmt::format("{}: {}, Spearman's rho with the paper's order", variant.name, method.method.name));
    for (const auto& method : methods_beside())
      own.values.push_back(fmt::format("{}: {}, Spearman's rho with the paper's order", variant.name, method));
    for (const Finding& finding : spring_findings())
      own.findings.push_back(fmt::format("{}: {}", variant.name, finding.name));
  }
  own.words = {
      "experiment", "springs", "--first-seed", fmt::format("{}", first_seed), "--seeds", fmt::format("{}", seeds)};
  own.alone = true;  // an evaluation takes all cores
  own.parts = spring_parts(true);
  own.run = [first_seed](std::uint64_t number, const runs::PartDone& part_done) {
    const SpringSeed seed = run_spring_seed(first_seed + number, number < scan_seeds, part_done);
    SeedResult result;
    for (const SpringSeed::OfVariant& variant : seed.variants) {
      append(result.values, variant.agreement);
      for (const Finding& finding : spring_findings())
        result.findings.push_back(finding.holds(variant.costs(variant.spaces.front())));
    }
    result.document = spring_seed_to_json(seed);
    return result;
  };
  return own;
}

SeededExperiment seeded_perception(const PerceptionBenchOptions& options) {
  SeededExperiment own;
  own.name = "perception";
  own.settings = fmt::format(R"({{"other_metrics":{}}})", options.other_metrics);
  own.first_seed = options.first_seed;
  own.seeds = options.seeds;
  for (const auto& [truth, key] : bench_truths) {
    for (const char* const value :
         {"clear pairs ordered rightly", "called indistinguishable below threshold", "intervals that hold the d'"})
      own.values.push_back(fmt::format("{}: {}", key, value));
  }
  own.words = {"experiment",   "perception",
               "--first-seed", fmt::format("{}", options.first_seed),
               "--seeds",      fmt::format("{}", options.seeds)};
  if (!options.other_metrics) own.words.emplace_back("--judge-only");
  own.alone = true;  // the setups of a seed take all cores
  for (const auto& [truth, key] : bench_truths) own.parts += bench_setups(truth).size();
  own.run = [options](std::uint64_t number, const runs::PartDone& part_done) {
    SeedResult result;
    nlohmann::ordered_json document;
    for (const auto& [truth, key] : bench_truths) {
      const auto seed = run_bench_seed(truth, options.first_seed + number, options.other_metrics, part_done);
      document[key] = bench_runs_to_json(seed);
      const PerceptionBench bench = gather_bench(options, seed);
      const auto share = [](std::size_t part, std::size_t all) {
        return all == 0 ? std::nan("") : static_cast<double>(part) / static_cast<double>(all);
      };
      append<double>(result.values,
                     {share(bench.scores.front().right, bench.scores.front().pairs),
                      share(bench.called_indistinguishable, bench.below_threshold), share(bench.covered, bench.cases)});
    }
    result.document = document.dump();
    return result;
  };
  return own;
}

PerceptionBench stored_bench(PerceptionBenchOptions options, BenchTruth truth, const std::vector<StoredSeed>& seeds) {
  options.truth = truth;
  const auto* const key = std::ranges::find(bench_truths, truth, [](const auto& own) { return own.first; })->second;
  std::vector<BenchedRun> all;
  for (const StoredSeed& seed : seeds) {
    if (seed.error.empty())
      append(all, bench_runs_from_json(truth, nlohmann::ordered_json::parse(seed.result.document).at(key)));
  }
  return gather_bench(options, std::move(all));
}

}  // namespace touchstone::experiments
