#include "harness/metrics/episodes.h"

#include <fmt/format.h>

#include <algorithm>

#include "harness/metrics/result.h"

namespace touchstone::metrics {
namespace {

bool worse(const Episode& a, const Episode& b) {
  return a.worst > b.worst || (a.worst == b.worst && a.start_s < b.start_s);
}

}  // namespace

void EpisodeFinder::add(double t_s, double error, const Vec3& contact_W_m) {
  last_t_s_ = t_s;
  // Written so that an error that is not a number is over no threshold and closes none: Moments make it invalid.
  if (error > threshold_) {
    if (!open_) {
      open_ = true;
      current_ = Episode{t_s, t_s, error, t_s, contact_W_m, 0};
    }
    ++current_.samples;
    if (error > current_.worst) {
      current_.worst = error;
      current_.worst_t_s = t_s;
      current_.worst_W_m = contact_W_m;
    }
  } else if (open_ && error <= threshold_) {
    close(t_s);
  }
}

void EpisodeFinder::close(double t_s) {
  open_ = false;
  current_.end_s = t_s;
  ++count_;
  total_s_.add(current_.end_s - current_.start_s);
  if (worst_.size() == kept && !worse(current_, worst_.back())) return;
  if (worst_.size() == kept) worst_.pop_back();
  worst_.insert(std::upper_bound(worst_.begin(), worst_.end(), current_, worse), current_);
}

std::vector<Episode> EpisodeFinder::worst() {
  if (open_) close(last_t_s_);
  return worst_;
}

ErrorEpisodes::ErrorEpisodes(Of of, const MetricOptions& options)
    : of_(of),
      threshold_(of == Of::position ? options.position_threshold_m : options.force_threshold_N),
      finder_(threshold_) {}

void ErrorEpisodes::add(const MetricSample& sample) {
  const double error = of_ == Of::position ? (sample.contact_W_m - sample.out_W_m).norm()
                                           : (sample.f_measured_W_N - sample.f_rendered_W_N).norm();
  error_.add(sample.t_s, error);
  finder_.add(sample.t_s, error, sample.contact_W_m);
}

std::vector<MetricResult> ErrorEpisodes::results() {
  const bool position = of_ == Of::position;
  const std::string what = position ? "position" : "force";
  const std::string threshold =
      position ? fmt::format("threshold {:.4g} mm", threshold_ * 1e3) : fmt::format("threshold {:.4g} N", threshold_);
  auto count = make_result(fmt::format("{}_episodes", what), "1",
                           fmt::format("How many times the {} error rose over the threshold.", what),
                           static_cast<double>(finder_.count()), error_);
  auto time = make_result(fmt::format("time_over_{}_threshold", what), "s",
                          fmt::format("How long the {} error was over the threshold altogether.", what),
                          finder_.total_s(), error_);
  for (auto* const result : {&count, &time}) {
    if (result->status == MetricStatus::ok) result->note = threshold;
  }
  return {std::move(count), std::move(time)};
}

}  // namespace touchstone::metrics
