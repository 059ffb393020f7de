#include "harness/rendering/nearness.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
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

// For the surface scaled about the origin by `factor`.
double typical_distance(const Surface& surface, std::span<const Vec3> tips, double tip_radius_m, double factor) {
  std::vector<double> distances;
  const std::size_t stride = (tips.size() + most_samples - 1) / most_samples;
  for (std::size_t i = 0; i < tips.size(); i += stride) {
    distances.push_back(std::abs(factor * surface.signed_distance(tips[i] / factor) - tip_radius_m));
  }
  return stats::upper_median(std::move(distances));
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

std::optional<Misfit> find_misfit(const Surface& surface, std::span<const Vec3> tips_W_m, double tip_radius_m,
                                  const std::string& recording, const std::string& mesh_unit) {
  if (tips_W_m.empty()) return std::nullopt;
  const Box3 path = box_of(tips_W_m);
  const Box3 object = surface.bounds();
  const double path_size = path.diagonal().norm();
  const double object_size = object.diagonal().norm();
  const double distance = typical_distance(surface, tips_W_m, tip_radius_m, 1.0);
  if (!(distance > object_size || (distance > path_size && distance > far_share * object_size))) return std::nullopt;
  const std::string mesh = surface.mesh() != nullptr ? surface.mesh()->source : "the surface";
  std::string message = fmt::format("{} is nowhere near {}: typically {:.3g} m away. Recording: {}; surface: {}.",
                                    recording, mesh, distance, describe(path), describe(object));
  const double assumed = length_unit_factor(mesh_unit);
  std::string_view best_unit;
  double best = distance / 10.0;
  for (const std::string_view unit : {"um", "mm", "cm", "m", "km", "in", "ft"}) {
    const double there = typical_distance(surface, tips_W_m, tip_radius_m, length_unit_factor(unit) / assumed);
    // An inch lies between the metric units: it is meant only where it fits far better.
    constexpr double far_better = 0.1;
    const bool imperial = unit == "in" || unit == "ft";
    if (there < (imperial && !best_unit.empty() ? far_better * best : best)) {
      best = there;
      best_unit = unit;
    }
  }
  if (best_unit.empty()) {
    return Misfit{message + " No usual unit would make it fit: are both in the same frame?", std::nullopt};
  }
  return Misfit{message + fmt::format(" Is the mesh in {}? With --mesh-unit {} (now {}: a factor of {:g}) the distance "
                                      "would be {:.3g} m.",
                                      best_unit, best_unit, mesh_unit, length_unit_factor(best_unit) / assumed, best),
                best};
}

}  // namespace

bool held_in_the_air(const Surface& surface, std::span<const Vec3> tips_W_m, double tip_radius_m) {
  if (tips_W_m.empty()) return false;
  const double object_size = surface.bounds().diagonal().norm();
  if (!(box_of(tips_W_m).diagonal().norm() < held_share * object_size)) return false;
  const double distance = typical_distance(surface, tips_W_m, tip_radius_m, 1.0);
  return distance > far_share * object_size && distance <= object_size;
}

std::optional<std::string> far_from_surface(const Surface& surface, std::span<const Vec3> tips_W_m, double tip_radius_m,
                                            const std::string& recording, const std::string& mesh_unit) {
  const auto misfit = find_misfit(surface, tips_W_m, tip_radius_m, recording, mesh_unit);
  if (!misfit || (!misfit->fitting_m && held_in_the_air(surface, tips_W_m, tip_radius_m))) return std::nullopt;
  return misfit->message;
}

std::optional<std::string> fits_another_unit(const Surface& surface, std::span<const Vec3> tips_W_m,
                                             double tip_radius_m, const std::string& recording,
                                             const std::string& mesh_unit) {
  const auto misfit = find_misfit(surface, tips_W_m, tip_radius_m, recording, mesh_unit);
  // Without a unit in which the path would touch they may lie there on purpose.
  if (!misfit || !misfit->fitting_m || *misfit->fitting_m > box_of(tips_W_m).diagonal().norm()) return std::nullopt;
  return misfit->message;
}

}  // namespace touchstone::rendering
