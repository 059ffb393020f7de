// The object as a response: force over depth, its part that goes with the rate of depth (damping, or a delay of force
// behind motion), and lateral force with and without sliding. Two recordings are compared by their responses, so that
// another depth, speed, duration or number of presses is no difference between objects.
//
//   F_0(d, d')   = a(d) + b(d) d'                    along the outward direction
//   F_i(d, s)    = a_i(d) + c(d) s_i / sqrt(s^2 + s0^2)   across, i = 1, 2; s the velocity of sliding, s0 = 1 mm/s
//
// times a gain over place (place.h) where the object differs from place to place. a, b, c are straight between knots.
// Least squares over the samples in contact; the spread comes from leaving out one of jackknife_blocks stretches of
// time after the other (block jackknife, Kuensch 1989), which needs no assumption about how noise is correlated within
// a stretch.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <vector>

#include "harness/perception/filters/weber_law.h"
#include "harness/perception/judge/felt_series.h"
#include "harness/perception/judge/place.h"

namespace touchstone::perception {

inline constexpr std::size_t jackknife_blocks = 16;

// Depths are from first contact. The same grid serves both recordings of a pair.
struct DepthGrid {
  double spacing_m = 0.0;
};

struct ResponseCurves {
  // Values at knots 0, 1, 2, ... times the spacing.
  std::vector<double> normal_N;               // a
  std::vector<double> normal_N_s_per_m;       // b
  std::array<std::vector<double>, 2> side_N;  // a_1, a_2
  std::vector<double> friction_N;             // c
};

struct Response {
  double lag_s = 0.0;  // of force behind motion; the curves are over the motion of that long ago
  DepthGrid grid;
  double contact_m = 0.0;             // depth of first contact in the series' own origin
  bool begins_free = false;           // whether there is a first contact; else contact_m is the least depth
  double deepest_m = 0.0;             // from contact
  std::vector<double> seen;           // weight of samples at every knot
  std::vector<double> speed_m_per_s;  // root mean square rate of depth at every knot
  std::vector<double> slid;           // share of the samples at every knot that slide
  std::array<std::vector<double>, 2> slid_towards;  // their mean direction: as long as 1 if all slide one way
  std::vector<double> slid_depth_m;                 // their mean depth: where the friction is known
  std::vector<double> slid_m_per_s;                 // their root mean square speed
  // Slow force that the curves do not follow, root mean square at every knot: along the direction of pressing, and
  // across it while the hand slides, or rests, throughout. What another hand meets may differ by it.
  std::vector<double> left_N;
  std::vector<double> left_side_N;
  PlaceGain gain;  // over place, of all curves
  ResponseCurves curves;
  std::vector<ResponseCurves> without;  // without block 0 .. jackknife_blocks - 1

  [[nodiscard]] std::size_t knots() const noexcept { return seen.size(); }
};

struct FirstContact {
  double depth_m = 0.0;
  bool begins_free = false;
};
// Where the mean force over depth first exceeds the absolute threshold of force, carried back along its slope to no
// force, or to the steady one of free air.
FirstContact first_contact(const FeltSeries& felt, const WeberLaw& force);

// A tenth of the deepest press of the reference.
DepthGrid depth_grid(const FeltSeries& felt, const FirstContact& contact);

// Nothing if no knot is seen by enough samples.
std::optional<Response> fit_response(const FeltSeries& felt, const FirstContact& contact, const DepthGrid& grid,
                                     const PlaceGain& gain = {});
// The same with the gain over place, if that leaves less than half of the squares and changes the force by more than a
// third of what can be noticed; else nothing.
std::optional<Response> with_place(const Response& response, const FeltSeries& felt);

// Sum of the squared residuals along the outward direction, in contact and in the air.
double residual_squares_N2(const Response& response, const FeltSeries& felt);
// Fills in what is left: means over 0.02 s, without what white noise adds to them.
void measure_left(Response& response, const FeltSeries& felt);

// The delay that the rate's part of the force amounts to: b = -lag a' at every depth, by least squares; below 0 for
// damping.
double apparent_lag_s(const Response& response, const ResponseCurves& curves);

// Straight between knots; held beyond the last.
double at_depth(const std::vector<double>& curve, double depth_m, const DepthGrid& grid);
// Force along axis 0, 1, 2 of sample i by the response.
std::array<double, 3> expected_force_N(const Response& response, const FeltSeries& felt, double contact_m,
                                       std::size_t i);

}  // namespace touchstone::perception
