#include "harness/recording_checks/column_faults.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <map>
#include <optional>
#include <unordered_map>

#include "harness/recording_checks/force_noise.h"
#include "harness/stats/quantile.h"

namespace touchstone::recording_checks {
using recording::Recording;

namespace {

constexpr std::array<const char*, 3> axis_names{"x", "y", "z"};

struct Stretch {
  std::size_t begin = 0, end = 0;
};

// The longest stretch over which `same(i)` says that sample i repeats sample i - 1.
template <class Same>
Stretch longest_stretch(std::size_t n, const Same& same) {
  Stretch best, now;
  for (std::size_t i = 1; i <= n; ++i) {
    if (i < n && same(i)) continue;
    now.end = i;
    if (now.end - now.begin > best.end - best.begin) best = now;
    now.begin = i;
  }
  return best;
}

// The mean way from sample to sample.
double mean_step(const std::vector<Vec3>& values, std::size_t from, std::size_t to) {
  double way = 0.0;
  for (std::size_t i = from + 1; i < to; ++i) way += (values[i] - values[i - 1]).norm();
  return way / static_cast<double>(to - from - 1);
}

// The way from sample to sample, in the middle of those that move at all.
double usual_step(const std::vector<Vec3>& values) {
  std::vector<double> steps;
  for (std::size_t i = 1; i < values.size(); ++i) {
    if (values[i] != values[i - 1]) steps.push_back((values[i] - values[i - 1]).norm());
  }
  if (steps.empty()) return 0.0;
  return stats::upper_median(std::move(steps));
}

// `values` without the samples of `stretch`.
std::vector<Vec3> outside_of(const std::vector<Vec3>& values, const Stretch& stretch) {
  std::vector<Vec3> rest(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(stretch.begin));
  rest.insert(rest.end(), values.begin() + static_cast<std::ptrdiff_t>(stretch.end), values.end());
  return rest;
}

std::vector<Vec3> differences(const std::vector<Vec3>& values) {
  std::vector<Vec3> steps;
  for (std::size_t i = 1; i < values.size(); ++i) steps.emplace_back(values[i] - values[i - 1]);
  return steps;
}

// The share of steps that turn against the one before.
double turning_share(const std::vector<Vec3>& steps) {
  std::size_t turns = 0;
  for (std::size_t i = 1; i < steps.size(); ++i) turns += steps[i].dot(steps[i - 1]) < 0.0 ? 1 : 0;
  return steps.size() < 2 ? 0.0 : static_cast<double>(turns) / static_cast<double>(steps.size() - 1);
}

// The noise exceeds what rounding makes. A file's digits round by one quantum, the smallest step of a channel; binary
// floats and six significant digits by up to 1e-5 of the largest value.
bool above_rounding(const std::vector<Vec3>& values) {
  constexpr double quanta = 2.0, relative_rounding = 1e-5;
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<Vec3> alone;
    double quantum = std::numeric_limits<double>::infinity(), largest = 0.0;
    for (const Vec3& v : values) {
      if (!alone.empty() && alone.back().x() != v[axis])
        quantum = std::min(quantum, std::abs(alone.back().x() - v[axis]));
      largest = std::max(largest, std::abs(v[axis]));
      alone.emplace_back(v[axis], 0.0, 0.0);
    }
    if (std::isfinite(quantum) && force_noise_N(alone) > quanta * std::max(quantum, relative_rounding * largest)) {
      return true;
    }
  }
  return false;
}

// Whether noise moves the column at almost every sample outside of `stretch`: steps are hardly ever zero, and often
// turn against the one before, which no smooth motion does. White noise turns in 1/2 + asin(n / (n + 1)) / pi of its
// n-th differences: 0.667 of the first, 0.795 of the fourth. Where the motion between two samples hides the noise of
// the first differences, the fourth ones, which take a cubic out, show it (a sine needs ten samples a period to turn in
// a fifth of them); they show rounding too, which computed values have.
bool noise_shows(const std::vector<Vec3>& values, const Stretch& stretch) {
  constexpr std::size_t fewest = 100;
  constexpr double few = 0.1, often_in_first = 0.25, often_in_fourth = 0.4;
  const std::vector<Vec3> rest = outside_of(values, stretch);
  if (rest.size() <= fewest) return false;
  std::vector<Vec3> steps = differences(rest);
  const auto still = static_cast<double>(std::ranges::count(steps, Vec3(Vec3::Zero())));
  if (!(still < few * static_cast<double>(steps.size()))) return false;
  if (turning_share(steps) > often_in_first) return true;
  for (int order = 1; order < 4; ++order) steps = differences(steps);
  return turning_share(steps) > often_in_fourth && above_rounding(rest);
}

// A column that noise moves repeats its value in less than one step of ten (`noise_shows`), so that chance makes a
// stretch of 50 in n samples with a probability below n * 0.1^49. A sensor that is read more often than it measures
// holds its values for less than 0.2 s unless it measures less than five times a second.
constexpr std::size_t fewest_stuck = 50;
constexpr double shortest_stuck_s = 0.2;

// The longest stretch over which `stuck` stands still number by number, if long enough, and while `other` moves as much
// as in the whole recording.
std::optional<Stretch> standing(const std::vector<double>& t_s, const std::vector<Vec3>& stuck,
                                const std::vector<Vec3>& other) {
  const Stretch s = longest_stretch(stuck.size(), [&](std::size_t i) { return stuck[i] == stuck[i - 1]; });
  if (s.end - s.begin < fewest_stuck || t_s[s.end - 1] - t_s[s.begin] < shortest_stuck_s) return std::nullopt;
  if (!(mean_step(other, s.begin, s.end) > 0.5 * mean_step(other, 0, other.size()))) return std::nullopt;
  return s;
}

// A column that noise moves everywhere else cannot stand still; one without noise must have jumped where it goes on: it
// moved all the time and was not read. A tip that rests goes on where it stopped.
std::optional<Stretch> find_stuck(const std::vector<double>& t_s, const std::vector<Vec3>& stuck,
                                  const std::vector<Vec3>& other) {
  constexpr double jump_of_steps = 10.0;
  const auto s = standing(t_s, stuck, other);
  if (!s) return std::nullopt;
  if (stuck[s->begin] != Vec3(Vec3::Zero()) && noise_shows(stuck, *s)) return s;
  // It rests all along, or to the end: another column's matter (one axis pressed in place).
  if (s->end == stuck.size() || !((stuck[s->end] - stuck[s->end - 1]).norm() > jump_of_steps * usual_step(stuck))) {
    return std::nullopt;
  }
  return s;
}

struct DeadChannel {
  std::string message;
  bool throughout = false;
};

// A channel that stands still while the others move: a dead one, throughout or from somewhere on (a cable breaks).
// Noise in the rest shows that the file is measured, since computed forces may well be constant; a channel of zeros is
// not measured, which is legitimate, and one at its highest or lowest is another fault (saturated).
std::optional<DeadChannel> find_dead_channel(const Recording& r, int axis) {
  constexpr std::size_t fewest = 100;
  if (r.size() < fewest) return std::nullopt;
  const auto& t = r.motion.t_s;
  std::vector<Vec3> alone, others;
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (const Vec3& f : r.f_W_N) {
    alone.emplace_back(f[axis], 0.0, 0.0);
    others.emplace_back(f[(axis + 1) % 3], f[(axis + 2) % 3], 0.0);
    low = std::min(low, f[axis]), high = std::max(high, f[axis]);
  }
  const auto s = standing(t, alone, others);
  const bool throughout = low == high;
  const Stretch found = throughout ? Stretch{0, r.size()} : s.value_or(Stretch{});
  if (found.end == 0 || alone[found.begin].x() == 0.0) return std::nullopt;
  const double value = alone[found.begin].x();
  if (throughout) {
    if (!noise_shows(r.f_W_N, {}) && !noise_shows(r.motion.p_W_m, {})) return std::nullopt;
  } else if (value == low || value == high || !noise_shows(alone, found)) {
    return std::nullopt;
  }
  return DeadChannel{fmt::format("f{} stands at exactly {:.6g} N in {}{} samples, {:.4g} s to {:.4g} s: that channel "
                                 "gave nothing",
                                 axis_names[static_cast<std::size_t>(axis)], value, throughout ? "all " : "",
                                 found.end - found.begin, t[found.begin], t[found.end - 1]),
                     throughout};
}

// The force changes by far more than its noise, and the position never.
bool dead_position(const Recording& r) {
  constexpr std::size_t fewest = 100;
  constexpr double far_more = 20.0;
  const Vec3 place = r.motion.p_W_m.front();
  if (r.size() < fewest || !std::ranges::all_of(r.motion.p_W_m, [&](const Vec3& p) { return p == place; }))
    return false;
  Box3 range;
  for (const Vec3& f : r.f_W_N) range.extend(f);
  return noise_shows(r.f_W_N, {}) && range.diagonal().norm() > far_more * force_noise_N(r.f_W_N);
}

// Samples at the end of the range pile up, where those just below it thin out.
std::optional<std::string> find_clipped(const std::vector<Vec3>& forces, int axis, double sign) {
  constexpr std::size_t fewest = 20;
  constexpr std::size_t longest_run = 5;
  double end = -std::numeric_limits<double>::infinity();
  for (const Vec3& f : forces) end = std::max(end, sign * f[axis]);
  if (end == 0.0) return std::nullopt;  // zero off contact
  std::map<double, std::size_t, std::greater<>> counts;
  std::size_t run = 0, longest = 0;
  for (const Vec3& f : forces) {
    ++counts[sign * f[axis]];
    run = sign * f[axis] == end ? run + 1 : 0;
    longest = std::max(longest, run);
  }
  if (counts.size() < 4) return std::nullopt;  // hardly varies: a stuck or an unmeasured axis
  const std::size_t at_end = counts.begin()->second;
  std::size_t next = 0, looked = 0;
  for (auto it = std::next(counts.begin()); it != counts.end() && looked < 3; ++it, ++looked) {
    next = std::max(next, it->second);
  }
  if (at_end < fewest || longest < longest_run || at_end < 5 * next) return std::nullopt;
  return fmt::format("{} of {} samples of f{} stand at exactly {:.6g} N, {} in a row, and {} at the next value", at_end,
                     forces.size(), axis_names[static_cast<std::size_t>(axis)], sign * end, longest, next);
}

// Windows of so many samples that are equal in position and force to an earlier window.
std::optional<std::pair<Stretch, std::size_t>> find_repeat(const Recording& r) {
  constexpr std::size_t window = 32;
  const auto& p = r.motion.p_W_m;
  const auto& f = r.f_W_N;
  if (r.size() < 2 * window) return std::nullopt;
  const auto sample_hash = [&](std::size_t i) {
    std::uint64_t h = 1469598103934665603ULL;
    for (const double v : {p[i].x(), p[i].y(), p[i].z(), f[i].x(), f[i].y(), f[i].z()}) {
      std::uint64_t bits = 0;
      std::memcpy(&bits, &v, sizeof bits);
      h = (h ^ bits) * 1099511628211ULL;
    }
    return h;
  };
  const auto equal = [&](std::size_t a, std::size_t b) { return p[a] == p[b] && f[a] == f[b]; };
  // Windows that begin at whole multiples, against every window: each repeat of twice the length holds one of them.
  std::unordered_multimap<std::uint64_t, std::size_t> starts;
  for (std::size_t i = 0; i + window <= r.size(); i += window) starts.emplace(sample_hash(i), i);
  for (std::size_t i = 1; i + window <= r.size(); ++i) {
    const auto [from, to] = starts.equal_range(sample_hash(i));
    for (auto it = from; it != to; ++it) {
      const std::size_t earlier = it->second;
      if (earlier + window > i) continue;
      std::size_t n = 0, changes = 0;
      while (i + n < r.size() && earlier + n < i && equal(earlier + n, i + n)) {
        if (n > 0 && !equal(i + n, i + n - 1)) ++changes;
        ++n;
      }
      // At rest in free air the numbers may well be the same.
      if (n >= window && 2 * changes > n) return std::pair{Stretch{i, i + n}, earlier};
    }
  }
  return std::nullopt;
}

}  // namespace

std::vector<ColumnFault> find_column_faults(const Recording& r) {
  std::vector<ColumnFault> faults;
  const auto& t = r.motion.t_s;
  if (r.size() < 2 || r.f_W_N.size() != r.size()) return faults;
  const auto stretch = [&](const Stretch& s) {
    return fmt::format("{} samples, {:.4g} s to {:.4g} s", s.end - s.begin, t[s.begin], t[s.end - 1]);
  };
  if (const auto s = find_stuck(t, r.motion.p_W_m, r.f_W_N)) {
    faults.push_back({RecordingFault::stuck_position,
                      fmt::format("the position stands still to the last digit over {} while the force goes on"
                                  ": the tracker gave nothing new",
                                  stretch(*s)),
                      "leave that stretch out"});
  }
  if (const auto s = find_stuck(t, r.f_W_N, r.motion.p_W_m)) {
    faults.push_back({RecordingFault::stuck_force,
                      fmt::format("the force stands still to the last digit over {} while the tip moves"
                                  ": the sensor gave nothing new",
                                  stretch(*s)),
                      "leave that stretch out"});
  }
  if (dead_position(r)) {
    faults.push_back(
        {RecordingFault::constant_position,
         fmt::format("the position is the same to the last digit in all {} samples while the force changes: "
                     "the tracker gave nothing",
                     r.size()),
         "does the file hold the positions, and does the map name their columns?"});
  }
  for (int axis = 0; axis < 3; ++axis) {
    if (const auto dead = find_dead_channel(r, axis)) {
      faults.push_back({RecordingFault::constant_force, dead->message,
                        dead->throughout ? "does the map name the right column? Else record anew"
                                         : "leave that stretch out, or record anew"});
    }
    for (const double sign : {1.0, -1.0}) {
      const auto clipped = find_clipped(r.f_W_N, axis, sign);
      if (!clipped) continue;
      faults.push_back({RecordingFault::saturated_force, *clipped + ": the sensor was at the end of its range",
                        "record anew with a larger range, or press less; `force-saturation` in a model stands for it"});
    }
  }
  if (const auto repeat = find_repeat(r)) {
    faults.push_back({RecordingFault::repeated_samples,
                      fmt::format("{} repeat those from {:.4g} s on to the last digit: noise never does, a buffer was "
                                  "written twice",
                                  stretch(repeat->first), t[repeat->second]),
                      "leave the repeated stretch out"});
  }
  return faults;
}

}  // namespace touchstone::recording_checks
