// What a metric sees and what it answers. Metrics stream: one add() per sample, memory bounded whatever the length, so
// that recordings of ten million samples need no more than short ones.
// Source of the set: Ruffaldi et al. 2006, section 3.3 (force error, position error, computational cost).
#pragma once

#include <cstddef>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "harness/base/vec.h"
#include "harness/metrics/histogram.h"
#include "harness/metrics/series.h"

namespace touchstone::metrics {

// One instant of an evaluation: measured and rendered, at the same time. SI; the object's frame W; forces are ON the
// probe BY the object.
struct MetricSample {
  double t_s = 0.0;
  Vec3 f_measured_W_N = Vec3::Zero();
  Vec3 f_rendered_W_N = Vec3::Zero();
  Vec3 out_W_m = Vec3::Zero();      // out-trajectory: where the real probe was, never inside the surface
  Vec3 contact_W_m = Vec3::Zero();  // surface contact point that the renderer answered; the tip itself when free
  double cost_us = 0.0;             // time of the step
};

// Which members of MetricSample carry something in this evaluation. A metric whose input is absent is `missing`.
struct MetricInputs {
  bool force = true;
  bool position = true;
  bool cost = true;
};

// What counts as contact and what counts as too much. Chosen from the recording and stated in the report.
struct MetricOptions {
  double force_floor_N = 0.05;           // contact begins when the force rises through it; no angle below it
  double force_threshold_N = 0.1;        // force episodes: error above it
  double position_threshold_m = 0.5e-3;  // position episodes: error above it (0.5 mm: the 2006 paper's tracker)
  double match_window_s = 0.25;          // onsets (releases) further apart are not the same event
};

enum class MetricStatus {
  ok,
  missing,  // the input it needs is not there, or no sample qualified
  invalid,  // an input was not finite: there is no number
};

struct MetricResult {
  std::string name;                                         // rms_force_error
  std::string unit;                                         // N, m, s, us, deg, or 1 for counts
  double value = std::numeric_limits<double>::quiet_NaN();  // NaN unless status is ok
  MetricStatus status = MetricStatus::missing;
  std::string meaning;  // one sentence for the reader of a report
  std::string note;     // why it is missing or invalid, or a qualification (floor, window, error bound)
  // What to hold the value against, with its meaning: "RMS of the measured force", the score of answering zero.
  std::optional<double> reference;
  std::string reference_meaning;
  std::optional<double> t_s;  // when, for maxima
  std::optional<Series> series;
  std::optional<Histogram> histogram;
};

class Metric {
 public:
  virtual ~Metric() = default;
  virtual void add(const MetricSample& sample) = 0;
  // After the last sample. Always the same names in the same order, also where the status is not ok.
  [[nodiscard]] virtual std::vector<MetricResult> results() = 0;
};

}  // namespace touchstone::metrics
