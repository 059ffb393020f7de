#include "lab/analysis.h"

#include <fmt/format.h>
#include <sched.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

namespace touchstone::hil {
namespace {

// Overlapping Allan deviation of averages over m samples.
double allan(const std::vector<double>& x, std::size_t m) {
  std::vector<double> sum(x.size() + 1, 0.0);
  for (std::size_t i = 0; i < x.size(); ++i) sum[i + 1] = sum[i] + x[i];
  const std::size_t n = x.size() - 2 * m + 1;
  double square = 0.0;
  for (std::size_t i = 0; i < n; ++i)
    square += std::pow((sum[i + 2 * m] - 2 * sum[i + m] + sum[i]) / static_cast<double>(m), 2);
  return std::sqrt(square / (2.0 * static_cast<double>(n)));
}

}  // namespace

NoiseFloor noise_floor(const std::vector<WrenchSample>& samples, double rate_Hz) {
  NoiseFloor result;
  const std::size_t n = samples.size();
  if (n < 4) throw BadData(fmt::format("noise floor: {} samples; at least 4 are needed: record longer", n));
  std::array<std::vector<double>, 3> axis;
  for (int k = 0; k < 3; ++k) {
    auto& x = axis[static_cast<std::size_t>(k)];
    double st = 0, sx = 0, stt = 0, stx = 0;
    const double origin = samples[0].wrench.f_N[k];
    for (std::size_t i = 0; i < n; ++i) {
      const double t = static_cast<double>(i) / rate_Hz, v = samples[i].wrench.f_N[k] - origin;
      x.push_back(v);
      st += t, sx += v, stt += t * t, stx += t * v;
    }
    const auto count = static_cast<double>(n);
    result.sigma_N[k] = allan(x, 1);
    result.drift_N_per_s[k] = (count * stx - st * sx) / (count * stt - st * st);
  }
  for (std::size_t m = 1; 2 * m < n; m *= 2) {
    result.tau_s.push_back(static_cast<double>(m) / rate_Hz);
    result.allan_N.push_back(std::max({allan(axis[0], m), allan(axis[1], m), allan(axis[2], m)}));
  }
  return result;
}

StepResponse step_response(const std::vector<double>& t_s, const std::vector<double>& force_N, double command_s) {
  StepResponse r;
  double before = 0, n_before = 0, after = 0, n_after = 0;
  const double settled = command_s + 0.7 * (t_s.back() - command_s);
  for (std::size_t i = 0; i < t_s.size(); ++i) {
    if (t_s[i] < command_s) before += force_N[i], n_before += 1;
    if (t_s[i] > settled) after += force_N[i], n_after += 1;
  }
  r.initial_N = before / n_before;
  r.final_N = after / n_after;
  const double height = r.final_N - r.initial_N;
  const auto fraction_of = [&](std::size_t i) { return (force_N[i] - r.initial_N) / height; };
  const auto first_at = [&](double fraction) {
    for (std::size_t i = 1; i < t_s.size(); ++i) {
      if (t_s[i] < command_s || fraction_of(i) < fraction) continue;
      const double a = fraction_of(i - 1), b = fraction_of(i);
      return a < fraction ? t_s[i - 1] + (t_s[i] - t_s[i - 1]) * (fraction - a) / (b - a) : t_s[i];
    }
    return std::numeric_limits<double>::quiet_NaN();
  };
  r.delay_s = first_at(0.5) - command_s;
  r.rise_s = first_at(0.9) - first_at(0.1);
  for (std::size_t i = 0; i < t_s.size(); ++i) r.overshoot = std::max(r.overshoot, fraction_of(i) - 1.0);
  r.bandwidth_Hz = std::log(9.0) / (2 * std::numbers::pi * r.rise_s);
  return r;
}

Jitter servo_jitter(const std::vector<double>& t_s, double nominal_s, double bin_s, std::size_t bins) {
  Jitter j;
  j.histogram.assign(bins, 0);
  std::vector<double> late;
  for (std::size_t i = 1; i < t_s.size(); ++i) {
    const double period = t_s[i] - t_s[i - 1];
    j.mean_s += period / static_cast<double>(t_s.size() - 1);
    late.push_back(std::max(0.0, period - nominal_s));
    j.missed += period > 2 * nominal_s;
    ++j.histogram[std::min(bins - 1, static_cast<std::size_t>(late.back() / bin_s))];
  }
  std::sort(late.begin(), late.end());
  if (!late.empty()) j.p99_late_s = late[late.size() * 99 / 100], j.worst_late_s = late.back();
  return j;
}

double passive_stiffness_N_per_m(double device_damping_N_s_per_m, double period_s) {
  return 2.0 * device_damping_N_s_per_m / period_s;
}

double z_width_N_per_m(const std::vector<double>& stiffness_N_per_m, const std::vector<bool>& stable) {
  double largest = 0.0;
  for (std::size_t i = 0; i < stiffness_N_per_m.size() && stable[i]; ++i) largest = stiffness_N_per_m[i];
  return largest;
}

bool oscillates(const std::vector<double>& position_m, double noise_m) {
  const std::size_t n = position_m.size(), quarter = n / 4;
  if (quarter < 4) return false;
  const auto swing = [&](std::size_t from, std::size_t to) {
    double mean = 0, square = 0;
    for (std::size_t i = from; i < to; ++i) mean += position_m[i] / static_cast<double>(to - from);
    for (std::size_t i = from; i < to; ++i)
      square += std::pow(position_m[i] - mean, 2) / static_cast<double>(to - from);
    return std::sqrt(2 * square);
  };
  const double third = swing(2 * quarter, 3 * quarter), last = swing(3 * quarter, n);
  return last > noise_m && last > 0.7 * third;
}

std::string scheduling() {
  sched_param parameters{};
  const int policy = sched_getscheduler(0);
  sched_getparam(0, &parameters);
  if (policy != SCHED_FIFO && policy != SCHED_RR) return "SCHED_OTHER";
  return fmt::format("{} {}", policy == SCHED_FIFO ? "SCHED_FIFO" : "SCHED_RR", parameters.sched_priority);
}

}  // namespace touchstone::hil
