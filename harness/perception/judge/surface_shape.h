// The object's own shape where it is curved or slopes against the direction of pressing: then contact begins at another
// depth from place to place. A paraboloid over the place across that direction, by least squares of the depths at which
// the same force is met:
//
//   depth = g(force) + c . (x, y, x^2, x y, y^2)
//
// g straight between knots. It is taken where it explains most of how these depths spread; depth is then measured from
// it along its normal, and the force is turned into the frame of that normal.
#pragma once

#include <array>
#include <optional>

#include "harness/perception/judge/felt_series.h"

namespace touchstone::perception {

struct SurfaceShape {
  double middle_m[2] = {0.0, 0.0};
  double scale_m = 1.0;  // of the places in the terms
  std::array<double, 5> height_m{};

  struct At {
    double height_m = 0.0;
    double slope[2] = {0.0, 0.0};
  };
  [[nodiscard]] At at(double x_m, double y_m) const;
};

std::optional<SurfaceShape> surface_shape(const FeltSeries& felt, double least_force_N);

FeltSeries on_shape(FeltSeries felt, const SurfaceShape& shape);

}  // namespace touchstone::perception
