// The clock of a device whose rate itself changes slowly, as a crystal's does while it warms up: below all arrivals
// lies not a line but a parabola,
//   t(n) = line(n) + drift * ((n - middle) / half)^2,
// with n the device's numbers, and middle and half those of the recording. Of all parabolas below the arrivals this is
// the one with the least sum of distances: EnvelopeClock's criterion with one more term. The sum is convex in the three
// unknowns, so that the best drift is found by one search over EnvelopeClock's exact answer for the other two.
//   A parabola follows one-sided delays no more than a line does: a stretch of late arrivals lifts it only if it can
// stay below all others. Where the straight line already touches the arrivals everywhere, the line is the answer.
#pragma once

#include <cstdint>
#include <vector>

#include "record/envelope_clock.h"

namespace touchstone::hil {

class DriftingClock {
 public:
  // Numbers must increase strictly. Memory grows with time, about ten numbers a second of arrivals.
  void add(std::uint64_t number, double arrival_s);

  struct Axis {
    EnvelopeClock::Line line;
    double middle = 0.0, half = 1.0;  // numbers, from line.reference
    double drift_s = 0.0;             // 0: a straight line
    std::uint64_t first = 0, last = 0;

    [[nodiscard]] double at(std::uint64_t number) const;
    // Numbers per second over the whole recording.
    [[nodiscard]] double rate_Hz() const;
    // By how much the rate changed from the first number to the last, as a part of it.
    [[nodiscard]] double rate_change() const;
    // Largest of the least delays of 16 equal stretches against this axis.
    double floor_s = 0.0;
  };
  // At least two samples.
  [[nodiscard]] Axis axis() const;
  [[nodiscard]] std::uint64_t samples() const noexcept { return samples_; }

 private:
  struct Point {
    std::uint64_t number;
    double arrival_s;
  };
  struct Chunk {
    std::vector<Point> hull;
    std::uint64_t count = 0;
    double mean = 0.0, mean_square = 0.0;  // of the numbers from first_
  };
  [[nodiscard]] double floor_of(const Axis& axis) const;
  // The best axis with that drift; `cost` is its sum of distances, but for what all have in common.
  Axis with_drift(double drift_s, double middle, double half, double& cost) const;

  std::vector<Chunk> chunks_;
  double chunk_began_s_ = 0.0;
  std::uint64_t samples_ = 0, first_ = 0, last_ = 0;
};

}  // namespace touchstone::hil
