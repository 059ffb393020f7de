#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "harness/perception/judge/judge.h"

namespace touchstone::perception {

namespace {

// Whether a response with a lag leaves no more of the force than the one before, beyond what cannot decide: noise, by
// the spread of the difference over blocks (Vuong 1989), and the smoothing of the depth. A mean over T is off by d''
// T^2 / 24 and the slope of the force times that is left by the right lag; the part that goes with the rate may cancel
// it. Samples beyond the first cell of either are compared: a delay displaces where contact seems to begin.
bool explains_as_much(const Response& lagged, const FeltSeries& lagged_felt, const Response& before,
                      const FeltSeries& before_felt) {
  constexpr double two_errors = 2.0;
  const std::size_t half = before_felt.smoothed_samples / 2;
  const double smoothed_s = static_cast<double>(before_felt.smoothed_samples) / before_felt.rate_Hz;
  const auto& force_over_depth = lagged.curves.normal_N;
  std::array<double, jackknife_blocks> more_N2{};
  double by_smoothing_N2 = 0.0;
  for (std::size_t i = half; i + half < before_felt.size(); ++i) {
    const double depth_m = lagged_felt.depth_m[i] - lagged.contact_m;
    const double cell_m = before.grid.spacing_m;
    if (!(std::min(depth_m, before_felt.depth_m[i] - before.contact_m) > cell_m)) continue;
    const double force_N = before_felt.force_N[0][i];
    more_N2[i * jackknife_blocks / before_felt.size()] +=
        std::pow(force_N - expected_force_N(lagged, lagged_felt, lagged.contact_m, i)[0], 2) -
        std::pow(force_N - expected_force_N(before, before_felt, before.contact_m, i)[0], 2);
    const double change_m_per_s =
        lagged_felt.rate_of_depth_m_per_s[i + half] - lagged_felt.rate_of_depth_m_per_s[i - half];
    const double slope =
        (at_depth(force_over_depth, depth_m, lagged.grid) - at_depth(force_over_depth, depth_m - cell_m, lagged.grid)) /
        cell_m;
    by_smoothing_N2 += std::pow(slope * change_m_per_s * smoothed_s / 24.0, 2);
  }
  double sum_N2 = 0.0;
  double squares = 0.0;
  for (const double more : more_N2) sum_N2 += more;
  constexpr double n = static_cast<double>(jackknife_blocks);
  for (const double more : more_N2) squares += std::pow(more - sum_N2 / n, 2);
  const double error_N2 = std::sqrt(n / (n - 1.0) * squares);
  return sum_N2 <= by_smoothing_N2 + two_errors * error_N2;
}

}  // namespace

JudgedProcess judged_process(FeltSeries felt, const Thresholds& thresholds, const JudgedProcess* reference) {
  constexpr double longest_lag_s = 0.25;
  constexpr double settled_s = 1e-5;
  JudgedProcess process;
  process.shape =
      reference != nullptr ? reference->shape : surface_shape(felt, 2.0 * thresholds.force.absolute_threshold);
  if (process.shape) felt = on_shape(std::move(felt), *process.shape);
  // A rendering that gives no force has no contact of its own: it is in contact where the real process is.
  const auto contact_of = [&](const FeltSeries& series) {
    const auto contact = first_contact(series, thresholds.force);
    return !contact.begins_free && reference != nullptr && reference->contact.begins_free ? reference->contact
                                                                                          : contact;
  };
  // Drag hides where contact begins, and where contact begins is free air.
  process.contact = contact_of(felt);
  const FeltSeries as_felt = felt;
  for (int round = 0; round < 2; ++round) {
    felt = as_felt;
    process.air.tool = take_out_tool(felt, process.contact);
    process.contact = contact_of(felt);
  }
  const DepthGrid own =
      reference != nullptr && reference->response ? reference->response->grid : depth_grid(felt, process.contact);
  process.response = fit_response(felt, process.contact, own);
  process.felt = std::move(felt);
  process.prompt_depth_m = process.felt.depth_m;
  process.prompt_slide_x = process.felt.slide_x;
  if (!process.response) return process;
  if (auto with_gain = with_place(*process.response, process.felt)) process.response = std::move(with_gain);
  // Steps of a secant: the delay that is left after each, halved until less of it is left. A part that goes with the
  // rate is only the first order of a delay; what is no delay leaves more of the force.
  const FeltSeries prompt = process.felt;
  const auto take_out = [&](double lag_s) {
    FeltSeries lagged = with_lag(prompt, lag_s);
    const auto contact = contact_of(lagged);
    auto response = fit_response(lagged, contact, own, process.response->gain);
    if (!response || !explains_as_much(*response, lagged, *process.response, process.felt)) return false;
    const double left_s = std::abs(apparent_lag_s(*response, response->curves));
    if (!(left_s < std::abs(apparent_lag_s(*process.response, process.response->curves)))) return false;
    response->lag_s = lag_s;
    process.response = std::move(response);
    process.contact = contact;
    process.felt = std::move(lagged);
    return true;
  };
  constexpr int steps = 6;
  bool better = true;
  for (int step = 0; step < steps && better; ++step) {
    const double before_s = process.response->lag_s;
    double more_s = apparent_lag_s(*process.response, process.response->curves);
    better = false;
    for (int half = 0; half < steps && !better; ++half, more_s *= 0.5) {
      const double lag_s = before_s + more_s;
      if (!(std::abs(more_s) > settled_s)) break;
      if (lag_s > 0.0 && lag_s <= longest_lag_s) better = take_out(lag_s);
    }
  }
  measure_left(*process.response, process.felt);
  process.fast = fast_force(process.felt, *process.response, thresholds);
  const ToolInAir tool = process.air.tool;
  process.air = free_air(process.felt, *process.response);
  process.air.tool = tool;
  return process;
}

}  // namespace touchstone::perception
