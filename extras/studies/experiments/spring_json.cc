#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "experiments/spring_seed.h"
#include "harness/base/error.h"

namespace touchstone::experiments {
namespace {

namespace pc = perception;
using Json = nlohmann::ordered_json;

Json share(const Share& own) {
  return {{"held", own.held}, {"of", own.of}, {"share", own.value()}, {"interval95", {own.low95(), own.high95()}}};
}

Json numbers(const std::vector<double>& values) {
  Json result = Json::array();
  for (const double value : values) result.push_back(std::isfinite(value) ? Json(value) : Json());
  return result;
}

Json tables(const std::vector<std::vector<double>>& rows) {
  Json result = Json::array();
  for (const auto& row : rows) result.push_back(numbers(row));
  return result;
}

// null is what has no number.
std::vector<double> numbers_from(const Json& document) {
  std::vector<double> values;
  for (const Json& value : document) values.push_back(value.is_null() ? std::nan("") : value.get<double>());
  return values;
}

std::vector<std::vector<double>> tables_from(const Json& document) {
  std::vector<std::vector<double>> rows;
  for (const Json& row : document) rows.push_back(numbers_from(row));
  return rows;
}

Json variant_to_json(const VariantResult& own) {
  Json findings = Json::array();
  const auto& all = spring_findings();
  for (std::size_t f = 0; f < all.size(); ++f) {
    Json entry{{"name", all[f].name}, {"statement", all[f].statement}};
    if (all[f].uses_space) {
      for (std::size_t s = 0; s < own.findings[f].size(); ++s) {
        entry["by_scaling"][std::string(pc::name_of(pc::feature_scalings[s]))] = share(own.findings[f][s]);
      }
      for (std::size_t b = 0; b < own.features.size(); ++b)
        entry["by_feature_alone"][own.features[b]] = share(own.by_feature[b][f]);
    } else {
      entry["share"] = share(own.findings[f][0]);
    }
    findings.push_back(entry);
  }
  Json result{{"name", own.variant.name}, {"what", own.variant.what}, {"findings", findings}};
  for (std::size_t s = 0; s < own.mean_distance.size(); ++s) {
    result["mean_distance"][std::string(pc::name_of(pc::feature_scalings[s]))] = numbers(own.mean_distance[s]);
  }
  for (std::size_t b = 0; b < own.features.size(); ++b) {
    result["mean_distance_by_feature"][own.features[b]] = numbers(own.mean_block_distance[b]);
  }
  for (std::size_t m = 0; m < own.mean_statistic.size(); ++m) {
    result["mean_statistic"][own.methods[m + 1]] = numbers(own.mean_statistic[m]);
  }
  for (std::size_t m = 0; m < own.methods.size(); ++m) {
    result["spearman_with_published_order"][own.methods[m]] = numbers(own.agreement[m]);
  }
  result["mean_dimensions"] = own.mean_dimensions;
  result["mean_explained_share"] = own.mean_explained_share;
  return result;
}

}  // namespace

std::string spring_experiment_to_json(const SpringExperiment& experiment) {
  Json document{{"schema", "touchstone-springs/1"},
                {"first_seed", experiment.first_seed},
                {"seeds", experiment.seeds},
                {"conditions", experiment.conditions}};
  document["variants"] = Json::array();
  for (const auto& own : experiment.variants) document["variants"].push_back(variant_to_json(own));
  document["scan"] = Json::array();
  for (const auto& own : experiment.scan) {
    Json point{{"quadratic_rule", own.rule == QuadraticRule::same_number ? "same-number" : "equal-at-full-stroke"},
               {"full_stroke_force_N", own.full_stroke_force_N}};
    for (std::size_t f = 0; f < own.findings.size(); ++f)
      point["findings"][spring_findings()[f].name] = share(own.findings[f]);
    document["scan"].push_back(point);
  }
  return document.dump(2) + "\n";
}

std::string spring_seed_to_json(const SpringSeed& seed) {
  Json document{{"variants", Json::array()}, {"scan", Json::array()}};
  for (const auto& own : seed.variants) {
    document["variants"].push_back({{"spaces", tables(own.spaces)},
                                    {"features", own.features},
                                    {"blocks", tables(own.blocks)},
                                    {"statistics", tables(own.statistics)},
                                    {"agreement", numbers(own.agreement)},
                                    {"dimensions", own.dimensions},
                                    {"explained_share", own.explained_share}});
  }
  for (const Costs& own : seed.scan) document["scan"].push_back(tables({own.space, own.euclidean, own.pearson}));
  return document.dump();
}

SpringSeed spring_seed_from_json(const std::string& text) {
  try {
    const Json document = Json::parse(text);
    SpringSeed seed;
    for (const Json& one : document.at("variants")) {
      SpringSeed::OfVariant own;
      own.spaces = tables_from(one.at("spaces"));
      one.at("features").get_to(own.features);
      own.blocks = tables_from(one.at("blocks"));
      own.statistics = tables_from(one.at("statistics"));
      own.agreement = numbers_from(one.at("agreement"));
      one.at("dimensions").get_to(own.dimensions);
      one.at("explained_share").get_to(own.explained_share);
      seed.variants.push_back(std::move(own));
    }
    for (const Json& one : document.at("scan"))
      seed.scan.push_back({numbers_from(one.at(0)), numbers_from(one.at(1)), numbers_from(one.at(2))});
    return seed;
  } catch (const Json::exception& error) {
    throw BadData(std::string("the stored seed of the spring experiment cannot be read: ") + error.what());
  }
}

}  // namespace touchstone::experiments
