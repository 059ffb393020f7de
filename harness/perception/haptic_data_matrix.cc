#include "harness/perception/haptic_data_matrix.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "harness/base/error.h"
#include "harness/stats/quantile.h"

namespace touchstone::perception {
namespace {

std::vector<double> intervals(const std::vector<double>& t_s) {
  std::vector<double> result;
  result.reserve(t_s.size());
  for (std::size_t i = 1; i < t_s.size(); ++i) result.push_back(t_s[i] - t_s[i - 1]);
  return result;
}

void check_column(const PressSignal& part, const std::vector<double>& column, const char* what, bool optional) {
  if (optional && column.empty()) return;
  if (column.size() != part.t_s.size()) {
    throw BadData(fmt::format("{}: {} has {} values for {} times; every column needs one value per time", part.name,
                              what, column.size(), part.t_s.size()));
  }
  for (std::size_t i = 0; i < column.size(); ++i) {
    if (!std::isfinite(column[i])) {
      throw BadData(
          fmt::format("{}: {} of sample {} (t = {} s) is {}, not a finite number; remove or repair the sample",
                      part.name, what, i + 1, part.t_s[i], column[i]));
    }
  }
}

void check(const PressSignal& part, double longest_gap) {
  check_column(part, part.t_s, "time", false);
  check_column(part, part.force_N, "force", false);
  check_column(part, part.displacement_m, "displacement", false);
  check_column(part, part.angle_rad, "angle", true);
  check_column(part, part.acceleration_m_per_s2, "acceleration", true);
  if (part.t_s.size() < 4) {
    throw BadData(fmt::format("{}: {} samples are too few for rates of change; at least 4 are needed", part.name,
                              part.t_s.size()));
  }
  double shortest = std::numeric_limits<double>::infinity();
  double longest = 0.0;
  for (std::size_t i = 1; i < part.t_s.size(); ++i) {
    const double dt = part.t_s[i] - part.t_s[i - 1];
    if (!(dt > 0.0)) {
      throw BadData(fmt::format("{}: time does not advance from sample {} to {} ({} s to {} s)", part.name, i, i + 1,
                                part.t_s[i - 1], part.t_s[i]));
    }
    shortest = std::min(shortest, dt);
    longest = std::max(longest, dt);
  }
  if (longest <= longest_gap * shortest) return;  // no median can make a hole of that
  const auto dt = intervals(part.t_s);
  const double typical = stats::median(dt);
  for (std::size_t i = 0; i < dt.size(); ++i) {
    if (dt[i] > longest_gap * typical) {
      throw BadData(
          fmt::format("{}: a hole of {:.4g} s after t = {:.6g} s, {:.0f} sampling intervals long; cut the "
                      "recording there: nothing is made up over more than {:.0f}",
                      part.name, dt[i], part.t_s[i], dt[i] / typical, longest_gap));
    }
  }
}

struct Resampled {
  const std::vector<double>& from;
  std::vector<double>& to;
};

// Linear interpolation of all columns at first_s + n / rate.
void resample(const std::vector<double>& t_s, double first_s, double rate_Hz, std::size_t count,
              std::span<const Resampled> columns) {
  for (const auto& column : columns) column.to.resize(count);
  std::size_t i = 0;
  for (std::size_t n = 0; n < count; ++n) {
    const double t = first_s + static_cast<double>(n) / rate_Hz;
    while (i + 2 < t_s.size() && t_s[i + 1] <= t) ++i;
    const double share = std::clamp((t - t_s[i]) / (t_s[i + 1] - t_s[i]), 0.0, 1.0);
    for (const auto& [x, result] : columns) result[n] = share == 0.0 ? x[i] : x[i] + share * (x[i + 1] - x[i]);
  }
}

}  // namespace

Eigen::Matrix<double, 2, 4> HapticDataMatrix::observation(std::size_t t, std::size_t part) const {
  const MeasuringPart& p = parts.at(part);
  Eigen::Matrix<double, 2, 4> result;
  result << p.force_N.at(t), p.displacement_m[t], p.angle_rad[t], p.acceleration_m_per_s2[t], p.force_rate_N_per_s[t],
      p.velocity_m_per_s[t], p.displacement_second_rate_m_per_s2[t], p.angle_rate_rad_per_s[t];
  return result;
}

namespace {

double sum_of_squares(std::ptrdiff_t reach) {
  double sum = 0.0;
  for (std::ptrdiff_t k = 1; k <= reach; ++k) sum += 2.0 * static_cast<double>(k * k);
  return sum;
}

}  // namespace

std::vector<double> derivative(std::span<const double> x, double rate_Hz, int half_width) {
  const auto n = static_cast<std::ptrdiff_t>(x.size());
  std::vector<double> result(x.size(), 0.0);
  const auto at = [&x](std::ptrdiff_t index) { return x[static_cast<std::size_t>(index)]; };
  const auto fit = [&](std::ptrdiff_t i, std::ptrdiff_t reach, double squares) {
    double numerator = 0.0;
    for (std::ptrdiff_t k = 1; k <= reach; ++k) numerator += static_cast<double>(k) * (at(i + k) - at(i - k));
    result[static_cast<std::size_t>(i)] = numerator / squares * rate_Hz;
  };
  // Symmetric where it can be: the window shrinks towards the ends; the two end samples use their one neighbour.
  const auto fit_near_end = [&](std::ptrdiff_t i) {
    const std::ptrdiff_t reach = std::min<std::ptrdiff_t>({half_width, i, n - 1 - i});
    if (reach > 0) return fit(i, reach, sum_of_squares(reach));
    const double change = n < 2 ? 0.0 : (i == 0 ? at(1) - at(0) : at(i) - at(i - 1));
    result[static_cast<std::size_t>(i)] = change * rate_Hz;
  };
  const std::ptrdiff_t begin = std::min<std::ptrdiff_t>(half_width, n);
  const std::ptrdiff_t end = std::max<std::ptrdiff_t>(begin, n - half_width);
  for (std::ptrdiff_t i = 0; i < begin; ++i) fit_near_end(i);
  const double squares = sum_of_squares(half_width);
  for (std::ptrdiff_t i = begin; i < end; ++i) fit(i, half_width, squares);
  for (std::ptrdiff_t i = end; i < n; ++i) fit_near_end(i);
  return result;
}

HapticDataMatrix make_haptic_data_matrix(std::span<const PressSignal> parts, const HapticDataMatrixOptions& options) {
  if (parts.empty()) throw BadData("a haptic data matrix needs at least one measuring part");
  if (options.derivative_half_width < 1) throw UsageError("the half width of the derivative must be at least 1 sample");
  for (const auto& part : parts) check(part, options.longest_gap);

  HapticDataMatrix matrix;
  matrix.rate_Hz = options.rate_Hz > 0.0 ? options.rate_Hz : 1.0 / stats::median(intervals(parts.front().t_s));
  double first_s = parts.front().t_s.front();
  double last_s = parts.front().t_s.back();
  for (const auto& part : parts) {
    first_s = std::max(first_s, part.t_s.front());
    last_s = std::min(last_s, part.t_s.back());
  }
  // A hundredth of a sample of slack: rounding of the clock must not cost the last sample.
  const double samples = std::floor((last_s - first_s) * matrix.rate_Hz + 0.01) + 1.0;
  if (!(samples >= 4.0)) {
    throw BadData(
        fmt::format("{}: only {:.3g} s in common with the other parts at {:.4g} Hz; at least 4 samples are needed",
                    parts.front().name, std::max(0.0, last_s - first_s), matrix.rate_Hz));
  }
  if (samples > 1e9)
    throw UsageError(fmt::format("a rate of {:.4g} Hz would need {:.3g} samples", matrix.rate_Hz, samples));
  const auto count = static_cast<std::size_t>(samples);
  for (const auto& raw : parts) {
    const auto rate = [&](const std::vector<double>& x) {
      return derivative(x, matrix.rate_Hz, options.derivative_half_width);
    };
    MeasuringPart part;
    part.name = raw.name;
    std::vector<Resampled> columns{{raw.force_N, part.force_N}, {raw.displacement_m, part.displacement_m}};
    if (raw.angle_rad.empty()) {
      part.angle_rad.assign(count, 0.0);
    } else {
      columns.push_back({raw.angle_rad, part.angle_rad});
    }
    const bool measured_acceleration = options.second_rates && !raw.acceleration_m_per_s2.empty();
    if (measured_acceleration) columns.push_back({raw.acceleration_m_per_s2, part.acceleration_m_per_s2});
    resample(raw.t_s, first_s, matrix.rate_Hz, count, columns);
    part.force_rate_N_per_s = rate(part.force_N);
    part.velocity_m_per_s = rate(part.displacement_m);
    if (options.second_rates) {
      part.displacement_second_rate_m_per_s2 = rate(part.velocity_m_per_s);
      if (!measured_acceleration) part.acceleration_m_per_s2 = part.displacement_second_rate_m_per_s2;
    }
    part.angle_rate_rad_per_s = raw.angle_rad.empty() ? part.angle_rad : rate(part.angle_rad);
    matrix.parts.push_back(std::move(part));
  }
  return matrix;
}

Vec3 press_direction(const recording::Recording& recording) {
  Vec3 sum = Vec3::Zero();
  double magnitudes = 0.0;
  for (const auto& f : recording.f_W_N) {
    sum += f;
    magnitudes += f.norm();
  }
  // Noise of either sign leaves a sum that is small beside the magnitudes.
  if (!(sum.norm() > 0.1 * magnitudes)) {
    throw BadData(
        fmt::format("{}: the force has no direction to take as that of pressing (its sum is {:.3g} N of {:.3g} N "
                    "of magnitudes); name the direction",
                    recording.source, sum.norm(), magnitudes));
  }
  return sum.normalized();
}

PressSignal press_signal(const recording::Recording& recording, const Vec3& outward, double contact_force_N) {
  if (recording.f_W_N.size() != recording.size()) {
    throw BadData(fmt::format("{}: has no force; a perceptual evaluation compares forces", recording.source));
  }
  PressSignal signal;
  signal.name = recording.source;
  signal.t_s = recording.motion.t_s;
  signal.force_N.reserve(recording.size());
  signal.displacement_m.reserve(recording.size());
  double across = 0.0;
  for (const auto& f : recording.f_W_N) {
    signal.force_N.push_back(f.dot(outward));
    across += std::max(0.0, f.squaredNorm() - signal.force_N.back() * signal.force_N.back());
  }
  if (recording.size() > 0) signal.sideways_N = std::sqrt(across / static_cast<double>(recording.size()));
  const auto contact = std::find_if(signal.force_N.begin(), signal.force_N.end(),
                                    [contact_force_N](double f) { return std::abs(f) > contact_force_N; });
  const auto start = contact == signal.force_N.end() ? 0 : contact - signal.force_N.begin();
  for (const auto& p : recording.motion.p_W_m) {
    signal.displacement_m.push_back((recording.motion.p_W_m[static_cast<std::size_t>(start)] - p).dot(outward));
  }
  for (const auto& q : recording.motion.q_WS) {
    signal.angle_rad.push_back(recording.motion.q_WS.front().angularDistance(q));
  }
  return signal;
}

}  // namespace touchstone::perception
