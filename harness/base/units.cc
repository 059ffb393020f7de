#include "harness/base/units.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

#include "harness/base/error.h"

namespace touchstone {
namespace {

struct Unit {
  Dimension dimension;
  std::string_view name;
  double factor;
};

constexpr std::array units{
    Unit{Dimension::time, "s", 1.0},      Unit{Dimension::time, "ms", 1e-3},    Unit{Dimension::time, "us", 1e-6},
    Unit{Dimension::length, "m", 1.0},    Unit{Dimension::length, "cm", 1e-2},  Unit{Dimension::length, "mm", 1e-3},
    Unit{Dimension::length, "um", 1e-6},  Unit{Dimension::length, "km", 1e3},   Unit{Dimension::force, "N", 1.0},
    Unit{Dimension::force, "mN", 1e-3},   Unit{Dimension::force, "kN", 1e3},    Unit{Dimension::torque, "Nm", 1.0},
    Unit{Dimension::torque, "Nmm", 1e-3}, Unit{Dimension::torque, "mNm", 1e-3},
};

// Of meshes alone: CAD has them, our recordings do not (the international inch and foot, NIST SP 811).
constexpr std::array mesh_units{Unit{Dimension::length, "in", 0.0254}, Unit{Dimension::length, "ft", 0.3048}};

}  // namespace

std::optional<double> si_factor(Dimension dimension, std::string_view unit) {
  for (const Unit& u : units) {
    if (u.dimension == dimension && u.name == unit) return u.factor;
  }
  return std::nullopt;
}

std::string known_units(Dimension dimension) {
  std::string known;
  for (const Unit& u : units) {
    if (u.dimension != dimension) continue;
    if (!known.empty()) known += ", ";
    known += u.name;
  }
  return known;
}

bool is_mesh_unit(std::string_view unit) {
  return si_factor(Dimension::length, unit) || std::ranges::find(mesh_units, unit, &Unit::name) != mesh_units.end();
}

double length_unit_factor(std::string_view unit) {
  if (const auto factor = si_factor(Dimension::length, unit)) return *factor;
  const auto found = std::ranges::find(mesh_units, unit, &Unit::name);
  if (found != mesh_units.end()) return found->factor;
  throw UsageError(
      fmt::format("unknown length unit '{}': use one of {}, in, ft", unit, known_units(Dimension::length)));
}

double parse_length_m(std::string_view text, std::string_view what) {
  double value = 0.0;
  const char* const end = text.data() + text.size();
  const auto [rest, status] = std::from_chars(text.data(), end, value);
  std::string_view unit(rest, static_cast<std::size_t>(end - rest));
  while (!unit.empty() && unit.front() == ' ') unit.remove_prefix(1);
  const auto factor = si_factor(Dimension::length, unit);
  if (status != std::errc{} || !std::isfinite(value) || !factor) {
    throw UsageError(
        fmt::format("{}: '{}' is not a length: write a number and its unit, for instance 3.15mm (units: {})", what,
                    text, known_units(Dimension::length)));
  }
  return value * *factor;
}

}  // namespace touchstone
