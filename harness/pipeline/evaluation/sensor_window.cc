#include "harness/pipeline/evaluation/sensor_window.h"

#include <utility>

#include "harness/rendering/measured_renderer.h"

namespace touchstone::pipeline {
namespace {

// Large beside any halo in practice, so that little is computed twice; a longer halo makes the window longer.
constexpr std::size_t least_window = 16384;

}  // namespace

SensorWindow::SensorWindow(const rendering::MeasuredRenderer& comparison, Sink sink)
    : comparison_(comparison), sink_(std::move(sink)), halo_s_(comparison.halo_s()) {}

void SensorWindow::add(const ComparedSample& sample) {
  if (!comparison_.has_instrument()) {
    sink_(sample);
    return;
  }
  held_.push_back(sample);
  if (held_.size() >= least_window + 2 * done_) flush(false);
}

void SensorWindow::finish() {
  if (!held_.empty()) flush(true);
  held_.clear();
  done_ = 0;
}

void SensorWindow::flush(bool all) {
  std::vector<double> t_s;
  std::vector<Vec3> p_W_m, f_W_N;
  std::vector<Quat> q_WS;
  for (const ComparedSample& sample : held_) {
    t_s.push_back(sample.metric.t_s);
    p_W_m.push_back(sample.p_W_m);
    q_WS.push_back(sample.q_WS);
    f_W_N.push_back(sample.metric.f_rendered_W_N);
  }
  comparison_.apply({t_s, p_W_m, q_WS}, f_W_N);
  const double last_s = t_s.back();
  std::size_t i = done_;
  for (; i < held_.size() && (all || t_s[i] + halo_s_ < last_s); ++i) {
    ComparedSample out = held_[i];
    out.metric.f_rendered_W_N = f_W_N[i];
    sink_(out);
  }
  // What the next sample still looks back at stays.
  std::size_t keep = 0;
  while (keep < i && (i == held_.size() || t_s[keep] + halo_s_ < t_s[i])) ++keep;
  // One more on the far side, for what interpolates.
  if (keep > 0) --keep;
  held_.erase(held_.begin(), held_.begin() + static_cast<std::ptrdiff_t>(keep));
  done_ = i - keep;
}

}  // namespace touchstone::pipeline
