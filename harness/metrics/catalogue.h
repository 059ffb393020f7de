// The catalogue of metrics: a new one is two files and a line in catalogue.cc.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "harness/metrics/episodes.h"
#include "harness/metrics/metric.h"

namespace touchstone::metrics {

struct MetricEntry {
  std::string name;                  // what --metrics takes: "force-error"
  std::vector<std::string> results;  // the names of its MetricResults
  bool needs_force;
  bool needs_position;
  bool needs_cost;
  std::function<std::unique_ptr<Metric>(const MetricOptions&)> make;
};

const std::vector<MetricEntry>& metric_catalogue();

// The entry that `name` names, or that has a result of that name; throws UsageError that lists what is known.
const MetricEntry& find_metric(std::string_view name);

// Several metrics fed from one stream of samples.
class MetricSet {
 public:
  // `names` of entries or results; empty: the whole catalogue.
  MetricSet(const std::vector<std::string>& names, const MetricInputs& inputs, const MetricOptions& options);

  void add(const MetricSample& sample);
  // In the catalogue's order. Metrics whose input is absent are `missing`, with the reason.
  [[nodiscard]] std::vector<MetricResult> results();
  // Worst first; empty where that metric was not chosen.
  [[nodiscard]] std::vector<Episode> force_episodes();
  [[nodiscard]] std::vector<Episode> position_episodes();

 private:
  struct Member {
    const MetricEntry* entry;
    std::unique_ptr<Metric> metric;  // null where an input is absent
  };
  std::vector<Episode> episodes(std::string_view name);

  std::vector<Member> members_;
};

// The result of that name; throws UsageError listing the names that are there.
const MetricResult& find_result(const std::vector<MetricResult>& results, std::string_view name);

}  // namespace touchstone::metrics
