#include "harness/perception/perception_json.h"

#include <cmath>
#include <nlohmann/json.hpp>
#include <numeric>

namespace touchstone::perception {
namespace {

using Json = nlohmann::ordered_json;

Json number(double value) { return std::isfinite(value) ? Json(value) : Json(); }
Json number(const std::optional<double>& value) { return value ? number(*value) : Json(); }

Json numbers(const std::vector<double>& values) {
  Json result = Json::array();
  for (const double value : values) result.push_back(number(value));
  return result;
}

Json coordinates(const PerceptionSpace& space, std::size_t row) {
  Json result = Json::array();
  for (Eigen::Index d = 0; d < space.dimensions; ++d) {
    result.push_back(number(space.coordinates(static_cast<Eigen::Index>(row), d)));
  }
  return result;
}

// Names from the best to the worst; what has no value comes last.
Json ranking(const PerceptualEvaluation& evaluation, const std::vector<double>& values, bool larger_is_better) {
  std::vector<std::size_t> order(values.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  const auto cost = [&](std::size_t i) {
    if (!std::isfinite(values[i])) return std::numeric_limits<double>::infinity();
    return larger_is_better ? -values[i] : values[i];
  };
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return cost(a) < cost(b); });
  Json result = Json::array();
  for (const std::size_t i : order) result.push_back(evaluation.conditions[i].name);
  return result;
}

Json condition(const PerceptualEvaluation& evaluation, const ConditionResult& own, std::size_t row) {
  Json statistics = Json::object();
  for (std::size_t m = 0; m < own.statistics.size(); ++m) {
    statistics[std::string(statistical_methods()[m].method.name)] = number(own.statistics[m]);
  }
  Json blocks = Json::object();
  for (std::size_t b = 0; b < own.block_distance.size(); ++b)
    blocks[evaluation.features[b]] = number(own.block_distance[b]);
  return {{"name", own.name},
          {"distance", number(own.distance)},
          {"rank", own.rank_perception},
          {"coordinates", coordinates(evaluation.space, row)},
          {"distance_by_feature", blocks},
          {"statistics", statistics},
          {"extended_rate_hardness_N_per_m", number(own.extended_rate_hardness_N_per_m)},
          {"harmonic_share", number(own.harmonic_share)},
          {"rate_hardness_guarded_share", number(own.guarded_share)},
          {"force_reduction", number(own.force_reduction)},
          {"displacement_reduction", number(own.displacement_reduction)}};
}

Json method(const PerceptualEvaluation& evaluation, const Method& own) {
  const auto values = evaluation.values(own.name);
  return {{"name", own.name},
          {"title", own.title},
          {"unit", own.unit},
          {"larger_is_better", own.larger_is_better},
          {"values", numbers(values)},
          {"relative_similarity", numbers(relative_similarity(values, own.larger_is_better))},
          {"ranking", ranking(evaluation, values, own.larger_is_better)}};
}

Json scale(const PsychologicalScale& own) {
  return {{"model", name_of(own.model)},
          {"value", numbers(own.value)},
          {"standard_error", numbers(own.standard_error)},
          {"order_effect", number(own.order_effect)},
          {"order_effect_error", number(own.order_effect_error)},
          {"misfit_chi_squared", number(own.misfit)},
          {"degrees_of_freedom", number(own.degrees_of_freedom)},
          {"misfit_p", number(own.misfit_p)},
          {"remark", own.remark}};
}

Json correlation(const RankCorrelation& own) {
  return {{"coefficient", number(own.coefficient)},
          {"interval95", {number(own.low95), number(own.high95)}},
          {"p_two_sided", number(own.p_two_sided)}};
}

Json people_to_json(const SubjectiveComparison& people) {
  Json triads = Json::array();
  for (const auto& own : people.triads) {
    triads.push_back({{"subject", own.subject},
                      {"rounds", own.complete_rounds},
                      {"triads", number(own.triads)},
                      {"consistence", number(own.consistence)}});
  }
  Json agreement = Json::array();
  for (const auto& own : people.agreement) {
    Json entry{{"method", own.method}};
    if (own.remark.empty()) {
      entry["spearman"] = correlation(own.spearman);
      entry["kendall"] = correlation(own.kendall);
    } else {
      entry["remark"] = own.remark;
    }
    agreement.push_back(entry);
  }
  return {{"subjects", people.subjects},
          {"answers", people.answers},
          {"fraction_preferred", numbers(people.fraction_preferred)},
          {"scales", {scale(people.thurstone), scale(people.bradley_terry)}},
          {"circular_triads", triads},
          {"agreement", agreement}};
}

}  // namespace

std::string evaluation_to_json(const PerceptualEvaluation& evaluation, const SubjectiveComparison* people) {
  Json document{{"schema", "touchstone-perception/1"},
                {"rate_Hz", number(evaluation.rate_Hz)},
                {"samples", evaluation.samples},
                {"scaling", name_of(evaluation.scaling)},
                {"features", evaluation.features},
                {"dimensions", evaluation.space.dimensions},
                {"explained_share", number(evaluation.space.explained_share)}};
  const auto& eigenvalues = evaluation.space.eigenvalues;
  document["components"] = evaluation.space.available;
  document["eigenvalues"] = numbers({eigenvalues.data(), eigenvalues.data() + eigenvalues.size()});
  document["real"] = condition(evaluation, evaluation.real, 0);
  document["conditions"] = Json::array();
  for (std::size_t c = 0; c < evaluation.conditions.size(); ++c) {
    document["conditions"].push_back(condition(evaluation, evaluation.conditions[c], c + 1));
  }
  document["methods"] = {method(evaluation, perception_space_method)};
  for (const auto& own : statistical_methods()) document["methods"].push_back(method(evaluation, own.method));
  document["scalings"] = Json::array();
  const auto distances = distances_by_scaling(evaluation);
  for (std::size_t s = 0; s < distances.size(); ++s) {
    document["scalings"].push_back({{"scaling", name_of(feature_scalings[s])},
                                    {"distances", numbers(distances[s])},
                                    {"ranking", ranking(evaluation, distances[s], false)}});
  }
  document["rate_hardness_windows"] = Json::array();
  for (const auto& own : evaluation.windows) {
    document["rate_hardness_windows"].push_back({{"samples", own.window},
                                                 {"duration_s", own.duration_s},
                                                 {"resolution_m", number(own.resolution_m)},
                                                 {"level_N_per_m", number(own.level_N_per_m)},
                                                 {"noise_N_per_m", number(own.noise_N_per_m)},
                                                 {"guarded_share", number(own.guarded_share)}});
  }
  document["disagreements"] = Json::array();
  document["disagreeing_pairs"] = Json::object();
  for (const auto& own : statistical_methods()) {
    const Disagreements found = disagreements(evaluation, own.method.name);
    document["disagreeing_pairs"][std::string(own.method.name)] = {{"pairs", found.pairs}, {"of", found.of}};
    for (const auto& d : found.most) {
      document["disagreements"].push_back({{"method", own.method.name},
                                           {"nearer_in_space", evaluation.conditions[d.nearer_in_space].name},
                                           {"nearer_by_statistic", evaluation.conditions[d.nearer_by_statistic].name},
                                           {"feature", d.feature},
                                           {"why", d.why}});
    }
  }
  document["remarks"] = evaluation.remarks;
  if (people != nullptr) document["subjective"] = people_to_json(*people);
  return document.dump(2) + "\n";
}

}  // namespace touchstone::perception
