// Where a series most probably changes its distribution: the statistic of E-divisive.
// Source: Matteson and James, A Nonparametric Approach for Multiple Change Point Analysis of Multivariate Data, JASA
// 109 (2014), with exponent 1 of the distance, as in Apache Otava (otava/change_point_divisive/calculator.py).
#pragma once

#include <cstddef>
#include <span>

namespace touchstone::change_points {

struct EnergySplit {
  std::size_t index = 0;  // first value after the change; 0: none
  std::size_t end = 0;    // the stretch that was compared is [index, end)
  double energy = 0.0;
};

// The largest divergence between [0, index) and [index, end) over all index and end that leave at least `smallest` (at
// least 2) values on both sides. Quadratic in time, linear in memory.
EnergySplit largest_energy_split(std::span<const double> values, std::size_t smallest);

}  // namespace touchstone::change_points
