// The clock of a device that numbers its samples, from when they arrived. Delays on the way are never negative: an
// arrival is late by what network, kernel and scheduler took, and never early. The device's time is therefore the line
// below all arrivals that lies closest to them, not the line through their middle, which every delay pulls up.
//   Of all lines below the points, the one with the least sum of distances is the edge of their lower convex hull above
// the mean of the numbers: Moon, Skelly and Towsley, "Estimation and removal of clock skew from network delay
// measurements", INFOCOM 1999. The hull is kept point by point, in memory that grows with its corners only.
#pragma once

#include <cstdint>
#include <vector>

namespace touchstone::hil {

class EnvelopeClock {
 public:
  // Numbers must increase strictly.
  void add(std::uint64_t number, double arrival_s);

  struct Line {
    double seconds_per_sample = 0.0;
    std::uint64_t reference = 0;  // a number at which the line touches an arrival
    double at_reference_s = 0.0;

    [[nodiscard]] double at(std::uint64_t number) const {
      const double distance =
          number >= reference ? static_cast<double>(number - reference) : -static_cast<double>(reference - number);
      return at_reference_s + seconds_per_sample * distance;
    }
  };
  // At least two samples.
  [[nodiscard]] Line line() const;
  [[nodiscard]] std::uint64_t samples() const noexcept { return samples_; }

 private:
  struct Corner {
    std::uint64_t number;
    double arrival_s;
  };
  std::vector<Corner> hull_;
  std::uint64_t samples_ = 0;
  std::uint64_t first_ = 0;
  double mean_from_first_ = 0.0;
};

}  // namespace touchstone::hil
