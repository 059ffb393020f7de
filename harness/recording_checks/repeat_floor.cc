#include "harness/recording_checks/repeat_floor.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "harness/base/error.h"
#include "harness/recording/recording_file.h"
#include "harness/recording_checks/at_times.h"
#include "harness/stats/distributions.h"

namespace touchstone::recording_checks {
using recording::Recording;

namespace {

constexpr std::size_t stretch_count = 10;

struct Difference {
  double force = 0.0, position = std::numeric_limits<double>::infinity(), shared_s = 0.0;
  double steadiest = 0.0, least_steady = 0.0;  // force, of the stretches that hold samples
  double mean_square_error = 0.0;              // of the force's mean square, by its spread over the stretches
};

// Times count from the first sample of each: the second begins when its operator pressed the button.
Difference difference_at(const Recording& a, const Recording& b, double shift_s, std::size_t stride) {
  AtTimes there(b);
  double force = 0.0, position = 0.0, first = 0.0, last = 0.0;
  std::array<double, stretch_count> squares{};
  std::array<std::size_t, stretch_count> counts{};
  std::size_t n = 0;
  for (std::size_t i = 0; i < a.size(); i += stride) {
    if (!there.find(a.motion.t_s[i] - a.motion.t_s.front() + b.motion.t_s.front() + shift_s)) continue;
    const double square = (a.f_W_N[i] - there.force_N()).squaredNorm();
    const std::size_t stretch = i * stretch_count / a.size();
    squares[stretch] += square, ++counts[stretch];
    force += square;
    position += (a.motion.p_W_m[i] - there.position_m()).squaredNorm();
    if (n++ == 0) first = a.motion.t_s[i];
    last = a.motion.t_s[i];
  }
  if (n == 0) return {};
  const auto count = static_cast<double>(n);
  Difference d{std::sqrt(force / count), std::sqrt(position / count), last - first, 0.0, 0.0, 0.0};
  d.steadiest = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < stretch_count; ++k) {
    if (counts[k] == 0) continue;
    const double rms = std::sqrt(squares[k] / static_cast<double>(counts[k]));
    d.steadiest = std::min(d.steadiest, rms), d.least_steady = std::max(d.least_steady, rms);
    // A mean of unequal stretches, each weighed by its samples: its variance is the sum of the squared deviations.
    d.mean_square_error += std::pow((squares[k] - static_cast<double>(counts[k]) * force / count) / count, 2);
  }
  d.mean_square_error = std::sqrt(d.mean_square_error);
  return d;
}

}  // namespace

std::string RepeatFloor::text() const {
  constexpr double shown_ms = 0.1;
  std::string text =
      fmt::format("{:.3g} N ({}; {:.3g} mm in position, over {:.4g} s; {:.2g} to {:.2g} N by tenths of that time",
                  force_N, source, 1e3 * position_m, shared_s, steadiest_N, least_steady_N);
  if (std::abs(1e3 * shift_s) > shown_ms) {
    text += fmt::format("; it starts {:.3g} ms {}, {:.3g} N without taking that out", std::abs(1e3 * shift_s),
                        shift_s > 0.0 ? "later" : "earlier", unshifted_N);
  }
  return text + ")";
}

std::string RepeatFloor::verdict(double error_N) const {
  const std::string floor = fmt::format("the floor of {:.3g} N that the repeat {} gives", force_N, source);
  if (!(error_N > within_N)) return "within " + floor;
  return fmt::format("{:.3g} times {}", error_N / force_N, floor);
}

RepeatFloor repeat_floor(const Recording& first, const Recording& second) {
  for (const Recording* const one : {&first, &second}) {
    if (one->size() < 2 || one->f_W_N.size() != one->size()) {
      throw BadData(fmt::format("{}: at least two samples of time, position and force were expected", one->source));
    }
  }
  // The shift at which the positions agree best, found on a grid that narrows.
  constexpr double farthest_s = 1.0;
  constexpr double coarse_step_s = 0.05;
  constexpr std::size_t looked_at = 2000;
  const double duration_s = first.motion.t_s.back() - first.motion.t_s.front();
  const double interval_s = duration_s / static_cast<double>(first.size() - 1);
  const std::size_t stride = first.size() / looked_at + 1;
  double shift_s = 0.0, least = difference_at(first, second, 0.0, stride).position;
  double reach_s = farthest_s;
  for (double step_s = coarse_step_s; step_s > 0.02 * interval_s; reach_s = step_s, step_s /= 5.0) {
    const double centre_s = shift_s;
    const int steps = static_cast<int>(std::ceil(reach_s / step_s));
    for (int k = -steps; k <= steps; ++k) {
      const double at_s = centre_s + k * step_s;
      const double position = difference_at(first, second, at_s, stride).position;
      if (position < least) least = position, shift_s = at_s;
    }
  }
  const Difference d = difference_at(first, second, shift_s, 1);
  Box3 box;
  for (const Vec3& p : first.motion.p_W_m) box.extend(p);
  const double extent = box.diagonal().norm();
  if (!(d.position <= 0.2 * extent) || !(d.shared_s >= 0.5 * duration_s)) {
    throw BadData(
        fmt::format("{}: does not repeat {}: at equal times the positions differ by {:.3g} m of {:.3g} m, over "
                    "{:.3g} s of {:.3g} s; a second run of the same motion was expected",
                    second.source, first.source, d.position, extent, d.shared_s, duration_s));
  }
  constexpr double of_one = 1.0 / std::numbers::sqrt2;
  const double chance = stats::student_t_975(static_cast<double>(stretch_count - 1)) * d.mean_square_error;
  return {of_one * d.force,
          of_one * std::sqrt(d.force * d.force + chance),
          of_one * d.position,
          shift_s,
          of_one * difference_at(first, second, 0.0, 1).force,
          of_one * d.steadiest,
          of_one * d.least_steady,
          d.shared_s,
          std::filesystem::path(second.source).filename().string()};
}

RepeatFloor repeat_floor_of_files(const std::filesystem::path& first, const std::filesystem::path& second) {
  return repeat_floor(recording::load_recording(first), recording::load_recording(second));
}

}  // namespace touchstone::recording_checks
