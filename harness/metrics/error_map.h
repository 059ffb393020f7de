// Where on the object the error is: the mean error around points of the surface, in bounded memory. Errors are summed
// in cubes of a grid; the value at a point weighs the cubes around it by a Gaussian, so the map is smooth and does not
// depend on how the object is triangulated.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <unordered_map>

#include "harness/base/vec.h"

namespace touchstone::metrics {

class ErrorMap {
 public:
  // `cell_m` > 0: edge of a cube. Memory grows with the surface touched, counted in cubes.
  explicit ErrorMap(double cell_m) : cell_m_(cell_m) {}

  // Samples that are not finite are left out (the metrics are invalid then).
  void add(const Vec3& contact_W_m, double error);
  // Nothing where no sample lies within one and a half cubes.
  [[nodiscard]] std::optional<double> at(const Vec3& p_W_m) const;
  [[nodiscard]] std::size_t cells() const { return cells_.size(); }

 private:
  using Key = std::array<std::int64_t, 3>;
  struct Hash {
    std::size_t operator()(const Key& key) const noexcept;
  };
  struct Cell {
    double sum = 0.0;
    double count = 0.0;
  };
  [[nodiscard]] Key key(const Vec3& p_W_m) const;

  double cell_m_;
  std::unordered_map<Key, Cell, Hash> cells_;
};

}  // namespace touchstone::metrics
