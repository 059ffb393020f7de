// One axis: a joint, an actuator or a spindle without contact, or a tip that indents along a line. The torque (or
// force) over angle (or indentation) is split into what the place alone makes and what the motion adds:
//   load = h(q) + (dry + g(q)) z + viscous q' + inertia q'' + relaxing (q - q_tau),
// with h a piecewise linear function of the place (cables, gravity, springs, the stiffness of an object), z the
// direction of motion, which takes the way w to reverse: in proportion to the way, dz = 2 dq / w, |z| <= 1 (presliding;
// Dahl 1968), or 0 on the way (backlash: what rubs lies behind a gap that is crossed first), g friction that depends on
// the place, and q_tau the place low-passed with the time constant tau: one arm of a standard linear
// solid, relaxation or creep. Armstrong-Helouvry, Dupont and Canudas de Wit 1994 (sections 2 and 4) describe the terms
// of friction.
//
// Linear least squares for each width and time constant of a grid. Terms are chosen by blocks of the recording that the
// fit did not see; what the motion cannot separate is reported as such: at one speed dry and viscous friction are one
// number, and after a single loading and unloading every loss is.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace touchstone::axis {

// Any consistent units; the caller names them. `rate` may be empty: it is then found from the places.
struct AxisRun {
  std::vector<double> t_s, place, rate, load;
  std::string source;
  bool keep_rest = false;  // samples at rest count too (an indentation that is held relaxes); a joint's friction rests
};

enum class AxisTermKind {
  dry_friction,
  viscous_friction,
  inertia,
  friction_over_place,
  reversal_width,
  relaxation,
  relaxation_time
};
// "dry friction", "viscous friction", ...: as results have it.
const char* to_string(AxisTermKind kind);

struct AxisTerm {
  AxisTermKind kind = AxisTermKind::dry_friction;
  double value = 0.0;
  std::optional<double> standard_error;  // from blocks of the recording; none for what a grid was searched for
};

// What the loads on the way of a reversal look like.
enum class AxisReversal { at_once, presliding, backlash, undecided };

// What the terms so far leave of the held-out blocks, in the order in which they were taken.
struct AxisStep {
  std::string added;  // "place", "dry friction, reversal width", ...
  double left = 0.0;  // RMS
};

struct AxisFit {
  std::vector<AxisTerm> terms;              // those that the held-out blocks want
  std::vector<double> knots, over_place;    // h at its knots
  std::vector<double> friction_over_place;  // dry + g at the same knots; empty without that term
  double dry = 0.0;                         // 0 where it is no term
  double place_range = 0.0;                 // largest less smallest of h
  double before = 0.0;                      // RMS of the held-out load about its mean
  double after = 0.0;                       // RMS that the fit leaves of the held-out blocks
  double loss = 0.0;                        // work lost over a mean cycle there and back: the area of the loop
  // A run that ends where it began gives more work than it takes, by more than five deviations of what noise of load
  // and place makes of that sum: no passive object does.
  bool gives_work = false;
  std::size_t reversals = 0;
  std::vector<AxisStep> steps;
  AxisReversal reversal = AxisReversal::at_once;
  bool backlash = false;  // the shape that fits best, decided or not
  // Friction that the motion cannot split: dry alone and viscous alone leave the same on held-out blocks.
  bool friction_undecided = false;
  bool reversed = false;                        // the load drives the motion instead of resisting it
  double dry_alone = 0.0, viscous_alone = 0.0;  // the coefficient of either if it is the only one
  double dry_left = 0.0, viscous_left = 0.0;    // and what it leaves of the held-out blocks
  double slowest = 0.0, fastest = 0.0;          // 10th and 90th percentile of the speed while it moves
  std::size_t samples = 0;                      // used
};

// Throws BadData for a run that is too short, does not move, or never turns back (friction and place are then one).
AxisFit fit_axis(const AxisRun& run);

// The load that the fit predicts at each sample of the run.
std::vector<double> fitted_load(const AxisFit& fit, const AxisRun& run);

}  // namespace touchstone::axis
