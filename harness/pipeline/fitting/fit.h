// Identifying parameters of a model from a recording, as the friction radius is in Ruffaldi et al. 2006, section 4.2,
// for any declared parameter: minimise a force metric on some time ranges, score it on others.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "harness/metrics/metric.h"
#include "harness/metrics/time_ranges.h"
#include "harness/pipeline/evaluation/request.h"
#include "harness/pipeline/fitting/parameter.h"
#include "harness/recording_checks/repeat_floor.h"
#include "harness/rendering/catalogue.h"
#include "harness/report/provenance.h"

namespace touchstone::pipeline {

struct FitRequest {
  EvaluationRequest evaluation;  // recording, mesh, model, in-trajectory, ...
  std::vector<std::string> parameters;
  std::string metric = "rms_force_error";
  metrics::TimeRanges fit_range;
  metrics::TimeRanges score_range;
};

struct Estimate {
  FitParameter parameter;
  double value = 0.0;
  bool interval_known = false;
  double low95 = 0.0;
  double high95 = 0.0;
  // The metric over this parameter, the others adjusted at each place.
  std::vector<double> profile_value;
  std::vector<double> profile_metric;
};

struct FitResult {
  std::string title;
  std::string metric;
  std::string metric_unit;
  std::vector<Estimate> estimates;
  double fit_before = 0.0;  // the metric with the model as it was given
  double fit_after = 0.0;
  double score_before = 0.0;
  double score_after = 0.0;
  std::string fit_range, score_range;
  std::size_t fit_samples = 0, score_samples = 0;
  std::size_t evaluations = 0;
  std::string interval_note;                           // how the intervals were made, or why there are none
  std::vector<std::string> warnings;                   // on a bound, flat, faults of the mesh
  std::vector<std::string> notes;                      // what else is to be said of mesh and recordings
  std::optional<recording_checks::RepeatFloor> floor;  // where a repeat of the recording was given
  std::vector<metrics::MetricResult> score_metrics;    // of the fitted model
  std::vector<metrics::Series> signals;                // measured_x ..., rendered_x ..., over the whole recording
  std::vector<std::pair<double, double>> fit_bands;    // time ranges that were fitted
  rendering::Model model;                              // with the estimates
  std::string model_text;
  report::Provenance provenance;
};

// Throws as load_inputs() does; UsageError for parameters or metrics that do not exist, for ranges with no samples, and
// for a stiffness that is to be fitted to an in-trajectory that was made with it.
FitResult run_fit(const rendering::Catalogue& catalogue, const FitRequest& request);

}  // namespace touchstone::pipeline
