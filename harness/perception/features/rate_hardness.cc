#include "harness/perception/features/rate_hardness.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "harness/base/error.h"
#include "harness/stats/distributions.h"
#include "harness/stats/quantile.h"

namespace touchstone::perception {

RateHardness rate_hardness(std::span<const double> force_N, std::span<const double> displacement_m, std::size_t window,
                           double guard) {
  if (window == 0) throw UsageError("the window of rate-hardness must be at least 1 sample");
  if (force_N.size() != displacement_m.size()) {
    throw BadData(fmt::format("rate-hardness needs force and displacement of every moment, not {} and {} values",
                              force_N.size(), displacement_m.size()));
  }
  if (force_N.size() <= window) {
    throw BadData(
        fmt::format("{} samples are too few for a rate-hardness window of {}; take a smaller window or a longer "
                    "recording",
                    force_N.size(), window));
  }
  const std::size_t count = force_N.size() - window;
  double squares = 0.0;
  for (std::size_t n = 0; n < count; ++n) {
    const double change = displacement_m[n + window] - displacement_m[n];
    squares += change * change;
  }
  const double smallest = guard * std::sqrt(squares / static_cast<double>(count));

  RateHardness result;
  result.values_N_per_m.assign(count, 0.0);
  result.guarded.assign(count, 0);
  std::size_t held = 0;
  bool have_value = false;
  for (std::size_t n = 0; n < count; ++n) {
    const double change = displacement_m[n + window] - displacement_m[n];
    if (change != 0.0 && std::abs(change) >= smallest) {
      const double hardness = (force_N[n + window] - force_N[n]) / change;
      if (!have_value) std::fill_n(result.values_N_per_m.begin(), n, hardness);
      have_value = true;
      result.values_N_per_m[n] = hardness;
    } else {
      ++held;
      result.guarded[n] = 1;
      if (have_value) result.values_N_per_m[n] = result.values_N_per_m[n - 1];
    }
  }
  result.guarded_share = static_cast<double>(held) / static_cast<double>(count);
  return result;
}

std::vector<WindowTradeOff> window_trade_off(std::span<const double> force_N, std::span<const double> displacement_m,
                                             double rate_Hz, std::span<const std::size_t> windows) {
  std::vector<WindowTradeOff> result;
  for (const std::size_t window : windows) {
    const RateHardness hardness = rate_hardness(force_N, displacement_m, window);
    const auto& h = hardness.values_N_per_m;
    std::vector<double> changes;
    changes.reserve(h.size());
    for (std::size_t n = 0; n < h.size(); ++n)
      changes.push_back(std::abs(displacement_m[n + window] - displacement_m[n]));
    // h(n-w) - 2 h(n) + h(n+w) from overlapping ends: independent windows share no sample but their ends.
    std::vector<double> curvature;
    for (std::size_t n = window; n + window < h.size(); ++n) {
      if (hardness.guarded[n - window] || hardness.guarded[n] || hardness.guarded[n + window]) continue;
      curvature.push_back(std::abs(h[n - window] - 2.0 * h[n] + h[n + window]));
    }
    // The median of |x| is 0.6745 standard deviations; the second difference of independent values has sqrt(6) of them.
    const double noise = stats::median(curvature) / (0.6744897501960817 * std::sqrt(6.0));
    result.push_back({window, static_cast<double>(window) / rate_Hz, stats::median(changes), stats::median(h), noise,
                      hardness.guarded_share});
  }
  return result;
}

std::optional<double> extended_rate_hardness(std::span<const double> force_N,
                                             std::span<const double> force_rate_N_per_s,
                                             std::span<const double> velocity_m_per_s, double contact_force_N) {
  const auto contact = std::find_if(force_N.begin(), force_N.end(), [=](double f) { return f > contact_force_N; });
  if (contact == force_N.end()) return std::nullopt;
  const auto at = static_cast<std::size_t>(contact - force_N.begin());
  double fastest = 0.0;
  for (const double v : velocity_m_per_s) fastest = std::max(fastest, std::abs(v));
  if (!(velocity_m_per_s[at] > 1e-3 * fastest)) return std::nullopt;
  return *std::max_element(force_rate_N_per_s.begin(), force_rate_N_per_s.end()) / velocity_m_per_s[at];
}

namespace {

// Sum of (x - mean)(y - mean) over `count` samples from `first` on.
double joint_sum(std::span<const double> x, std::span<const double> y, std::size_t first, std::size_t count) {
  double mean_x = 0.0;
  double mean_y = 0.0;
  for (std::size_t i = first; i < first + count; ++i) {
    mean_x += x[i] / static_cast<double>(count);
    mean_y += y[i] / static_cast<double>(count);
  }
  double sum = 0.0;
  for (std::size_t i = first; i < first + count; ++i) sum += (x[i] - mean_x) * (y[i] - mean_y);
  return sum;
}

}  // namespace

std::optional<RateHardnessEstimate> estimated_rate_hardness(std::span<const double> force_N,
                                                            std::span<const double> displacement_m, double rate_Hz,
                                                            double contact_force_N) {
  constexpr double line_s = 0.02;
  constexpr std::size_t fewest_contacts = 3;
  const auto count = static_cast<std::size_t>(std::max(3.0, std::round(line_s * rate_Hz)));
  std::vector<double> time(count);
  for (std::size_t i = 0; i < count; ++i) time[i] = static_cast<double>(i) / rate_Hz;
  const double time_squares = joint_sum(time, time, 0, count);
  std::vector<double> values;
  std::size_t free = 0;
  for (std::size_t i = 0; i + count <= force_N.size(); ++i) {
    if (force_N[i] <= contact_force_N) {
      ++free;
      continue;
    }
    if (free >= count) {
      const double force_rate = joint_sum(time, force_N.subspan(i, count), 0, count) / time_squares;
      const double speed = joint_sum(time, displacement_m.subspan(i, count), 0, count) / time_squares;
      if (speed > 0.0 && force_rate > 0.0) values.push_back(force_rate / speed);
    }
    free = 0;
  }
  if (values.size() < fewest_contacts) return std::nullopt;
  const auto n = static_cast<double>(values.size());
  RateHardnessEstimate estimate;
  estimate.contacts = values.size();
  estimate.value_N_per_m = stats::median(values);
  double squares = 0.0;
  for (const double v : values) squares += std::pow(v - estimate.value_N_per_m, 2);
  // The median of normal values spreads by sqrt(pi / 2) more than their mean.
  const double error = 1.2533 * std::sqrt(squares / (n - 1.0) / n);
  const double reach = stats::student_t_975(n - 1.0) * error;
  estimate.low95_N_per_m = std::max(0.0, estimate.value_N_per_m - reach);
  estimate.high95_N_per_m = estimate.value_N_per_m + reach;
  if (!(estimate.high95_N_per_m - estimate.low95_N_per_m < estimate.value_N_per_m)) return std::nullopt;
  return estimate;
}

}  // namespace touchstone::perception
