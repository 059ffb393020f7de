// What is wrong with a renderer, by what it gives beside what was measured: is its force late, filtered, held, late in
// single samples, mirrored or with exchanged axes, larger when pressed than when released, cut at a limit, in steps, or
// missing in single samples, or its contact point held? What a repair can take away is a model of the residual with
// what the repair gains, and is said only if it gains the most and does so in both halves of the recording, with the
// repairs that gain nearly as much beside it; the rest is seen of what was rendered. A recording can have the same
// fault (its clocks, its axes), which the recording's own checks look for (harness/recording_checks): where both are
// possible, both are said.
#pragma once

#include <string>
#include <vector>

#include "harness/metrics/metric.h"

namespace touchstone::pipeline {

class RendererResidual {
 public:
  // In the order of time; a gap in time may stand between two. Longer recordings are judged by their beginning.
  void add(const metrics::MetricSample& sample, const Vec3& tip_W_m);
  // One sentence for each fault, with the RMS force error before and after; empty where there is none, or too little.
  [[nodiscard]] std::vector<std::string> faults() const;

 private:
  std::vector<double> t_s_;
  std::vector<Vec3> tip_W_m_, contact_W_m_, measured_N_, rendered_N_;
};

}  // namespace touchstone::pipeline
