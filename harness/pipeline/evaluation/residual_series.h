// A renderer's force beside the measured one, and what a repair of it gains (renderer_residual.h).
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "harness/base/vec.h"

namespace touchstone::pipeline {

// A repair must take half of the squared error, in each half of the recording: what a misfit of another kind looks like
// by chance seldom does so once, and not twice with the same repair.
inline constexpr double kept_share = 0.5;

struct Half {
  std::size_t from = 0, to = 0;
};

// What was measured and what was rendered, sample by sample.
class ResidualSeries {
 public:
  ResidualSeries(const std::vector<double>& t_s, const std::vector<Vec3>& tip, const std::vector<Vec3>& contact,
                 const std::vector<Vec3>& measured, const std::vector<Vec3>& rendered)
      : t_s_(t_s), tip_(tip), contact_(contact), measured_(measured), rendered_(rendered) {}

  [[nodiscard]] std::size_t size() const { return t_s_.size(); }
  [[nodiscard]] std::array<Half, 2> halves() const { return {{{0, size() / 2}, {size() / 2, size()}}}; }

  // Mean square of what a repair of the rendered force leaves.
  template <class Repair>
  [[nodiscard]] double left(const Half& half, const Repair& repair) const {
    // Some thousands of samples tell as much as all: one of each part, at a place that follows no period.
    constexpr std::size_t enough = 3000;
    static const std::vector<double> places = places_of_parts(enough);
    const std::size_t size = half.to - half.from, n = std::min(size, enough);
    const double part = static_cast<double>(size) / static_cast<double>(n);
    double sum = 0.0;
    for (std::size_t k = 0; k < n; ++k) {
      const double place = n == size ? 0.0 : places[k];
      const std::size_t i = half.from + static_cast<std::size_t>((static_cast<double>(k) + place) * part);
      sum += (repair(i) - measured_[i]).squaredNorm();
    }
    return sum / static_cast<double>(n);
  }
  [[nodiscard]] double as_it_is(const Half& half) const {
    return left(half, [&](std::size_t i) { return rendered_[i]; });
  }
  template <class Repair>
  [[nodiscard]] bool gains_in_both(const Repair& repair) const {
    return std::ranges::all_of(halves(), [&](const Half& half) {
      const double before = as_it_is(half);
      return before > 0.0 && left(half, repair) < kept_share * before;
    });
  }
  [[nodiscard]] std::string gain(double after) const {
    return fmt::format("the RMS force error would be {:.3g} N in place of {:.3g} N", std::sqrt(after),
                       std::sqrt(as_it_is({0, size()})));
  }

  // The rendered force as it is `lag_s` later, linear between samples.
  [[nodiscard]] Vec3 later(std::size_t i, double lag_s) const {
    const double t = t_s_[i] + lag_s;
    if (t <= t_s_.front()) return rendered_.front();
    if (t >= t_s_.back()) return rendered_.back();
    const std::size_t k = first_after(t);
    const double share = (t - t_s_[k - 1]) / (t_s_[k] - t_s_[k - 1]);
    return (1.0 - share) * rendered_[k - 1] + share * rendered_[k];
  }

  // Whether the tip is elsewhere in every sample of [from, to).
  [[nodiscard]] bool moves(std::size_t from, std::size_t to) const {
    for (std::size_t i = from + 1; i < to; ++i) {
      if (tip_[i] == tip_[i - 1]) return false;
    }
    return true;
  }

  // The first sample after a time within the series: where it would be were all steps equal, or in doubling distances
  // around that.
  [[nodiscard]] std::size_t first_after(double t) const {
    const auto last = static_cast<double>(size() - 1);
    const double share = (t - t_s_.front()) / (t_s_.back() - t_s_.front());
    const auto guess = static_cast<std::size_t>(std::clamp(share * last, 0.0, last));
    std::size_t low = guess, high = guess + 1, step = 1;
    while (low > 0 && t_s_[low] > t) low -= std::min(low, std::exchange(step, 2 * step));
    for (step = 1; high < size() && !(t_s_[high] > t); step *= 2) high += step;
    const auto begin = t_s_.begin() + static_cast<std::ptrdiff_t>(low);
    const auto end = t_s_.begin() + static_cast<std::ptrdiff_t>(std::min(high + 1, size()));
    return static_cast<std::size_t>(std::upper_bound(begin, end, t) - t_s_.begin());
  }

  const std::vector<double>& t_s_;
  const std::vector<Vec3>&tip_, &contact_, &measured_, &rendered_;

 private:
  static std::vector<double> places_of_parts(std::size_t n) {
    std::vector<double> places(n);
    for (std::size_t k = 0; k < n; ++k) places[k] = std::fmod(std::numbers::phi * static_cast<double>(k), 1.0);
    return places;
  }
};

struct Found {
  double left = 0.0;   // mean square
  std::string repair;  // what it would take, for the list of what else was considered
  std::string text;
};

}  // namespace touchstone::pipeline
