#include "harness/golden/equal_answers.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace touchstone::golden {

namespace {

using Three = std::array<std::string_view, 3>;
constexpr Three tip{"x", "y", "z"};
constexpr Three contact{"px", "py", "pz"};
constexpr Three force{"fx", "fy", "fz"};

bool has(const TrajectoryColumns& from, const Three& names, std::size_t rows) {
  return std::ranges::all_of(names, [&](std::string_view name) {
    const std::vector<double>* const column = from.find(name);
    return column != nullptr && column->size() == rows;
  });
}

Vec3 at(const TrajectoryColumns& from, const Three& names, std::size_t row) {
  return {(*from.find(names[0]))[row], (*from.find(names[1]))[row], (*from.find(names[2]))[row]};
}

// A push along `way`, out of the surface.
bool is_along(const Vec3& force_N, const Vec3& way_m, double band_N) {
  return (force_N - force_N.norm() * way_m.normalized()).norm() <= band_N;
}

}  // namespace

std::size_t take_equal_answers(const surface::Surface& surface, const Tolerance& tolerance,
                               const TrajectoryColumns& obtained, TrajectoryColumns& expected) {
  const std::size_t rows = expected.rows();
  for (const Three& names : {tip, contact, force}) {
    if (!has(expected, names, rows) || !has(obtained, names, rows)) return 0;
  }
  const double band_m = tolerance.of("contact_position").atol;
  const double band_N = tolerance.of("force").atol;
  std::size_t taken = 0;
  for (std::size_t i = 0; i < rows; ++i) {
    const Vec3 p = at(expected, tip, i);
    const Vec3 q = at(expected, contact, i);
    const Vec3 other = at(obtained, contact, i);
    if (!((other - q).norm() > band_m) || !((at(obtained, tip, i) - p).norm() <= band_m)) continue;
    const Vec3 f = at(expected, force, i);
    const Vec3 g = at(obtained, force, i);
    const double least_m = surface.closest(p).distance_m;
    const bool equal = std::abs((q - p).norm() - least_m) <= band_m &&
                       std::abs((other - p).norm() - least_m) <= band_m &&
                       surface.closest(other).distance_m <= band_m && std::abs(f.norm() - g.norm()) <= band_N &&
                       is_along(f, q - p, band_N) && is_along(g, other - p, band_N);
    if (!equal) continue;
    ++taken;
    for (TrajectoryColumn& column : expected.columns) {
      if (std::ranges::count(contact, column.name) + std::ranges::count(force, column.name) > 0)
        column.values[i] = (*obtained.find(column.name))[i];
    }
  }
  return taken;
}

}  // namespace touchstone::golden
