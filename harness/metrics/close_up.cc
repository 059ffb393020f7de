#include "harness/metrics/close_up.h"

#include <algorithm>
#include <utility>

namespace touchstone::metrics {

void CloseUpRecorder::Clip::add(const Point& point) {
  measured.add(point.t_s, point.measured_N);
  rendered.add(point.t_s, point.rendered_N);
  error.add(point.t_s, point.error_N);
  if (point.error_N > worst) worst = point.error_N, worst_t_s = point.t_s;
}

void CloseUpRecorder::add(const MetricSample& sample) {
  const Point point{sample.t_s, sample.f_measured_W_N.norm(), sample.f_rendered_W_N.norm(),
                    (sample.f_measured_W_N - sample.f_rendered_W_N).norm()};
  const bool over = point.error_N > threshold_N_;
  if (!open_ && over) {
    open_ = true;
    clip_ = Clip{};
    for (const Point& earlier : before_) clip_.add(earlier);
  }
  if (open_) {
    clip_.add(point);
    quiet_ = over ? 0 : quiet_ + 1;
    if (quiet_ == margin) close();
  }
  before_.push_back(point);
  if (before_.size() > margin) before_.pop_front();
}

void CloseUpRecorder::close() {
  open_ = false;
  quiet_ = 0;
  const auto place = std::ranges::upper_bound(worst_, clip_.worst, std::greater<>{}, &Clip::worst);
  worst_.insert(place, std::move(clip_));
  if (worst_.size() > kept) worst_.pop_back();
}

std::vector<CloseUp> CloseUpRecorder::worst() {
  if (open_) close();
  std::vector<CloseUp> out;
  out.reserve(worst_.size());
  for (const Clip& clip : worst_) {
    out.push_back({clip.worst, clip.worst_t_s, {clip.measured.series(), clip.rendered.series(), clip.error.series()}});
  }
  return out;
}

}  // namespace touchstone::metrics
