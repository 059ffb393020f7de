#include "harness/rendering/nearness.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>
#include <utility>
#include <vector>

#include "harness/base/units.h"
#include "harness/stats/quantile.h"

namespace touchstone::rendering {
using surface::Surface;

namespace {

constexpr std::size_t most_samples = 1000;
// Of the object's size: farther away than the first, positions that move less than they are away belong elsewhere; a
// tip that moves by less than the second is held.
constexpr double far_share = 0.05, held_share = 0.01;

// Where a tip is, of at most `most_samples`, and with which force it presses; 0 where that is not known.
struct Place {
  Vec3 tip_W_m;
  double load_N;
};

std::vector<Place> some_places(std::span<const Vec3> tips_W_m, std::span<const double> loads_N) {
  std::vector<Place> places;
  const std::size_t stride = (tips_W_m.size() + most_samples - 1) / most_samples;
  for (std::size_t i = 0; i < tips_W_m.size(); i += stride) {
    places.push_back({tips_W_m[i], i < loads_N.size() ? loads_N[i] : 0.0});
  }
  return places;
}

struct Distance {
  double typical_m = 0.0;
  double unpressed_m = 0.0;  // what is left of it when each newton presses in equally far
};

// The depth for each newton with which the places lie nearest to the surface in the sum of their distances: the median
// of their ratios, each with its load as the weight (Laplace's regression through the origin); never outward.
double depth_per_newton(const std::vector<Place>& places, const std::vector<double>& outside_m) {
  std::vector<std::pair<double, double>> ratios;  // and weights
  double all_N = 0.0;
  for (std::size_t i = 0; i < places.size(); ++i) {
    if (!(places[i].load_N > 0.0)) continue;
    ratios.emplace_back(-outside_m[i] / places[i].load_N, places[i].load_N);
    all_N += places[i].load_N;
  }
  std::ranges::sort(ratios);
  double sum_N = 0.0;
  for (const auto& [ratio, weight] : ratios) {
    sum_N += weight;
    if (sum_N >= 0.5 * all_N) return std::max(ratio, 0.0);
  }
  return 0.0;
}

// From the surface scaled about the origin by `factor`.
Distance distance_to(const Surface& surface, const std::vector<Place>& places, double tip_radius_m, double factor) {
  std::vector<double> outside, left;
  for (const Place& place : places) {
    outside.push_back(factor * surface.signed_distance(place.tip_W_m / factor) - tip_radius_m);
  }
  const double softness = depth_per_newton(places, outside);
  for (std::size_t i = 0; i < places.size(); ++i) left.push_back(std::abs(outside[i] + softness * places[i].load_N));
  for (double& d : outside) d = std::abs(d);
  return {stats::upper_median(std::move(outside)), stats::upper_median(std::move(left))};
}

std::string describe(const Box3& box) {
  return fmt::format("x {:.4g} to {:.4g}, y {:.4g} to {:.4g}, z {:.4g} to {:.4g} m", box.min().x(), box.max().x(),
                     box.min().y(), box.max().y(), box.min().z(), box.max().z());
}

Box3 box_of(std::span<const Vec3> tips) {
  Box3 box;
  for (const Vec3& tip : tips) box.extend(tip);
  return box;
}

struct Misfit {
  std::string message;
  std::optional<double> fitting_m;  // the typical distance in the unit that fits; nothing where none does
};

struct FittingUnit {
  std::string_view name;
  Distance distance;
};

// The unit in which the places lie far nearer to the surface than in the one that was assumed, if there is one.
std::optional<FittingUnit> find_fitting_unit(const Surface& surface, const std::vector<Place>& places,
                                             double tip_radius_m, double now_m, double assumed) {
  constexpr double far_nearer = 0.1, nearer = 0.5;
  std::optional<FittingUnit> best;
  double least_m = far_nearer * now_m;
  // The usual ones first: a plane lies as near in every larger unit.
  for (const std::string_view unit : {"m", "mm", "cm", "um", "km", "in", "ft"}) {
    const Distance there = distance_to(surface, places, tip_radius_m, length_unit_factor(unit) / assumed);
    // An inch lies between the metric units: it is meant only where it fits far better.
    const bool imperial = unit == "in" || unit == "ft";
    const double enough = !best ? 1.0 : imperial ? far_nearer : nearer;
    if (there.unpressed_m < enough * least_m) {
      least_m = there.unpressed_m;
      best = {unit, there};
    }
  }
  return best;
}

// Of the path's size: what a bad registration leaves, which may by chance be less on a scaled object, though hardly so
// much less; and what none leaves.
constexpr double slightly_off = 0.01, clearly_off = 0.05, much_nearer = 1.0 / 30.0;

// Near the surface, and yet not on it: where another unit lets the forces explain the distances.
bool off_the_surface(double now_m, double fitting_m, double path_size_m) {
  return now_m > clearly_off * path_size_m || fitting_m < much_nearer * now_m;
}

std::optional<Misfit> find_misfit(const Surface& surface, std::span<const Vec3> tips_W_m,
                                  std::span<const double> loads_N, double tip_radius_m, const std::string& recording,
                                  const std::string& mesh_unit) {
  if (tips_W_m.empty()) return std::nullopt;
  const Box3 path = box_of(tips_W_m);
  const Box3 object = surface.bounds();
  const double path_size = path.diagonal().norm();
  const double object_size = object.diagonal().norm();
  const std::vector<Place> places = some_places(tips_W_m, loads_N);
  const Distance now = distance_to(surface, places, tip_radius_m, 1.0);
  const bool far =
      now.typical_m > object_size || (now.typical_m > path_size && now.typical_m > far_share * object_size);
  if (!far && (loads_N.empty() || now.unpressed_m < slightly_off * path_size)) return std::nullopt;
  const double assumed = length_unit_factor(mesh_unit);
  const auto fitting = find_fitting_unit(surface, places, tip_radius_m, now.unpressed_m, assumed);
  constexpr std::size_t fewest = 20;
  const bool off =
      fitting && places.size() >= fewest && off_the_surface(now.unpressed_m, fitting->distance.unpressed_m, path_size);
  if (!far && !off) return std::nullopt;
  const std::string mesh = surface.mesh() != nullptr ? surface.mesh()->source : "the surface";
  std::string message =
      far ? fmt::format("{} is nowhere near {}: typically {:.3g} m away.", recording, mesh, now.typical_m)
          : fmt::format(
                "{} touches, but not where {} is: typically {:.3g} m away from where its forces would press it.",
                recording, mesh, now.unpressed_m);
  message += fmt::format(" Recording: {}; surface: {}.", describe(path), describe(object));
  if (!fitting) return Misfit{message + " No usual unit would make it fit: are both in the same frame?", std::nullopt};
  message += fmt::format(
      " Is the mesh in {0}? With --mesh-unit {0} (now {1}: a factor of {2:g}) the distance would be "
      "{3:.3g} m.",
      fitting->name, mesh_unit, length_unit_factor(fitting->name) / assumed, fitting->distance.unpressed_m);
  return Misfit{message, fitting->distance.typical_m};
}

}  // namespace

bool held_in_the_air(const Surface& surface, std::span<const Vec3> tips_W_m, double tip_radius_m) {
  if (tips_W_m.empty()) return false;
  const double object_size = surface.bounds().diagonal().norm();
  if (!(box_of(tips_W_m).diagonal().norm() < held_share * object_size)) return false;
  const double distance = distance_to(surface, some_places(tips_W_m, {}), tip_radius_m, 1.0).typical_m;
  return distance > far_share * object_size && distance <= object_size;
}

std::optional<std::string> far_from_surface(const Surface& surface, std::span<const Vec3> tips_W_m,
                                            std::span<const double> loads_N, double tip_radius_m,
                                            const std::string& recording, const std::string& mesh_unit) {
  const auto misfit = find_misfit(surface, tips_W_m, loads_N, tip_radius_m, recording, mesh_unit);
  if (!misfit || (!misfit->fitting_m && held_in_the_air(surface, tips_W_m, tip_radius_m))) return std::nullopt;
  return misfit->message;
}

std::optional<std::string> fits_another_unit(const Surface& surface, std::span<const Vec3> tips_W_m,
                                             double tip_radius_m, const std::string& recording,
                                             const std::string& mesh_unit) {
  const auto misfit = find_misfit(surface, tips_W_m, {}, tip_radius_m, recording, mesh_unit);
  // Without a unit in which the path would touch they may lie there on purpose.
  if (!misfit || !misfit->fitting_m || *misfit->fitting_m > box_of(tips_W_m).diagonal().norm()) return std::nullopt;
  return misfit->message;
}

}  // namespace touchstone::rendering
