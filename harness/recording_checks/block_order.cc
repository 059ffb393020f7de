#include "harness/recording_checks/block_order.h"

#include <fmt/format.h>

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>

#include "harness/stats/quantile.h"

namespace touchstone::recording_checks {
namespace {

constexpr std::size_t fewest_blocks = 6;
constexpr std::size_t most_blocks = 512;
constexpr std::size_t fewest_samples = 8;  // of a block
constexpr std::size_t most_points = 16;    // of a block: enough to know it by
constexpr std::size_t most_shifts = 1500;
constexpr double longest_lag_s = 1.0;
constexpr double longest_step = 4.0;   // of the typical step: a longer one is a gap
constexpr double longest_gap = 0.125;  // of a block: it may have such a gap in it
constexpr double most_missing = 0.05;  // of the time, where a part may be looked for at the other end

struct Moments {
  double mean = 0.0, deviation = 0.0;
};

Moments moments_of(std::span<const double> values) {
  Moments m;
  const auto n = static_cast<double>(values.size());
  for (const double v : values) m.mean += v / n;
  double square = 0.0;
  for (const double v : values) square += (v - m.mean) * (v - m.mean) / n;
  m.deviation = std::sqrt(square);
  return m;
}

// A block as a few means over equal parts of it.
std::vector<double> shape_of(std::span<const double> values) {
  const std::size_t points = std::min(most_points, values.size());
  std::vector<double> shape(points, 0.0);
  for (std::size_t p = 0; p < points; ++p) {
    const std::size_t from = values.size() * p / points, to = values.size() * (p + 1) / points;
    for (std::size_t i = from; i < to; ++i) shape[p] += values[i] / static_cast<double>(to - from);
  }
  return shape;
}

std::vector<double> standard_shape(std::span<const double> values, const Moments& all) {
  auto shape = shape_of(values);
  for (double& v : shape) v = (v - all.mean) / all.deviation;
  return shape;
}

double square_between(const std::vector<double>& a, const std::vector<double>& b, bool backwards) {
  const std::size_t n = std::min(a.size(), b.size());
  double square = 0.0;
  for (std::size_t i = 0; i < n; ++i) square += std::pow(a[backwards ? n - 1 - i : i] - b[i], 2);
  return square;
}

struct Shapes {
  std::vector<std::vector<double>> measured, modelled;
};

std::vector<std::vector<double>> costs(const Shapes& shapes, bool backwards) {
  std::vector<std::vector<double>> cost(shapes.measured.size(), std::vector<double>(shapes.modelled.size()));
  for (std::size_t r = 0; r < cost.size(); ++r) {
    for (std::size_t c = 0; c < cost.size(); ++c) {
      cost[r][c] = square_between(shapes.measured[r], shapes.modelled[c], backwards);
    }
  }
  return cost;
}

double total(const std::vector<std::vector<double>>& cost, const std::vector<std::size_t>& place) {
  double sum = 0.0;
  for (std::size_t r = 0; r < place.size(); ++r) sum += cost[r][place[r]];
  return sum;
}

std::vector<double> in_order(const std::vector<std::vector<double>>& shapes, const std::vector<std::size_t>& place) {
  std::vector<double> values;
  for (const std::size_t p : place) values.insert(values.end(), shapes[p].begin(), shapes[p].end());
  return values;
}

// Most blocks moved alike, by little: a lag of the clock, which is another fault (load_lag.h) and an effect that a
// model may have.
bool is_small_shift(const std::vector<std::size_t>& place, double block_s) {
  std::map<std::ptrdiff_t, std::size_t> shifts;
  for (std::size_t k = 0; k < place.size(); ++k) {
    ++shifts[static_cast<std::ptrdiff_t>(place[k]) - static_cast<std::ptrdiff_t>(k)];
  }
  for (const auto& [shift, count] : shifts) {
    const double away_s = block_s * std::abs(static_cast<double>(shift));
    if (2 * count > place.size() && away_s <= longest_lag_s) return true;
  }
  return false;
}

// Between samples, without the gaps of parts that are left out.
double interval_without_gaps(std::span<const double> t_s) {
  std::vector<double> steps;
  for (std::size_t i = 1; i < t_s.size(); ++i) steps.push_back(t_s[i] - t_s[i - 1]);
  const double typical = stats::median(steps);
  double sum = 0.0;
  std::size_t count = 0;
  for (const double step : steps) {
    if (step > longest_step * typical) continue;
    sum += step;
    ++count;
  }
  return sum / static_cast<double>(count);
}

// Where blocks of `length` samples begin. None goes over a gap: its parts would be of two times, and partners of
// neither.
std::vector<std::size_t> block_starts(std::span<const double> t_s, std::size_t length, double block_s) {
  std::vector<std::size_t> starts;
  std::size_t begin = 0;
  while (begin + length <= t_s.size()) {
    std::size_t gap = 0;
    for (std::size_t i = begin + 1; i < begin + length; ++i) {
      if (t_s[i] - t_s[i - 1] > longest_gap * block_s) gap = i;
    }
    if (gap == 0) starts.push_back(begin);
    begin = gap == 0 ? begin + length : gap;
  }
  return starts;
}

std::optional<BlockOrder> try_length(std::span<const double> t_s, std::span<const double> measured,
                                     std::span<const double> modelled, std::size_t length, double block_s,
                                     double most_left) {
  if (length < fewest_samples || measured.size() / length > most_blocks) return std::nullopt;
  const auto starts = block_starts(t_s, length, block_s);
  const std::size_t blocks = starts.size();
  if (blocks < fewest_blocks) return std::nullopt;
  const Moments a = moments_of(measured), b = moments_of(modelled);
  if (!(a.deviation > 0.0) || !(b.deviation > 0.0)) return std::nullopt;
  // Both in deviations from their means: no fit that a wrong order would spoil.
  Shapes shapes, between;
  for (const std::size_t start : starts) {
    shapes.measured.push_back(standard_shape(measured.subspan(start, length), a));
    shapes.modelled.push_back(standard_shape(modelled.subspan(start, length), b));
    // Half a block on: no such piece was ever cut.
    const std::size_t half = std::min(start + length / 2, t_s.size() - length);
    between.modelled.push_back(standard_shape(modelled.subspan(half, length), b));
  }
  between.measured = shapes.measured;
  const auto cost = costs(shapes, false);
  std::vector<std::size_t> same(blocks);
  for (std::size_t k = 0; k < blocks; ++k) same[k] = k;
  const auto place = assign(cost);
  const double best = total(cost, place);
  if (!(best < most_left * total(cost, same))) return std::nullopt;
  // What chance finds in pieces that were never cut.
  for (const auto& [never, reversed] : {std::pair{&shapes, true}, {&between, false}, {&between, true}}) {
    const auto by_chance = costs(*never, reversed);
    if (!(best < most_left * total(by_chance, assign(by_chance)))) return std::nullopt;
  }
  if (is_small_shift(place, block_s)) return std::nullopt;
  BlockOrder order{block_s, blocks, 0, 0.0, 0.0};
  for (std::size_t k = 0; k < blocks; ++k) order.moved += place[k] != k ? 1 : 0;
  const auto own = in_order(shapes.measured, same);
  order.correlation = correlation(own, in_order(shapes.modelled, same));
  order.reordered = correlation(own, in_order(shapes.modelled, place));
  return order;
}

// At most `most_shifts` of the values, in deviations from their mean; empty where they do not vary.
Eigen::VectorXd thinned(std::span<const double> values) {
  const std::size_t points = std::min(most_shifts, values.size());
  std::vector<double> few;
  for (std::size_t i = 0; i < points; ++i) few.push_back(values[i * values.size() / points]);
  const Moments m = moments_of(few);
  if (!(m.deviation > 0.0)) return {};
  return (Eigen::VectorXd::Map(few.data(), static_cast<Eigen::Index>(points)).array() - m.mean) / m.deviation;
}

// The shift of `measured` round its ends that makes it follow `modelled` best, and the correlation that it brings: of
// deviations from means, which no shift changes.
std::pair<Eigen::Index, double> best_shift(const Eigen::VectorXd& measured, const Eigen::VectorXd& modelled) {
  const Eigen::Index n = measured.size();
  const Eigen::VectorXd twice = measured.replicate(2, 1);
  std::pair<Eigen::Index, double> best{0, -std::numeric_limits<double>::infinity()};
  for (Eigen::Index shift = 0; shift < n; ++shift) {
    const double c = twice.segment(shift, n).dot(modelled) / static_cast<double>(n);
    if (c > best.second) best = {shift, c};
  }
  return best;
}

std::optional<BlockOrder> try_rotation(std::span<const double> measured, std::span<const double> modelled,
                                       double duration_s, double most_left) {
  const Eigen::VectorXd own = thinned(measured), model = thinned(modelled);
  if (own.size() == 0 || model.size() == 0) return std::nullopt;
  const auto left = [](double c) { return 1.0 - c * c; };
  const double as_is = own.dot(model) / static_cast<double>(own.size());
  const auto [shift, shifted] = best_shift(own, model);
  if (!(left(shifted) < most_left * left(as_is)) ||
      !(left(shifted) < most_left * left(best_shift(own.reverse(), model).second)))
    return std::nullopt;
  // A small shift is a lag of the clock: another fault (load_lag.h), or an effect that a model may have.
  const double share = static_cast<double>(shift) / static_cast<double>(own.size());
  const double away_s = duration_s * std::min(share, 1.0 - share);
  if (!(away_s > longest_lag_s)) return std::nullopt;
  return BlockOrder{duration_s * share, 2, 2, as_is, shifted};
}

}  // namespace

std::string BlockOrder::remedy() const {
  if (blocks == 2) return fmt::format("with the first {:.3g} s of the force at its end", block_s);
  return fmt::format("with {} of the {} blocks of {:.4g} s in another order", moved, blocks, block_s);
}

double correlation(std::span<const double> a, std::span<const double> b) {
  const Moments ma = moments_of(a), mb = moments_of(b);
  if (!(ma.deviation > 0.0) || !(mb.deviation > 0.0)) return 0.0;
  double sum = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += (a[i] - ma.mean) * (b[i] - mb.mean);
  return sum / (static_cast<double>(a.size()) * ma.deviation * mb.deviation);
}

std::vector<std::size_t> assign(const std::vector<std::vector<double>>& cost) {
  // Shortest augmenting paths with potentials (Jonker and Volgenant 1987), rows and columns counted from 1.
  const std::size_t n = cost.size();
  std::vector<double> u(n + 1, 0.0), v(n + 1, 0.0);
  std::vector<std::size_t> row_of(n + 1, 0), way(n + 1, 0);
  for (std::size_t row = 1; row <= n; ++row) {
    row_of[0] = row;
    std::size_t column = 0;
    std::vector<double> least(n + 1, std::numeric_limits<double>::infinity());
    std::vector<char> used(n + 1, 0);
    do {
      used[column] = 1;
      const std::size_t at = row_of[column];
      double delta = std::numeric_limits<double>::infinity();
      std::size_t next = 0;
      for (std::size_t c = 1; c <= n; ++c) {
        if (used[c] != 0) continue;
        const double reduced = cost[at - 1][c - 1] - u[at] - v[c];
        if (reduced < least[c]) least[c] = reduced, way[c] = column;
        if (least[c] < delta) delta = least[c], next = c;
      }
      for (std::size_t c = 0; c <= n; ++c) {
        if (used[c] != 0) {
          u[row_of[c]] += delta, v[c] -= delta;
        } else {
          least[c] -= delta;
        }
      }
      column = next;
    } while (row_of[column] != 0);
    while (column != 0) {
      row_of[column] = row_of[way[column]];
      column = way[column];
    }
  }
  std::vector<std::size_t> place(n);
  for (std::size_t c = 1; c <= n; ++c) place[row_of[c] - 1] = c - 1;
  return place;
}

std::optional<BlockOrder> find_wrong_order(std::span<const double> t_s, std::span<const double> measured,
                                           std::span<const double> modelled, double most_left) {
  if (t_s.size() < fewest_blocks * fewest_samples) return std::nullopt;
  for (std::size_t i = 0; i < t_s.size(); ++i) {
    if (!std::isfinite(measured[i]) || !std::isfinite(modelled[i])) return std::nullopt;
  }
  // A load that follows its model needs no other order.
  constexpr double follows = 0.9;
  if (correlation(measured, modelled) > follows) return std::nullopt;
  const double duration_s = t_s.back() - t_s.front();
  const double interval_s = interval_without_gaps(t_s);
  std::optional<BlockOrder> found;
  // Round numbers of seconds: loggers and people cut files so.
  for (const double block_s : {0.1, 0.2, 0.25, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 30.0, 60.0}) {
    const auto length = static_cast<std::size_t>(std::lround(block_s / interval_s));
    const auto order = try_length(t_s, measured, modelled, length, block_s, most_left);
    if (order && (!found || order->reordered > found->reordered)) found = order;
  }
  if (found) return found;
  // Samples of every other block cannot be moved along as a whole.
  const double covered_s = interval_s * static_cast<double>(t_s.size() - 1);
  if (covered_s < (1.0 - most_missing) * duration_s) return std::nullopt;
  return try_rotation(measured, modelled, duration_s, most_left);
}

}  // namespace touchstone::recording_checks
