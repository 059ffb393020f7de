#include "record/drifting_clock.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace touchstone::hil {
namespace {

// Within a chunk the drift is nothing: a rate that changes by 1e-6 in 10 s moves its middle by 0.01 us.
constexpr double chunk_s = 1.0;
// The parabola is taken if the line is off by more than this and the parabola by less than half of that: below it the
// difference is the scatter of the shortest delays.
constexpr double least_floor_s = 20e-6;
constexpr double better = 0.5;
constexpr std::size_t stretches = 16;

}  // namespace

double DriftingClock::Axis::at(std::uint64_t number) const {
  if (drift_s == 0.0) return line.at(number);
  const double n = number >= line.reference ? static_cast<double>(number - line.reference)
                                            : -static_cast<double>(line.reference - number);
  const double u = (n - middle) / half;
  return line.at(number) + drift_s * u * u;
}

double DriftingClock::Axis::rate_Hz() const { return static_cast<double>(last - first) / (at(last) - at(first)); }

double DriftingClock::Axis::rate_change() const {
  // dt/dn = slope + 2 drift u / half, from u = -1 to u = 1.
  return -4.0 * drift_s / half / line.seconds_per_sample;
}

void DriftingClock::add(std::uint64_t number, double arrival_s) {
  if (samples_++ == 0) first_ = number;
  last_ = number;
  if (chunks_.empty() || arrival_s - chunk_began_s_ > chunk_s) {
    chunks_.emplace_back();
    chunk_began_s_ = arrival_s;
  }
  Chunk& chunk = chunks_.back();
  const auto n = static_cast<double>(number - first_);
  ++chunk.count;
  chunk.mean += (n - chunk.mean) / static_cast<double>(chunk.count);
  chunk.mean_square += (n * n - chunk.mean_square) / static_cast<double>(chunk.count);
  auto& hull = chunk.hull;
  while (hull.size() >= 2) {
    const Point &a = hull[hull.size() - 2], &b = hull.back();
    const double before = (b.arrival_s - a.arrival_s) * static_cast<double>(number - b.number),
                 after = (arrival_s - b.arrival_s) * static_cast<double>(b.number - a.number);
    if (before < after) break;
    hull.pop_back();
  }
  hull.push_back({number, arrival_s});
}

double DriftingClock::floor_of(const Axis& axis) const {
  std::array<double, stretches> least{};
  least.fill(std::numeric_limits<double>::infinity());
  const double span = static_cast<double>(last_ - first_) + 1.0;
  for (const Chunk& chunk : chunks_) {
    for (const Point& p : chunk.hull) {
      const auto stretch = static_cast<std::size_t>(static_cast<double>(p.number - first_) / span * stretches);
      double& here = least[std::min(stretch, stretches - 1)];
      here = std::min(here, p.arrival_s - axis.at(p.number));
    }
  }
  double floor = 0.0;
  for (const double here : least) {
    if (std::isfinite(here)) floor = std::max(floor, here);
  }
  return floor;
}

DriftingClock::Axis DriftingClock::with_drift(double drift_s, double middle, double half, double& cost) const {
  // The best line below what is left of the corners when the parabola is taken off. The hull of the whole is that of
  // the chunks' corners: taking off what bends a chunk by less than a nanosecond leaves its corners what they are.
  std::vector<Point> hull;
  const auto bend = [&](std::uint64_t number) {
    const double u = (static_cast<double>(number - first_) - middle) / half;
    return drift_s * u * u;
  };
  double mean = 0.0, mean_square = 0.0;
  for (const Chunk& chunk : chunks_) {
    const double weight = static_cast<double>(chunk.count) / static_cast<double>(samples_);
    mean += weight * chunk.mean;
    mean_square += weight * chunk.mean_square;
    for (const Point& p : chunk.hull) {
      const double left = p.arrival_s - bend(p.number);
      while (hull.size() >= 2) {
        const Point &a = hull[hull.size() - 2], &b = hull.back();
        if ((b.arrival_s - a.arrival_s) * static_cast<double>(p.number - b.number) <
            (left - b.arrival_s) * static_cast<double>(b.number - a.number))
          break;
        hull.pop_back();
      }
      hull.push_back({p.number, left});
    }
  }
  std::size_t right = 1;
  while (right + 1 < hull.size() && static_cast<double>(hull[right].number - first_) < mean) ++right;
  const Point &a = hull[right - 1], &b = hull[right];
  Axis axis;
  axis.line = {(b.arrival_s - a.arrival_s) / static_cast<double>(b.number - a.number), a.number, a.arrival_s};
  axis.middle = middle - static_cast<double>(a.number - first_);
  axis.half = half;
  axis.drift_s = drift_s;
  axis.first = first_;
  axis.last = last_;
  // Mean height of the parabola; the higher it lies, the less the sum of the distances.
  const double mean_bend = drift_s * (mean_square - 2.0 * middle * mean + middle * middle) / (half * half);
  cost = -(axis.line.at(first_) + axis.line.seconds_per_sample * mean + mean_bend);
  return axis;
}

DriftingClock::Axis DriftingClock::axis() const {
  const double half = 0.5 * static_cast<double>(last_ - first_), middle = half;
  double cost = 0.0;
  Axis straight = with_drift(0.0, middle, half, cost);
  straight.floor_s = floor_of(straight);
  if (chunks_.size() < stretches || straight.floor_s <= least_floor_s) return straight;
  // The drift cannot be larger than what the line leaves; golden section over it.
  constexpr double golden = 0.6180339887498949;
  double low = -4.0 * straight.floor_s, high = 4.0 * straight.floor_s;
  double cost_a = 0.0, cost_b = 0.0;
  double a = high - golden * (high - low), b = low + golden * (high - low);
  with_drift(a, middle, half, cost_a);
  with_drift(b, middle, half, cost_b);
  while (high - low > 1e-8) {
    if (cost_a <= cost_b) {
      high = b, b = a, cost_b = cost_a;
      a = high - golden * (high - low);
      with_drift(a, middle, half, cost_a);
    } else {
      low = a, a = b, cost_a = cost_b;
      b = low + golden * (high - low);
      with_drift(b, middle, half, cost_b);
    }
  }
  Axis bent = with_drift(0.5 * (low + high), middle, half, cost);
  bent.floor_s = floor_of(bent);
  return bent.floor_s < better * straight.floor_s ? bent : straight;
}

}  // namespace touchstone::hil
