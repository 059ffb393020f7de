// What an evaluation says of perception beside the catalogue of metrics: force errors in just noticeable differences
// and the hardness of presses (harness/perception/perceptual_metrics.h). Here because metrics do not know of
// perception.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "harness/perception/perceptual_metrics.h"

namespace touchstone::pipeline {

// What --metrics may name: "perception" for all, or one result.
const std::vector<std::string>& perceived_metrics();
bool is_perceived_metric(std::string_view name);

class PerceivedQuality {
 public:
  void add(const metrics::MetricSample& sample, const Vec3& p_W_m);
  // Those of `names`, all where it is empty or has "perception".
  [[nodiscard]] std::vector<metrics::MetricResult> results(std::span<const std::string> names, bool has_force);

 private:
  perception::NoticeableForceError noticeable_;
  // For the hardness of presses, which needs the series as a whole. Longer recordings are judged by their beginning.
  recording::Recording recording_;
  std::vector<Vec3> f_rendered_W_N_;
  bool cut_ = false;
};

}  // namespace touchstone::pipeline
