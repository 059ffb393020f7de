#include "harness/recording/extent_check.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "harness/base/units.h"

namespace touchstone::recording {
namespace {

// Where there is contact the boxes touch, but for the tip's radius; farther apart than this many times the larger of
// the two diagonals is nowhere near.
constexpr double most_apart = 0.5;
// One this many times smaller than the other is no likely scan of it.
constexpr double most_ratio = 200.0;

double size_of(const Box3& box) { return box.diagonal().norm(); }

bool near_each_other(const Box3& a, const Box3& b) {
  return a.exteriorDistance(b) <= most_apart * std::max(size_of(a), size_of(b));
}

bool alike(const Box3& a, const Box3& b) {
  return std::max(size_of(a), size_of(b)) <= most_ratio * std::min(size_of(a), size_of(b));
}

std::string extents(const Box3& box) {
  const Vec3 size = box.diagonal();
  const Vec3 centre = box.center();
  return fmt::format("{:.3g} x {:.3g} x {:.3g} m around ({:.3g}, {:.3g}, {:.3g}) m", size.x(), size.y(), size.z(),
                     centre.x(), centre.y(), centre.z());
}

// The unit in which the mesh would overlap the recording with a likely size, nearest in size first.
std::string fitting_unit(const Box3& recording, const Box3& mesh, const std::string& mesh_unit) {
  const double read_in = length_unit_factor(mesh_unit);
  for (const char* unit : {"mm", "m", "cm", "in", "ft", "um", "km"}) {
    const double scale = length_unit_factor(unit) / read_in;
    if (unit == mesh_unit) continue;
    const Box3 scaled(mesh.min() * scale, mesh.max() * scale);
    const double larger = std::max(size_of(scaled), size_of(recording));
    const double smaller = std::min(size_of(scaled), size_of(recording));
    if (scaled.exteriorDistance(recording) <= 0.1 * larger && larger <= 20.0 * smaller) return unit;
  }
  return "";
}

}  // namespace

std::optional<ExtentMismatch> check_extents(const Box3& recording, const Box3& mesh, const std::string& mesh_unit) {
  const bool apart = !near_each_other(recording, mesh);
  if (!apart && alike(recording, mesh)) return std::nullopt;
  std::string message =
      fmt::format("the recording ({}) {} the mesh ({}, read in {})", extents(recording),
                  apart ? "is nowhere near" : "is of quite another size than", extents(mesh), mesh_unit);
  const std::string unit = fitting_unit(recording, mesh, mesh_unit);
  if (!unit.empty()) {
    message += fmt::format("; is the mesh in {0}? It would fit: --mesh-unit {0}", unit);
  } else {
    message += "; is the mesh in mm (--mesh-unit mm), and are both in the same frame?";
  }
  return ExtentMismatch{apart, std::move(message)};
}

}  // namespace touchstone::recording
