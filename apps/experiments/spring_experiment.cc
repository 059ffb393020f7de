#include "apps/experiments/spring_experiment.h"

#include <algorithm>
#include <cmath>

#include "harness/perception/agreement.h"
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

pc::PerceptualEvaluation evaluate_seed(const Variant& variant, const std::vector<SpringCondition>& conditions,
                                       std::uint64_t seed) {
  std::vector<pc::ConditionSource> sources;
  for (std::size_t c = 0; c < conditions.size(); ++c) {
    sources.push_back({conditions[c].name, [&variant, &condition = conditions[c], seed, c] {
                         return std::vector<pc::PressSignal>{press_condition(variant.setup, condition, seed, c)};
                       }});
  }
  pc::EvaluationOptions options;
  options.image = variant.image;
  return pc::evaluate({press_real_spring(variant.setup, seed)}, sources, options);
}

void add_to(std::vector<double>& mean, const std::vector<double>& values, double weight) {
  mean.resize(values.size(), 0.0);
  for (std::size_t i = 0; i < values.size(); ++i) mean[i] += weight * values[i];
}

// Larger is more like the real process, in the order of spring_conditions(): the order that the paper's subjects gave.
const std::vector<double> kPublishedLikeness{6, 5, 4, 3, 2, 1};

Costs costs_of(const pc::PerceptualEvaluation& evaluation) {
  Costs costs{evaluation.values(pc::kPerceptionSpaceMethod.name), evaluation.values("euclidean"),
              evaluation.values("pearson")};
  for (double& value : costs.pearson) value = 1.0 - value;
  return costs;
}

void count(VariantResult& result, const pc::PerceptualEvaluation& evaluation, double weight) {
  Costs costs = costs_of(evaluation);
  const auto& findings = spring_findings();
  result.findings.resize(findings.size());
  std::vector<std::vector<double>> spaces;
  for (const auto scaling : pc::kFeatureScalings) {
    spaces.push_back(pc::distances_with_scaling(evaluation, scaling, evaluation.explained_share_wanted));
  }
  result.mean_distance.resize(spaces.size());
  for (std::size_t s = 0; s < spaces.size(); ++s) add_to(result.mean_distance[s], spaces[s], weight);
  for (std::size_t f = 0; f < findings.size(); ++f) {
    result.findings[f].resize(findings[f].uses_space ? spaces.size() : 1);
    for (std::size_t s = 0; s < result.findings[f].size(); ++s) {
      result.findings[f][s].of += 1;
      costs.space = spaces[s];
      result.findings[f][s].held += findings[f].holds(costs) ? 1 : 0;
    }
  }
  result.features = evaluation.features;
  result.by_feature.resize(result.features.size());
  result.mean_block_distance.resize(result.features.size());
  for (std::size_t b = 0; b < result.features.size(); ++b) {
    std::vector<double> alone;
    for (const auto& condition : evaluation.conditions) alone.push_back(condition.block_distance[b]);
    add_to(result.mean_block_distance[b], alone, weight);
    result.by_feature[b].resize(findings.size());
    for (std::size_t f = 0; f < findings.size(); ++f) {
      result.by_feature[b][f].of += 1;
      costs.space = alone;
      result.by_feature[b][f].held += findings[f].holds(costs) ? 1 : 0;
    }
  }
  result.mean_dimensions += weight * static_cast<double>(evaluation.space.dimensions);
  result.mean_explained_share += weight * evaluation.space.explained_share;
  const auto& methods = pc::statistical_methods();
  result.mean_statistic.resize(methods.size());
  result.methods = {std::string(pc::kPerceptionSpaceMethod.name)};
  result.agreement.resize(methods.size() + 1);
  const auto likeness = [&](const pc::Method& method) {
    return pc::agree(std::string(method.name), evaluation.values(method.name), method.larger_is_better,
                     kPublishedLikeness)
        .spearman.coefficient;
  };
  result.agreement[0].push_back(likeness(pc::kPerceptionSpaceMethod));
  for (std::size_t m = 0; m < methods.size(); ++m) {
    add_to(result.mean_statistic[m], evaluation.values(methods[m].method.name), weight);
    result.methods.emplace_back(methods[m].method.name);
    result.agreement[m + 1].push_back(likeness(methods[m].method));
  }
}

// Presses from half of what the weakest device can give to more than the strongest can.
std::vector<ScanPoint> scan_points() {
  std::vector<ScanPoint> points;
  for (const auto rule : {QuadraticRule::equal_at_full_stroke, QuadraticRule::same_number}) {
    for (const double force_N : {1.5, 3.0, 4.0, 5.0, 6.0, 8.0, 10.0, 14.0}) points.push_back({rule, force_N, {}});
  }
  return points;
}

void scan(ScanPoint& point, std::uint64_t first_seed, std::size_t seeds) {
  Variant variant = spring_variants().front();
  variant.setup.rule = point.rule;
  variant.setup.motion.stroke_m = point.full_stroke_force_N / variant.setup.stiffness_N_per_m;
  const auto conditions = spring_conditions(variant.setup);
  const auto& findings = spring_findings();
  point.findings.resize(findings.size());
  for (std::size_t s = 0; s < seeds; ++s) {
    const Costs costs = costs_of(evaluate_seed(variant, conditions, first_seed + s));
    for (std::size_t f = 0; f < findings.size(); ++f) {
      point.findings[f].of += 1;
      point.findings[f].held += findings[f].holds(costs) ? 1 : 0;
    }
  }
}

}  // namespace

SpringExperiment run_spring_experiment(std::uint64_t first_seed, std::size_t seeds,
                                       const std::function<void(std::size_t done, std::size_t of)>& progress) {
  SpringExperiment experiment;
  experiment.first_seed = first_seed;
  experiment.seeds = seeds;
  const auto variants = spring_variants();
  experiment.scan = scan_points();
  const std::size_t scan_seeds = std::min(seeds, kScanSeeds);
  const std::size_t all = variants.size() * seeds + experiment.scan.size() * scan_seeds;
  for (const auto& variant : variants) {
    const auto conditions = spring_conditions(variant.setup);
    VariantResult result;
    result.variant = variant;
    for (std::size_t s = 0; s < seeds; ++s) {
      auto evaluation = evaluate_seed(variant, conditions, first_seed + s);
      count(result, evaluation, 1.0 / static_cast<double>(seeds));
      if (experiment.variants.empty() && s == 0) experiment.example = std::move(evaluation);
      if (progress) progress(experiment.variants.size() * seeds + s + 1, all);
    }
    experiment.variants.push_back(std::move(result));
    if (experiment.conditions.empty()) {
      for (const auto& condition : conditions) experiment.conditions.push_back(condition.name);
    }
  }
  for (std::size_t p = 0; p < experiment.scan.size(); ++p) {
    scan(experiment.scan[p], first_seed, scan_seeds);
    if (progress) progress(variants.size() * seeds + (p + 1) * scan_seeds, all);
  }
  // Ten observers, as the paper had subjects; they feel the example's distances with a noise of a quarter of their
  // range.
  const auto distances = experiment.example.values(pc::kPerceptionSpaceMethod.name);
  const auto [low, high] = std::minmax_element(distances.begin(), distances.end());
  pc::SimulatedObserver observer;
  observer.noise = 0.25 * (*high - *low);
  const auto answers = pc::simulate_answers(experiment.conditions, distances, 10, observer, first_seed);
  experiment.simulated_subjects = pc::compare_with_people(experiment.example, answers);
  return experiment;
}

}  // namespace touchstone::experiments
