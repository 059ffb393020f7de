// The terms of an axis (axis_fit.h) as columns of a linear model.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "axis_fit.h"

namespace touchstone::axis {

inline constexpr std::size_t fewest_samples = 100;
inline constexpr Eigen::Index friction_knots = 5;
// Slower than this share of the usual speed counts as rest: the sign of the speed is noise there, and dry friction has
// any value up to its own.
inline constexpr double share_at_rest = 0.1;

// Which terms, beside h(q).
struct AxisStructure {
  Eigen::Index knots = 12;
  bool dry = false, viscous = false, inertia = false, friction_over_place = false;
  double width = 0.0;     // of a reversal; 0: at once
  bool backlash = false;  // within that width the load is away, in place of turning in proportion to the way
  double tau_s = 0.0;     // of relaxation; 0: none
  [[nodiscard]] Eigen::Index terms() const {
    return Eigen::Index{dry} + Eigen::Index{viscous} + Eigen::Index{inertia} + (tau_s > 0.0 ? 1 : 0);
  }
  [[nodiscard]] Eigen::Index columns() const { return knots + terms() + (friction_over_place ? friction_knots : 0); }
};

// Every sample of the run, with what the terms need; `used` are those that a fit sees.
struct AxisSamples {
  std::vector<double> t_s, place, rate, acceleration, load;
  std::vector<std::size_t> used;
  double lowest = 0.0, highest = 0.0;
  double usual_speed = 0.0;
};

// Throws BadData if too few samples move.
AxisSamples samples_of(const AxisRun& run);

// The direction of motion at every sample, within [-1, 1]: at rest that of the last motion. After a reversal it turns
// at once (width 0), in proportion to the way (presliding), or is 0 until the width is crossed (backlash).
std::vector<double> directions(const AxisSamples& s, double width, bool backlash);

// place - its low pass, at every sample.
std::vector<double> high_passed(const AxisSamples& s, double tau_s);

// Weights of the two hat functions beside a place.
struct AxisHat {
  Eigen::Index left = 0;
  double share = 0.0;
};

AxisHat hat_at(const AxisSamples& s, double place, Eigen::Index knots);
double knot_place(const AxisSamples& s, Eigen::Index k, Eigen::Index knots);

// Rows: the samples of `which`. Columns: hats over the place, dry, viscous, inertia, relaxation, hats of friction.
Eigen::MatrixXd design_of(const AxisSamples& s, const AxisStructure& structure, const std::vector<std::size_t>& which);

}  // namespace touchstone::axis
