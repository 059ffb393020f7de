// What a fit minimises: a force metric of the model's prediction against the recording, on chosen time ranges.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "harness/metrics/catalogue.h"
#include "harness/metrics/time_ranges.h"
#include "harness/recording/trajectory.h"
#include "harness/rendering/predictor.h"

namespace touchstone::pipeline {

// `metric` names a result that needs force only (rms_force_error); throws UsageError for another.
void check_fit_metric(const std::string& metric);

class Objective {
 public:
  // `recording` and `predictor` must outlive it; the predictor is for the recording's samples.
  Objective(const recording::Recording& recording, rendering::Predictor& predictor, std::string metric,
            const metrics::MetricOptions& options);

  // The metric over the samples of `part` (indices); the magnitude of a metric that has a sign. Throws BadData when it
  // has no value.
  [[nodiscard]] double value(const rendering::Model& model, const std::vector<std::size_t>& part) const;
  // All force metrics over the part.
  [[nodiscard]] std::vector<metrics::MetricResult> metrics(const rendering::Model& model,
                                                           const std::vector<std::size_t>& part) const;
  [[nodiscard]] std::vector<Vec3> predict(const rendering::Model& model) const {
    return predictor_.predict(model).f_W_N;
  }

  // The metric as a mean of a loss over samples, where it is (the square of) one: squares for rms_force_error and its
  // axes, distances for mean_force_error. Empty for others. One loss per sample of the part.
  [[nodiscard]] std::vector<double> losses(const rendering::Model& model, const std::vector<std::size_t>& part) const;

  // The samples in the ranges. Throws UsageError naming `option` where there are fewer than ten.
  [[nodiscard]] std::vector<std::size_t> part(const metrics::TimeRanges& ranges, const std::string& option) const;
  [[nodiscard]] const recording::Recording& recording() const { return recording_; }
  [[nodiscard]] const std::string& metric() const { return metric_; }

 private:
  const recording::Recording& recording_;
  rendering::Predictor& predictor_;
  // What one sample costs, of the metrics that are (the square of) a mean over samples.
  enum class Loss { none, distance, square, square_of_axis };
  [[nodiscard]] static Loss loss_of(const std::string& metric);

  std::string metric_;
  Loss loss_ = Loss::none;
  Eigen::Index axis_ = 0;  // of square_of_axis
  metrics::MetricOptions options_;
};

}  // namespace touchstone::pipeline
