#include "smoothing.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "harness/base/error.h"
#include "harness/stats/quantile.h"

namespace touchstone::acquisition {
namespace {

constexpr double reach_in_sigmas = 4.0;

// The sample at or before t, at most the last but one; checks that t lies within the range.
std::size_t segment_at(const std::vector<double>& t_s, double t, const std::string& what) {
  if (t_s.size() < 2)
    throw BadData(fmt::format("{}: has {} samples; at least 2 are needed to interpolate", what, t_s.size()));
  // The slack is a median over all samples: it is found for what needs it.
  if (!(t >= t_s.front() && t <= t_s.back())) {
    const double slack = sample_interval_s(t_s);
    if (!(t >= t_s.front() - slack && t <= t_s.back() + slack)) {
      throw BadData(
          fmt::format("{}: is asked for at {:.6f} s but covers {:.6f} to {:.6f} s; are the files of one run, and their "
                      "times of one clock?",
                      what, t, t_s.front(), t_s.back()));
    }
  }
  const auto after = std::upper_bound(t_s.begin(), t_s.end(), t);
  const auto index = static_cast<std::size_t>(std::distance(t_s.begin(), after));
  return std::min(index > 0 ? index - 1 : 0, t_s.size() - 2);
}

double fraction_at(const std::vector<double>& t_s, std::size_t i, double t) {
  return std::clamp((t - t_s[i]) / (t_s[i + 1] - t_s[i]), 0.0, 1.0);
}

}  // namespace

double sample_interval_s(const std::vector<double>& t_s) {
  if (t_s.size() < 2) return 0.0;
  std::vector<double> steps(t_s.size() - 1);
  for (std::size_t i = 0; i < steps.size(); ++i) steps[i] = t_s[i + 1] - t_s[i];
  return stats::upper_median(std::move(steps));
}

double gaussian_sigma_s(double cutoff_Hz) {
  return std::sqrt(std::numbers::ln2) / (2.0 * std::numbers::pi * cutoff_Hz);
}

Smoothed smooth_at(const std::vector<double>& t_s, const std::vector<Vec3>& values,
                   const std::vector<double>& t_query_s, double cutoff_Hz, const std::string& what) {
  if (!(cutoff_Hz > 0.0) || !std::isfinite(cutoff_Hz))
    throw BadData(fmt::format("{}: cutoff is {} Hz; a positive frequency was expected", what, cutoff_Hz));
  const double sigma = gaussian_sigma_s(cutoff_Hz);
  const double reach = reach_in_sigmas * sigma;
  const double interval = sample_interval_s(t_s);
  Smoothed result;
  result.values.reserve(t_query_s.size());
  // A kernel narrower than the samples is interpolation between two of them, whose band ends at 0.443 / interval.
  result.bandwidth_Hz = std::min(cutoff_Hz, 0.443 / interval);
  double gain = 0.0;
  for (const double t : t_query_s) {
    const std::size_t nearest = segment_at(t_s, t, what);
    const double half = std::max(reach, 1.5 * interval);
    auto low = static_cast<std::size_t>(std::distance(t_s.begin(), std::lower_bound(t_s.begin(), t_s.end(), t - half)));
    auto high =
        static_cast<std::size_t>(std::distance(t_s.begin(), std::upper_bound(t_s.begin(), t_s.end(), t + half)));
    if (high - low < 2) {
      throw BadData(
          fmt::format("{}: has no samples within {:.4g} s of {:.6f} s: a gap of {:.4g} s, over which nothing is "
                      "invented; leave that time out, or record again",
                      what, half, t, t_s[nearest + 1] - t_s[nearest]));
    }
    // Weighted moments of u = (t_i - t) / sigma; the local line's value at u = 0 is sum w (s2 - s1 u) y / (s0 s2 -
    // s1^2).
    const double width = std::max(sigma, 0.5 * interval);
    double s0 = 0.0, s1 = 0.0, s2 = 0.0;
    for (std::size_t i = low; i < high; ++i) {
      const double u = (t_s[i] - t) / width, w = std::exp(-0.5 * u * u);
      s0 += w, s1 += w * u, s2 += w * u * u;
    }
    // Each sample's weight in that value; a second pass, so that nothing is kept. Their squares add up to what becomes
    // of the variance of white noise.
    const double determinant = s0 * s2 - s1 * s1;
    Vec3 value = Vec3::Zero();
    double squares = 0.0;
    for (std::size_t i = low; i < high; ++i) {
      const double u = (t_s[i] - t) / width, w = std::exp(-0.5 * u * u) * (s2 - s1 * u) / determinant;
      value += w * values[i];
      squares += w * w;
    }
    result.values.push_back(value);
    gain += std::sqrt(squares);
  }
  if (!t_query_s.empty()) result.noise_gain = gain / static_cast<double>(t_query_s.size());
  return result;
}

std::vector<Quat> slerp_at(const std::vector<double>& t_s, const std::vector<Quat>& q,
                           const std::vector<double>& t_query_s, const std::string& what) {
  std::vector<Quat> result;
  result.reserve(t_query_s.size());
  for (const double t : t_query_s) {
    const std::size_t i = segment_at(t_s, t, what);
    result.push_back(q[i].slerp(fraction_at(t_s, i, t), q[i + 1]));
  }
  return result;
}

std::vector<Vec3> lerp_at(const std::vector<double>& t_s, const std::vector<Vec3>& p,
                          const std::vector<double>& t_query_s, const std::string& what) {
  std::vector<Vec3> result;
  result.reserve(t_query_s.size());
  for (const double t : t_query_s) {
    const std::size_t i = segment_at(t_s, t, what);
    const double f = fraction_at(t_s, i, t);
    result.push_back((1.0 - f) * p[i] + f * p[i + 1]);
  }
  return result;
}

}  // namespace touchstone::acquisition
