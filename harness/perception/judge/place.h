// How an object differs from place to place. The force of a response over depth is multiplied by a gain over the place
// in the plane across the direction of pressing: cubic B-splines (de Boor 1978), twenty spacings over the longer side
// of what was explored, by least squares. Two processes are compared cell by cell where both were there, each against
// its own force over depth, with the error that stretches of the smoothing's length show.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "harness/base/vec.h"
#include "harness/perception/judge/thresholds.h"

namespace touchstone::perception {

struct FeltSeries;
struct JudgedProcess;
struct Response;

// 1 everywhere if it has no coefficients.
struct PlaceGain {
  double spacing_m = 0.0;
  double first_m[2] = {0.0, 0.0};  // place of the first interval's beginning
  std::size_t intervals[2] = {0, 0};
  std::vector<double> coefficients;  // (intervals[0] + 3) (intervals[1] + 3)

  [[nodiscard]] double of(const FeltSeries& felt, std::size_t i) const;
};

// Least and largest place in contact along axis 1 and 2; nothing where all lie within `finest_place_m`.
using PlaceRange = std::array<std::array<double, 2>, 2>;
std::optional<PlaceRange> explored(const FeltSeries& felt, const Response& response);

// The gain that the residuals of a response show, 1 on average over the samples in contact; nothing where the places
// lie within `finest_place_m`.
std::optional<PlaceGain> place_gain(const FeltSeries& felt, const Response& response);

// What is between the two is one place.
inline constexpr double finest_place_m = 0.01;

// Standard errors that hold 95 %.
inline constexpr double normal95 = 1.959964;

struct PlaceDifference {
  Vec3 centre_m = Vec3::Zero();  // in the object's frame, on the plane through the frame's origin
  bool known = false;            // both were there
  double real_N = 0.0;           // at the same depth
  double rendered_N = 0.0;
  double jnd = 0.0;
  double standard_error = 0.0;
  double by_hand = 0.0;  // standard error of friction by another hand: no spread, but a bound
  double depth_m = 0.0;
  double share = 0.0;  // of the time in contact of the one that was there less
};

struct PlaceMap {
  std::string_view quantity = "force";
  std::string_view more = "stiffer";
  std::string_view less = "softer";
  bool uneven = false;  // one of the two differs from place to place
  double cell_m = 0.0;
  Vec3 side[2] = {Vec3::UnitX(), Vec3::UnitY()};  // of the cells, across the direction of pressing
  // Mean over the places where both were, by the time of the one that was there less, over that of its own places.
  double real_mean = 1.0;
  double rendered_mean = 1.0;
  std::vector<PlaceDifference> cells;  // where the real process was; empty: it stayed at one place

  // The cell that differs most beyond its error, if that is certain for as many looks as there are cells.
  [[nodiscard]] const PlaceDifference* strongest() const;
  [[nodiscard]] double reach(const PlaceDifference& cell) const;  // JND that it must exceed to be certain
};

struct PlaceMaps {
  PlaceMap force;
  PlaceMap friction;  // where both slid to and fro
};

// `same_motion`: the force sample by sample, the whole of it, in cells of space.
PlaceMaps place_maps(const JudgedProcess& real, const JudgedProcess& rendered, bool same_motion,
                     const Thresholds& thresholds);

// "1.9 N instead of 0.75 N (+150 %) near (12, 0, 3) mm; more in 5 of 17 places, all of them where x is above 4 mm".
std::string describe_place(const PlaceMap& map, const PlaceDifference& strongest);

}  // namespace touchstone::perception
