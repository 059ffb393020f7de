#include "harness/recording/resample.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>

#include "harness/base/error.h"

namespace touchstone::recording {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

// Where a target time lies: at or after sample `lower`, among the samples [begin, end) that no gap divides.
struct Bracket {
  std::size_t lower;
  std::size_t begin;
  std::size_t end;
};

class Clock {
 public:
  Clock(const std::vector<double>& t_s, const ResampleOptions& options) : t_(t_s), options_(options), end_(t_s.size()) {
    std::size_t begin = 0;
    for (std::size_t i = 0; i < t_.size(); ++i) {
      const bool last = i + 1 == t_.size();
      if (!last && !(t_[i + 1] > t_[i])) throw std::invalid_argument("resample: the sampling times do not increase");
      if (!last && !(options.longest_gap_s > 0.0 && t_[i + 1] - t_[i] > options.longest_gap_s)) continue;
      std::fill(end_.begin() + static_cast<std::ptrdiff_t>(begin), end_.begin() + static_cast<std::ptrdiff_t>(i) + 1,
                i + 1);
      begin = i + 1;
      begins_.push_back(begin);
    }
  }

  // False outside the recorded span or within a gap; then throws where the options say so.
  bool find(double time, Bracket& bracket) const {
    const auto after = std::ranges::upper_bound(t_, time);
    if (after != t_.begin()) {
      bracket.lower = static_cast<std::size_t>(after - t_.begin()) - 1;
      bracket.end = end_[bracket.lower];
      bracket.begin = *(std::ranges::upper_bound(begins_, bracket.lower) - 1);
      if (time == t_[bracket.lower] || bracket.lower + 1 < bracket.end) return true;
    }
    if (!options_.refuse) return false;
    if (after == t_.begin() || after == t_.end()) {
      throw BadData(fmt::format("no value at t = {} s: the samples span {} to {} s", time, t_.front(), t_.back()));
    }
    throw BadData(
        fmt::format("no value at t = {} s: it lies in a gap of {:.6g} s after t = {} s, and the longest that is "
                    "bridged is {:.6g} s",
                    time, *after - *(after - 1), *(after - 1), options_.longest_gap_s));
  }

 private:
  const std::vector<double>& t_;
  const ResampleOptions& options_;
  std::vector<std::size_t> end_;
  std::vector<std::size_t> begins_{0};
};

template <class T>
T at_line(const std::vector<double>& t, const std::vector<T>& values, std::size_t i, double time) {
  const double u = (time - t[i]) / (t[i + 1] - t[i]);
  return values[i] * (1.0 - u) + values[i + 1] * u;
}

// Lagrange's polynomial through up to 4 samples around the time.
template <class T>
T at_cubic(const std::vector<double>& t, const std::vector<T>& values, const Bracket& bracket, double time) {
  const std::size_t count = std::min<std::size_t>(4, bracket.end - bracket.begin);
  std::size_t first = bracket.lower > bracket.begin ? bracket.lower - 1 : bracket.begin;
  first = std::min(first, bracket.end - count);
  T sum = values[first] * 0.0;
  for (std::size_t j = 0; j < count; ++j) {
    double weight = 1.0;
    for (std::size_t k = 0; k < count; ++k) {
      if (k != j) weight *= (time - t[first + k]) / (t[first + j] - t[first + k]);
    }
    sum += values[first + j] * weight;
  }
  return sum;
}

// The value at `time` of the straight line that fits the samples best under Hann weights.
template <class T>
T at_average(const std::vector<double>& t, const std::vector<T>& values, const Bracket& bracket, double time,
             double half_width) {
  double s0 = 0.0;
  double s1 = 0.0;
  double s2 = 0.0;
  T v0 = values[bracket.lower] * 0.0;
  T v1 = v0;
  const auto add = [&](std::size_t i) {
    const double u = (t[i] - time) / half_width;
    if (std::abs(u) >= 1.0) return false;
    const double w = 0.5 * (1.0 + std::cos(std::numbers::pi * u));
    s0 += w;
    s1 += w * u;
    s2 += w * u * u;
    v0 += values[i] * w;
    v1 += values[i] * (w * u);
    return true;
  };
  for (std::size_t i = bracket.lower + 1; i-- > bracket.begin && add(i);) {
  }
  for (std::size_t i = bracket.lower + 1; i < bracket.end && add(i); ++i) {
  }
  const double determinant = s0 * s2 - s1 * s1;
  // Too few samples under the window for a line: the source is not faster than the target here.
  if (!(determinant > 1e-9 * s0 * s2)) {
    return time == t[bracket.lower] ? values[bracket.lower] : at_line(t, values, bracket.lower, time);
  }
  return (v0 * s2 - v1 * s1) / determinant;
}

template <class T>
T at(const std::vector<double>& t, const std::vector<T>& values, const Bracket& bracket, double time,
     const ResampleOptions& options) {
  if (options.method == Interpolation::windowed_average) {
    return at_average(t, values, bracket, time, 1.0 / options.target_rate_Hz);
  }
  if (time == t[bracket.lower] || options.method == Interpolation::zero_order_hold) return values[bracket.lower];
  if (options.method == Interpolation::linear) return at_line(t, values, bracket.lower, time);
  return at_cubic(t, values, bracket, time);
}

Quat at(const std::vector<double>& t, const std::vector<Quat>& values, const Bracket& bracket, double time,
        const ResampleOptions& options) {
  const std::size_t i = bracket.lower;
  if (time == t[i] || options.method == Interpolation::zero_order_hold) return values[i];
  return values[i].slerp((time - t[i]) / (t[i + 1] - t[i]), values[i + 1]);
}

template <class T>
Resampled<T> resample_any(const std::vector<double>& t_s, const std::vector<T>& values,
                          const std::vector<double>& target_s, const ResampleOptions& options, const T& missing) {
  if (t_s.size() != values.size() || t_s.size() < 2) {
    throw std::invalid_argument(fmt::format("resample: {} values at {} times", values.size(), t_s.size()));
  }
  if (options.method == Interpolation::windowed_average && !(options.target_rate_Hz > 0.0)) {
    throw std::invalid_argument("resample: a windowed average needs the target rate");
  }
  const Clock clock(t_s, options);
  Resampled<T> result;
  result.values.reserve(target_s.size());
  result.valid.reserve(target_s.size());
  for (const double time : target_s) {
    Bracket bracket{};
    const bool found = clock.find(time, bracket);
    result.valid.push_back(found ? 1 : 0);
    result.values.push_back(found ? at(t_s, values, bracket, time, options) : missing);
  }
  return result;
}

}  // namespace

std::string name_of(Interpolation method) {
  switch (method) {
    case Interpolation::zero_order_hold:
      return "zero-order hold";
    case Interpolation::linear:
      return "linear interpolation";
    case Interpolation::cubic:
      return "cubic interpolation (4 points)";
    case Interpolation::windowed_average:
      return "local linear average under a Hann window";
  }
  return "";
}

Resampled<Vec3> resample(const std::vector<double>& t_s, const std::vector<Vec3>& values,
                         const std::vector<double>& target_s, const ResampleOptions& options) {
  return resample_any<Vec3>(t_s, values, target_s, options, Vec3::Constant(nan));
}

Resampled<double> resample(const std::vector<double>& t_s, const std::vector<double>& values,
                           const std::vector<double>& target_s, const ResampleOptions& options) {
  return resample_any<double>(t_s, values, target_s, options, nan);
}

Resampled<Quat> resample(const std::vector<double>& t_s, const std::vector<Quat>& values,
                         const std::vector<double>& target_s, const ResampleOptions& options) {
  ResampleOptions rotation = options;
  if (rotation.method != Interpolation::zero_order_hold) rotation.method = Interpolation::linear;
  return resample_any<Quat>(t_s, values, target_s, rotation, Quat(0.0, 0.0, 0.0, 0.0));
}

std::vector<double> uniform_times(double start_s, double end_s, double rate_Hz) {
  if (!(rate_Hz > 0.0) || !(end_s >= start_s)) throw std::invalid_argument("uniform_times: no rate or no span");
  std::vector<double> times;
  for (std::size_t i = 0;; ++i) {
    const double time = start_s + static_cast<double>(i) / rate_Hz;
    if (time > end_s) return times;
    times.push_back(time);
  }
}

}  // namespace touchstone::recording
