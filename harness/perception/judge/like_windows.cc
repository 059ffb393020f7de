#include "harness/perception/judge/like_windows.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>

namespace touchstone::perception {
namespace {

// A cell of speeds and loads of sliding; one for all that rests.
std::pair<long, long> sliding_cell(const BandPower& power, std::size_t window) {
  constexpr double sliding_m_per_s = 0.005;
  const double speed = power.slide_m_per_s[window];
  if (!(speed > sliding_m_per_s)) return {0, 0};
  const double load_N = std::max(1e-3, power.load_N[window]);
  // Speeds above 5 mm/s have a cell of their own beside that of rest.
  return {1 + std::lround(3.0 * std::log2(speed / sliding_m_per_s)), std::lround(2.0 * std::log2(load_N))};
}

// The windows that have a weight, each as often as that says.
BandPower weighted(const BandPower& power, const std::vector<double>& weights) {
  BandPower result;
  result.segment_s = power.segment_s;
  double sum = 0.0;
  double squares = 0.0;
  for (const double w : weights) {
    sum += w;
    squares += w * w;
    result.segments += w > 0.0 ? 1 : 0;
  }
  const auto n = static_cast<double>(result.segments);
  const std::size_t bands = power.power_N2.size();
  result.power_N2.assign(bands, 0.0);
  result.octaves.assign(bands, 0.0);
  for (std::size_t w = 0; w < weights.size(); ++w) {
    if (!(weights[w] > 0.0)) continue;
    std::vector<double> own_N2 = power.windows_N2[w];
    for (std::size_t b = 0; b < bands; ++b) {
      own_N2[b] *= weights[w] / sum * n;
      result.power_N2[b] += own_N2[b] / n;
      result.octaves[b] += weights[w] / sum * power.windows_octaves[w][b];
    }
    result.windows_N2.push_back(std::move(own_N2));
    result.since_contact_s.push_back(power.since_contact_s[w]);
  }
  for (std::size_t b = 0; b < bands; ++b) {
    if (result.power_N2[b] > 0.0) result.octaves[b] /= result.power_N2[b];
    double spread = 0.0;
    for (const auto& window : result.windows_N2) spread += std::pow(window[b] - result.power_N2[b], 2);
    result.variance_N4.push_back(spread / (n * (n - 1.0)));
    result.gaussian_share.push_back(power.gaussian_share[b] * static_cast<double>(power.segments) * squares /
                                    (sum * sum));
  }
  return result;
}

}  // namespace

std::optional<LikeWindows> like_windows(const BandPower& real, const BandPower& rendered) {
  constexpr std::size_t fewest = 4;
  std::map<std::pair<long, long>, std::array<double, 2>> cells;
  for (std::size_t w = 0; w < real.segments; ++w) cells[sliding_cell(real, w)][0] += 1.0;
  for (std::size_t w = 0; w < rendered.segments; ++w) cells[sliding_cell(rendered, w)][1] += 1.0;
  const auto weights = [&](const BandPower& power, bool of_real) {
    std::vector<double> result;
    for (std::size_t w = 0; w < power.segments; ++w) {
      const auto& [own, other] = cells[sliding_cell(power, w)];
      result.push_back(own > 0.0 && other > 0.0 ? (of_real ? 1.0 : own / other) : 0.0);
    }
    return result;
  };
  LikeWindows like;
  if (cells.size() == 1) return LikeWindows{real, rendered};
  like.real = weighted(real, weights(real, true));
  like.rendered = weighted(rendered, weights(rendered, false));
  if (std::min(like.real.segments, like.rendered.segments) < fewest) return std::nullopt;
  return like;
}

}  // namespace touchstone::perception
