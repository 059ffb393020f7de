// Instrument entries of a model look at neighbouring samples (a time lag, an acceleration); here they run on a stream,
// window by window, with as much on either side as they look at.
#pragma once

#include <functional>
#include <vector>

#include "harness/metrics/metric.h"
#include "harness/rendering/measured_renderer.h"

namespace touchstone::pipeline {

// A sample on its way to the metrics.
struct ComparedSample {
  metrics::MetricSample metric;  // f_rendered_W_N still as the renderer answered
  Vec3 p_W_m = Vec3::Zero();     // the tip as measured
  Quat q_WS = Quat::Identity();
  Vec3 surface_W_m = Vec3::Zero();  // the point of the surface that was touched
  bool touching = false;            // by the measurement or by the renderer
};

class SensorWindow {
 public:
  using Sink = std::function<void(const ComparedSample&)>;

  SensorWindow(const rendering::MeasuredRenderer& comparison, Sink sink);
  void add(const ComparedSample& sample);
  // After the last sample, and before a gap over which nothing acts.
  void finish();

 private:
  void flush(bool all);

  const rendering::MeasuredRenderer& comparison_;
  Sink sink_;
  double halo_s_;
  std::vector<ComparedSample> held_;
  std::size_t done_ = 0;  // of held_, kept only because later samples look back at them
};

}  // namespace touchstone::pipeline
