#include "harness/metrics/series.h"

#include <cmath>
#include <utility>

#include "harness/base/error.h"

namespace touchstone::metrics {

SeriesRecorder::SeriesRecorder(std::string name, std::string unit, std::size_t most_points)
    : name_(std::move(name)), unit_(std::move(unit)), most_points_(most_points) {
  if (most_points < 4 || (most_points & (most_points - 1)) != 0) {
    throw UsageError("a series keeps a power of two of points, at least 4");
  }
}

void SeriesRecorder::widen(Run& run, const Run& by) {
  // A run that is not finite stays in the series only where nothing finite shares its place.
  if (!std::isfinite(run.minimum)) {
    run = by;
    return;
  }
  if (!std::isfinite(by.minimum)) return;
  if (by.minimum < run.minimum) run.t_min_s = by.t_min_s, run.minimum = by.minimum;
  if (by.maximum > run.maximum) run.t_max_s = by.t_max_s, run.maximum = by.maximum;
}

void SeriesRecorder::halve() {
  std::size_t kept = 0;
  for (std::size_t i = 0; i < runs_.size(); i += 2, ++kept) {
    Run merged = runs_[i];
    if (i + 1 < runs_.size()) widen(merged, runs_[i + 1]);
    runs_[kept] = merged;
  }
  runs_.resize(kept);
}

void SeriesRecorder::add(double t_s, double value) {
  ++samples_;
  const Run one{t_s, value, t_s, value};
  if (!runs_.empty() && in_last_ < run_length_) {
    widen(runs_.back(), one);
    ++in_last_;
    return;
  }
  // Single samples take one point, runs take two: full at most_points single samples or half as many runs.
  const std::size_t room = run_length_ == 1 ? most_points_ : most_points_ / 2;
  if (runs_.size() == room) {
    do {
      halve();
      run_length_ *= 2;
    } while (runs_.size() > most_points_ / 4);
  }
  runs_.push_back(one);
  in_last_ = 1;
}

Series SeriesRecorder::series() const {
  Series out{name_, unit_, {}, {}, samples_, run_length_};
  out.t_s.reserve(runs_.size() * 2);
  out.value.reserve(runs_.size() * 2);
  const auto point = [&out](double t_s, double value) {
    out.t_s.push_back(t_s);
    out.value.push_back(std::isfinite(value) ? value : std::nan(""));
  };
  for (const Run& run : runs_) {
    if (run.t_min_s == run.t_max_s) {
      point(run.t_min_s, run.minimum);
    } else if (run.t_min_s < run.t_max_s) {
      point(run.t_min_s, run.minimum);
      point(run.t_max_s, run.maximum);
    } else {
      point(run.t_max_s, run.maximum);
      point(run.t_min_s, run.minimum);
    }
  }
  return out;
}

}  // namespace touchstone::metrics
