// Where the force error of a comparison sits: by axis, by what the tip was doing, and where on the object. For telling
// what kind of fault a regression is.
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "harness/base/vec.h"
#include "harness/golden/comparison/trajectory_columns.h"

namespace touchstone::golden {

struct RegimeError {
  std::string name;  // "free air", "contact event", "holding", "loading", "unloading", "sliding"
  std::size_t rows = 0;
  double rms_N = 0.0;
  double share = 0.0;  // of the summed squared error
};

struct ErrorPlaces {
  std::array<double, 3> axis_share{};  // of the summed squared error, per force axis
  std::vector<RegimeError> regimes;    // those that occur
  Box3 region_W_m;                     // of the tip where the largest errors sum to nine tenths; empty without error
  double first_t_s = 0.0;              // of that region's rows
  double last_t_s = 0.0;
};

// Regimes from the golden: within 10 ms of a contact event; free air; else by the tip's velocity: under 2 % of the
// run's fastest it holds, else it slides where it moves across the force more than along it, and loads or unloads where
// it moves against or with it. Both sides need the columns t, x, y, z, fx, fy, fz and equal rows; without them
// everything is empty.
ErrorPlaces locate_error(const TrajectoryColumns& expected, const TrajectoryColumns& obtained);
std::string to_table(const ErrorPlaces& places);

}  // namespace touchstone::golden
