#include "experiments/spring_seed.h"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

#include "harness/base/error.h"
#include "harness/perception/agreement.h"
#include "harness/perception/judge/judged_conditions.h"

namespace touchstone::experiments {
using recording::Recording;

namespace {

namespace pc = perception;

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

// Larger is more like the real process, in the order of spring_conditions(): the order that the paper's subjects gave.
const std::vector<double> published_likeness{6, 5, 4, 3, 2, 1};

// The presses as a recording: the surface is z = 0, outward is +z.
Recording recording_of(const pc::PressSignal& press) {
  Recording recording;
  recording.source = press.name;
  recording.motion.t_s = press.t_s;
  for (std::size_t i = 0; i < press.t_s.size(); ++i) {
    recording.motion.p_W_m.emplace_back(0.0, 0.0, -press.displacement_m[i]);
    recording.f_W_N.emplace_back(0.0, 0.0, press.force_N[i]);
  }
  return recording;
}

// Spearman's rho of methods_beside() with the published order.
std::vector<double> agreement_beside(const Variant& variant, const std::vector<SpringCondition>& conditions,
                                     std::uint64_t seed) {
  const Recording real = recording_of(press_real_spring(variant.setup, seed));
  const pc::JudgeOptions options;
  const auto reference = pc::judged_process(pc::felt_series(real, Vec3::UnitZ()), options.thresholds);
  const auto& names = methods_beside();
  std::vector<std::vector<double>> values(names.size());
  std::vector<bool> larger_is_better(names.size(), false);
  for (std::size_t c = 0; c < conditions.size(); ++c) {
    const Recording rendered = recording_of(press_condition(variant.setup, conditions[c], seed, c));
    const auto process = pc::judged_process(pc::felt_series(rendered, Vec3::UnitZ()), options.thresholds, &reference);
    values[0].push_back(pc::judge(reference, process, {}, options).d_prime);
    for (const auto& other : pc::other_metrics(real, rendered, Vec3::UnitZ())) {
      const auto found = std::find(names.begin(), names.end(), other.name);
      if (found == names.end()) continue;
      if (!other.value) throw BadData(fmt::format("{} of {}: {}", other.name, conditions[c].name, other.why));
      const auto m = static_cast<std::size_t>(found - names.begin());
      values[m].push_back(*other.value);
      larger_is_better[m] = other.larger_is_better;
    }
  }
  std::vector<double> agreement;
  for (std::size_t m = 0; m < names.size(); ++m) {
    agreement.push_back(pc::agree(names[m], values[m], larger_is_better[m], published_likeness).spearman.coefficient);
  }
  return agreement;
}

Costs costs_of(const pc::PerceptualEvaluation& evaluation) {
  Costs costs{evaluation.values(pc::perception_space_method.name), evaluation.values("euclidean"),
              evaluation.values("pearson")};
  for (double& value : costs.pearson) value = 1.0 - value;
  return costs;
}

const std::vector<double>& of_method(const SpringSeed::OfVariant& own, std::string_view name) {
  const auto& methods = pc::statistical_methods();
  for (std::size_t m = 0; m < methods.size(); ++m) {
    if (methods[m].method.name == name) return own.statistics.at(m);
  }
  throw std::logic_error("the statistical methods have no " + std::string(name));
}

SpringSeed::OfVariant numbers_of(const pc::PerceptualEvaluation& evaluation) {
  SpringSeed::OfVariant own;
  for (const auto scaling : pc::feature_scalings)
    own.spaces.push_back(pc::distances_with_scaling(evaluation, scaling, evaluation.explained_share_wanted));
  own.features = evaluation.features;
  for (std::size_t b = 0; b < own.features.size(); ++b) {
    auto& alone = own.blocks.emplace_back();
    for (const auto& condition : evaluation.conditions) alone.push_back(condition.block_distance[b]);
  }
  const auto likeness = [&](const pc::Method& method) {
    return pc::agree(std::string(method.name), evaluation.values(method.name), method.larger_is_better,
                     published_likeness)
        .spearman.coefficient;
  };
  own.agreement.push_back(likeness(pc::perception_space_method));
  for (const auto& statistical : pc::statistical_methods()) {
    own.statistics.push_back(evaluation.values(statistical.method.name));
    own.agreement.push_back(likeness(statistical.method));
  }
  own.dimensions = static_cast<double>(evaluation.space.dimensions);
  own.explained_share = evaluation.space.explained_share;
  return own;
}

Variant scanned_variant(const ScanPoint& point) {
  Variant variant = spring_variants().front();
  variant.setup.rule = point.rule;
  variant.setup.motion.stroke_m = point.full_stroke_force_N / variant.setup.stiffness_N_per_m;
  return variant;
}

}  // namespace

Costs SpringSeed::OfVariant::costs(std::vector<double> space) const {
  Costs all{std::move(space), of_method(*this, "euclidean"), of_method(*this, "pearson")};
  for (double& value : all.pearson) value = 1.0 - value;
  return all;
}

const std::vector<std::string>& methods_beside() {
  static const std::vector<std::string> names{"judge", "st-sim", "spqi", "stevens"};
  return names;
}

std::size_t spring_parts(bool scanned) {
  return spring_variants().size() + (scanned ? spring_scan_points().size() : 0);
}

SpringSeed run_spring_seed(std::uint64_t seed, bool scanned, const std::function<void()>& part_done) {
  SpringSeed own;
  for (const Variant& variant : spring_variants()) {
    const auto conditions = spring_conditions(variant.setup);
    own.variants.push_back(numbers_of(evaluate_seed(variant, conditions, seed)));
    const auto beside = agreement_beside(variant, conditions, seed);
    auto& agreement = own.variants.back().agreement;
    agreement.insert(agreement.end(), beside.begin(), beside.end());
    if (part_done) part_done();
  }
  if (!scanned) return own;
  for (const ScanPoint& point : spring_scan_points()) {
    const Variant variant = scanned_variant(point);
    own.scan.push_back(costs_of(evaluate_seed(variant, spring_conditions(variant.setup), seed)));
    if (part_done) part_done();
  }
  return own;
}

pc::PerceptualEvaluation spring_example(std::uint64_t seed) {
  const Variant base = spring_variants().front();
  return evaluate_seed(base, spring_conditions(base.setup), seed);
}

}  // namespace touchstone::experiments
