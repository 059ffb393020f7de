// Where taps begin and end in the force signal.
#include <algorithm>
#include <cmath>
#include <cstddef>

#include "clock_parts.h"
#include "harness/stats/quantile.h"
#include "smoothing.h"

namespace touchstone::acquisition {
namespace {

constexpr double bounce_s = 0.15;       // a contact that follows sooner belongs to the same tap: nobody taps at 7 Hz
constexpr double chatter_s = 0.002;     // a gap this short is no flight: it rises less than a micrometre
constexpr double before_edge_s = 0.04;  // the free air next to a tap, from which its baseline is taken ...
constexpr double edge_guard_s = 0.004;  // ... up to where the contact may have begun
constexpr double rest_share = 0.25;  // of its peak that the force may differ by before and after: else it is a landing
constexpr double edge_from = 0.05, edge_to = 0.3;  // of the peak: the part of an edge that a line is fitted to

// Standard deviation within windows of 50 samples, the median of them: contacts and turns of the hand do not count.
double noise_of(const std::vector<double>& force) {
  constexpr std::size_t window = 50;
  std::vector<double> spreads;
  for (std::size_t i = 0; i + window <= force.size(); i += window) {
    double mean = 0.0, square = 0.0;
    for (std::size_t j = i; j < i + window; ++j) mean += force[j] / window;
    for (std::size_t j = i; j < i + window; ++j) square += (force[j] - mean) * (force[j] - mean);
    spreads.push_back(std::sqrt(square / (window - 1)));
  }
  return spreads.empty() ? 0.0 : stats::upper_median(std::move(spreads));
}

// A straight line by least squares, about t0.
struct Straight {
  double n = 0, t = 0, f = 0, tt = 0, tf = 0;
  void add(double u, double y) { n += 1, t += u, f += y, tt += u * u, tf += u * y; }
  [[nodiscard]] double determinant() const { return n * tt - t * t; }
  [[nodiscard]] bool fits() const { return n >= 3 && determinant() > 0; }
  [[nodiscard]] double slope() const { return (n * tf - t * f) / determinant(); }
  [[nodiscard]] double level() const { return (f - slope() * t) / n; }
};

struct Edge {
  double at_s;
  double sigma_s;
  double air_N;  // force of the free air beside it
};

// The edge of a tap on one side of its peak: `step` -1 walks from the peak back to the onset, +1 on to the release. The
// force of the free air beside it is a line (the tool's weight turns, its inertia is felt while it approaches); the
// edge is where the line through the foot of the tap meets it. Other contacts lie outside from_s to to_s.
Edge edge_of(const std::vector<double>& t, const std::vector<double>& force, std::size_t peak, std::size_t foot,
             int step, double noise, double from_s, double to_s) {
  const double origin = t[foot];
  Straight air;
  const auto inside = [&](std::size_t i) { return i > 0 && i + 1 < t.size(); };
  const auto next = [&](std::size_t i) { return step < 0 ? i - 1 : i + 1; };
  for (std::size_t i = foot; inside(i) && std::abs(t[i] - origin) < before_edge_s && t[i] >= from_s && t[i] <= to_s;
       i = next(i)) {
    if (std::abs(t[i] - origin) > edge_guard_s) air.add(t[i] - origin, force[i]);
  }
  const auto baseline = [&](double u) { return air.fits() ? air.level() + air.slope() * u : 0.0; };
  const double height = force[peak] - baseline(t[peak] - origin);
  Straight edge;
  std::size_t i = peak;
  for (; inside(i); i = next(i)) {
    const double u = t[i] - origin, f = force[i] - baseline(u);
    if (f < std::max(edge_from * height, 3.0 * noise)) break;
    if (f <= edge_to * height) edge.add(u, f);
  }
  const double fallback = std::abs(t[inside(i) ? next(i) : i] - t[i]);
  if (edge.fits() && edge.slope() * step < 0) {
    const double at = -edge.level() / edge.slope();
    // Not farther from the foot of the line than the line is long: a foot that flattens out is no line.
    const double end = t[i] - origin;
    const double sigma = noise / std::abs(edge.slope()) *
                         std::sqrt(1.0 / edge.n + std::pow(edge.t / edge.n - at, 2) * edge.n / edge.determinant());
    if (std::abs(at - end) < 0.01) return {origin + at, std::max(sigma, fallback), baseline(0.0)};
  }
  return {t[i], 2.0 * fallback, baseline(0.0)};  // an edge within two samples
}

}  // namespace

std::vector<ForceTap> find_force_taps(const std::vector<double>& t_s, const std::vector<double>& normal_force_N,
                                      const TapOptions& options) {
  std::vector<Vec3> raw;
  raw.reserve(normal_force_N.size());
  for (const double f : normal_force_N) raw.emplace_back(0.0, 0.0, f);
  const auto quick = without_slow_part(t_s, raw);
  const double noise = noise_of(normal_force_N);
  double threshold = options.force_threshold_N;
  if (threshold <= 0.0) {
    double largest = 0.0;
    for (const Vec3& f : quick) largest = std::max(largest, f.z());
    // Nor what a heavy tool pulls when the hand swings it: four robust standard deviations of all that is quick.
    std::vector<double> sizes;
    sizes.reserve(quick.size());
    for (const Vec3& f : quick) sizes.push_back(std::abs(f.z()));
    threshold = std::max(
        {8.0 * noise, 0.05 * largest, 4.0 * stats::normal_sigma_per_median * stats::upper_median(std::move(sizes))});
  }
  std::vector<ForceTap> taps;
  if (!(threshold > 0.0)) return taps;
  // Hysteresis: in above the threshold, out below half of it.
  struct Stretch {
    std::size_t first, last;
  };
  std::vector<std::vector<Stretch>> groups;
  bool inside = false;
  for (std::size_t i = 0; i < t_s.size(); ++i) {
    const double f = quick[i].z();
    if (!inside && f > threshold) {
      inside = true;
      const double since = groups.empty() ? bounce_s : t_s[i] - t_s[groups.back().back().last];
      if (since >= bounce_s) {
        groups.push_back({{i, i}});
      } else if (since > chatter_s) {
        groups.back().push_back({i, i});
      }
    } else if (inside && f < 0.5 * threshold) {
      inside = false;
    }
    if (inside) groups.back().back().last = i;
  }
  for (const auto& group : groups) {
    const double duration = t_s[group.back().last] - t_s[group.front().first];
    if (duration > options.longest_tap_s || duration < options.shortest_tap_s) continue;
    std::vector<Edge> onsets, releases;
    double highest = 0.0;
    for (std::size_t k = 0; k < group.size(); ++k) {
      const Stretch& c = group[k];
      const double from = k > 0 ? t_s[group[k - 1].last] + edge_guard_s : t_s.front(),
                   to = k + 1 < group.size() ? t_s[group[k + 1].first] - edge_guard_s : t_s.back();
      std::size_t peak = c.first;
      for (std::size_t i = c.first; i <= c.last; ++i) {
        if (normal_force_N[i] > normal_force_N[peak]) peak = i;
      }
      onsets.push_back(edge_of(t_s, normal_force_N, peak, c.first, -1, noise, from, to));
      releases.push_back(edge_of(t_s, normal_force_N, peak, c.last, +1, noise, from, to));
      highest = std::max(highest, normal_force_N[peak]);
    }
    if (std::abs(onsets.front().air_N - releases.back().air_N) > rest_share * highest) continue;
    ForceTap tap{
        onsets.front().at_s, onsets.front().sigma_s, releases.back().at_s, releases.back().sigma_s, highest, {}};
    for (std::size_t i = 1; i < group.size(); ++i) {
      if (onsets[i].at_s > releases[i - 1].at_s) tap.flights.push_back({releases[i - 1].at_s, onsets[i].at_s});
    }
    taps.push_back(std::move(tap));
  }
  return taps;
}

}  // namespace touchstone::acquisition
