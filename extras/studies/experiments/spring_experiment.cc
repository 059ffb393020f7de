#include "experiments/spring_experiment.h"

#include <algorithm>
#include <cmath>

#include "experiments/spring_seed.h"
#include "harness/perception/subjective/simulated_observer.h"

namespace touchstone::experiments {
namespace {

namespace pc = perception;

// Places in the order of spring_conditions().
enum : std::size_t { omega_linear, touch_x_linear, touch_linear, touch_quadratic, touch_x_quadratic, omega_quadratic };

bool ascending(double a, double b, double c) { return a < b && b < c; }

bool linear_nearer(const std::vector<double>& d) {
  return std::max({d[omega_linear], d[touch_x_linear], d[touch_linear]}) <
         std::min({d[omega_quadratic], d[touch_x_quadratic], d[touch_quadratic]});
}

bool linear_by_device(const std::vector<double>& d) {
  return ascending(d[omega_linear], d[touch_x_linear], d[touch_linear]);
}

bool quadratic_reversed(const std::vector<double>& d) {
  return ascending(d[touch_quadratic], d[touch_x_quadratic], d[omega_quadratic]);
}

bool quadratic_by_device(const std::vector<double>& d) {
  return ascending(d[omega_quadratic], d[touch_x_quadratic], d[touch_quadratic]);
}

}  // namespace

const std::vector<Finding>& spring_findings() {
  static const std::vector<Finding> findings{
      {"linear-nearer", "every linear spring lies nearer to the real one than every quadratic one (perception space)",
       [](const Costs& c) { return linear_nearer(c.space); }, true},
      {"linear-by-device", "linear springs: Omega.7 is best and Touch worst (perception space)",
       [](const Costs& c) { return linear_by_device(c.space); }, true},
      {"quadratic-reversed", "quadratic springs: Touch is best and Omega.7 worst (perception space)",
       [](const Costs& c) { return quadratic_reversed(c.space); }, true},
      {"table-2-order", "all six in the order of table 2 (perception space)",
       [](const Costs& c) {
         return linear_nearer(c.space) && linear_by_device(c.space) && quadratic_reversed(c.space);
       },
       true},
      {"euclidean-linear-nearer", "every linear spring lies nearer than every quadratic one (Euclidean distance)",
       [](const Costs& c) { return linear_nearer(c.euclidean); }, false},
      {"euclidean-linear-by-device", "linear springs: Omega.7 is best and Touch worst (Euclidean distance)",
       [](const Costs& c) { return linear_by_device(c.euclidean); }, false},
      {"euclidean-quadratic-by-device", "quadratic springs: Omega.7 is best and Touch worst (Euclidean distance)",
       [](const Costs& c) { return quadratic_by_device(c.euclidean); }, false},
      {"pearson-quadratic-by-device", "quadratic springs: Omega.7 is best and Touch worst (Pearson correlation)",
       [](const Costs& c) { return quadratic_by_device(c.pearson); }, false},
      {"euclidean-contrast", "quadratic springs: the space ranks the devices one way, the Euclidean distance the other",
       [](const Costs& c) { return quadratic_reversed(c.space) && quadratic_by_device(c.euclidean); }, true},
      {"pearson-contrast", "quadratic springs: the space ranks the devices one way, the Pearson correlation the other",
       [](const Costs& c) { return quadratic_reversed(c.space) && quadratic_by_device(c.pearson); }, true},
  };
  return findings;
}

std::vector<Variant> spring_variants() {
  const Variant base{
      "base", "the paper's letter: the same number for k, in N/mm and N/mm^2; 6 N at the full stroke of 10 mm", {}, {}};
  Variant equal = base;
  equal.name = "equal force";
  equal.what = "k of the quadratic law such that both laws give the same force at the full stroke";
  equal.setup.rule = QuadraticRule::equal_at_full_stroke;
  Variant light = base;
  light.name = "light press";
  light.what = "half the stroke (3 N): no device saturates on the linear spring";
  light.setup.motion.stroke_m = 0.005;
  Variant dead_zone = base;
  dead_zone.name = "dead zone";
  dead_zone.what = "the force sensor reads nothing below 0.6 N, as the paper says of its own";
  dead_zone.image.sensor_dead_zone_N = 0.6;
  Variant in_band = base;
  in_band.name = "hardness in band";
  in_band.what = "rate-hardness after the 6 Hz output band rather than of the series as measured";
  in_band.image.rate_hardness_in_band = true;
  return {base, equal, light, dead_zone, in_band};
}

double Share::low95() const {
  const double n = static_cast<double>(of);
  const double z2 = 1.959963984540054 * 1.959963984540054;
  const double p = value();
  return (p + 0.5 * z2 / n - std::sqrt(z2 * (p * (1.0 - p) / n + 0.25 * z2 / (n * n)))) / (1.0 + z2 / n);
}

double Share::high95() const {
  const Share complement{of - held, of};
  return 1.0 - complement.low95();
}

namespace {

void add_to(std::vector<double>& mean, const std::vector<double>& values, double weight) {
  mean.resize(values.size(), 0.0);
  for (std::size_t i = 0; i < values.size(); ++i) mean[i] += weight * values[i];
}

void count(VariantResult& result, const SpringSeed::OfVariant& own, double weight) {
  const auto& findings = spring_findings();
  result.findings.resize(findings.size());
  result.mean_distance.resize(own.spaces.size());
  for (std::size_t s = 0; s < own.spaces.size(); ++s) add_to(result.mean_distance[s], own.spaces[s], weight);
  for (std::size_t f = 0; f < findings.size(); ++f) {
    result.findings[f].resize(findings[f].uses_space ? own.spaces.size() : 1);
    for (std::size_t s = 0; s < result.findings[f].size(); ++s) {
      result.findings[f][s].of += 1;
      result.findings[f][s].held += findings[f].holds(own.costs(own.spaces[s])) ? 1 : 0;
    }
  }
  result.features = own.features;
  result.by_feature.resize(result.features.size());
  result.mean_block_distance.resize(result.features.size());
  for (std::size_t b = 0; b < result.features.size(); ++b) {
    add_to(result.mean_block_distance[b], own.blocks[b], weight);
    result.by_feature[b].resize(findings.size());
    for (std::size_t f = 0; f < findings.size(); ++f) {
      result.by_feature[b][f].of += 1;
      result.by_feature[b][f].held += findings[f].holds(own.costs(own.blocks[b])) ? 1 : 0;
    }
  }
  result.mean_dimensions += weight * own.dimensions;
  result.mean_explained_share += weight * own.explained_share;
  const auto& methods = pc::statistical_methods();
  result.mean_statistic.resize(methods.size());
  result.methods = {std::string(pc::perception_space_method.name)};
  for (std::size_t m = 0; m < methods.size(); ++m) {
    add_to(result.mean_statistic[m], own.statistics[m], weight);
    result.methods.emplace_back(methods[m].method.name);
  }
  result.methods.insert(result.methods.end(), methods_beside().begin(), methods_beside().end());
  result.agreement.resize(result.methods.size());
  for (std::size_t m = 0; m < result.methods.size(); ++m) result.agreement[m].push_back(own.agreement.at(m));
}

}  // namespace

std::vector<ScanPoint> spring_scan_points() {
  std::vector<ScanPoint> points;
  for (const auto rule : {QuadraticRule::equal_at_full_stroke, QuadraticRule::same_number}) {
    for (const double force_N : {1.5, 3.0, 4.0, 5.0, 6.0, 8.0, 10.0, 14.0}) points.push_back({rule, force_N, {}});
  }
  return points;
}

SpringExperiment run_spring_experiment(std::uint64_t first_seed, std::size_t seeds,
                                       const std::function<void(std::size_t done, std::size_t of)>& progress) {
  std::size_t done = 0;
  const std::size_t scanned = std::min(seeds, scan_seeds);
  const std::size_t all = scanned * spring_parts(true) + (seeds - scanned) * spring_parts(false);
  std::vector<SpringSeed> of_seed;
  for (std::size_t s = 0; s < seeds; ++s) {
    of_seed.push_back(run_spring_seed(first_seed + s, s < scan_seeds, [&] {
      if (progress) progress(++done, all);
    }));
  }
  return gather_springs(first_seed, of_seed);
}

SpringExperiment gather_springs(std::uint64_t first_seed, const std::vector<SpringSeed>& seeds) {
  SpringExperiment experiment;
  experiment.first_seed = first_seed;
  experiment.seeds = seeds.size();
  const auto variants = spring_variants();
  for (std::size_t v = 0; v < variants.size(); ++v) {
    VariantResult result;
    result.variant = variants[v];
    for (const SpringSeed& own : seeds) count(result, own.variants.at(v), 1.0 / static_cast<double>(seeds.size()));
    experiment.variants.push_back(std::move(result));
  }
  for (const auto& condition : spring_conditions(variants.front().setup))
    experiment.conditions.push_back(condition.name);
  experiment.scan = spring_scan_points();
  const auto& findings = spring_findings();
  for (std::size_t p = 0; p < experiment.scan.size(); ++p) {
    auto& shares = experiment.scan[p].findings;
    shares.resize(findings.size());
    for (const SpringSeed& own : seeds) {
      if (own.scan.empty()) continue;
      for (std::size_t f = 0; f < findings.size(); ++f) {
        shares[f].of += 1;
        shares[f].held += findings[f].holds(own.scan.at(p)) ? 1 : 0;
      }
    }
  }
  experiment.example = spring_example(first_seed);
  // Ten observers, as the paper had subjects; they feel the example's distances with a noise of a quarter of their
  // range.
  const auto distances = experiment.example.values(pc::perception_space_method.name);
  const auto [low, high] = std::minmax_element(distances.begin(), distances.end());
  pc::SimulatedObserver observer;
  observer.noise = 0.25 * (*high - *low);
  const auto answers = pc::simulate_answers(experiment.conditions, distances, 10, observer, first_seed);
  experiment.simulated_subjects = pc::compare_with_people(experiment.example, answers);
  return experiment;
}

}  // namespace touchstone::experiments
