#include "harness/pipeline/evaluation/counted_cost.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <tuple>

#include "harness/metrics/result.h"
#include "harness/rendering/operations.h"

namespace touchstone::pipeline {
using metrics::MetricResult;

const std::vector<std::string>& operation_metrics() {
  static const std::vector<std::string> names{"operations", "total_operations", "mean_operations", "median_operations",
                                              "max_operations"};
  return names;
}

bool is_operation_metric(std::string_view name) { return std::ranges::count(operation_metrics(), name) > 0; }

bool asks_for_operations(std::span<const std::string> names) {
  return names.empty() || std::ranges::any_of(names, is_operation_metric);
}

std::vector<MetricResult> count_of_steps(const rendering::Catalogue& catalogue, const rendering::Model& model,
                                         const std::shared_ptr<const surface::Surface>& surface,
                                         const rendering::TipSource& source, std::span<const std::string> names) {
  const rendering::CountedRenderer counted = catalogue.make_counted(model, surface);
  rendering::OperationReport report;
  if (counted.renderer) report = count_operations(*counted.renderer, source);
  const std::array<std::tuple<const char*, const char*, double>, 4> all{
      {{"total_operations", "Floating-point operations of the whole trajectory.", static_cast<double>(report.total())},
       {"mean_operations", "Floating-point operations of a step, on average.", report.mean},
       {"median_operations", "Floating-point operations of half of the steps are at most this.", report.median},
       {"max_operations", "Floating-point operations of the most expensive step.", static_cast<double>(report.max)}}};
  const bool every = names.empty() || std::ranges::count(names, "operations") > 0;
  std::vector<MetricResult> out;
  for (const auto& [name, meaning, value] : all) {
    if (!every && std::ranges::count(names, name) == 0) continue;
    if (!counted.renderer) {
      out.push_back(metrics::make_missing(name, "1", meaning, "not counted: " + counted.not_counted));
      continue;
    }
    MetricResult one;
    one.name = name;
    one.unit = "1";
    one.value = value;
    one.status = metrics::MetricStatus::ok;
    one.meaning = meaning;
    one.note = counted.not_counted.empty()
                   ? std::string(rendering::how_searches_are_counted)
                   : fmt::format("{}; not counted: {}", rendering::how_searches_are_counted, counted.not_counted);
    out.push_back(std::move(one));
  }
  return out;
}

}  // namespace touchstone::pipeline
