#include "harness/recording/column.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>

#include "harness/base/error.h"

namespace touchstone::recording {
namespace {

// The step time's only unit: it never enters a computation, so it is not converted.
constexpr std::string_view cost_unit = "us";

std::string lower(std::string_view text) {
  std::string result(text);
  std::ranges::transform(result, result.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return result;
}

const QuantityInfo* find_quantity(std::string_view name) {
  for (const QuantityInfo& info : quantities()) {
    if (info.name == name) return &info;
  }
  return nullptr;
}

std::string units_of(const QuantityInfo& info) {
  return info.quantity == Quantity::cost ? std::string(cost_unit) : known_units(info.dimension);
}

std::optional<double> factor_of(const QuantityInfo& info, std::string_view unit) {
  if (info.quantity == Quantity::cost) return unit == cost_unit ? std::optional(1.0) : std::nullopt;
  return si_factor(info.dimension, unit);
}

std::string default_unit(const QuantityInfo& info) {
  const std::string units = units_of(info);
  return units.substr(0, units.find(','));
}

std::string known_columns() {
  std::string text;
  for (std::size_t g = 0; g < group_count; ++g) {
    if (g > 0) text += "; ";
    text += describe_group(static_cast<ColumnGroup>(g));
  }
  return text;
}

// "X_mm" or "Time" are near misses that a message can name.
std::string hint(std::string_view name) {
  const std::string small = lower(name);
  for (const QuantityInfo& info : quantities()) {
    const bool bare = info.dimension == Dimension::none && info.quantity != Quantity::cost;
    const std::string full = bare ? std::string(info.name) : fmt::format("{}_{}", info.name, default_unit(info));
    if (small == lower(full) || small == info.name) return fmt::format(" (did you mean {}?)", full);
  }
  for (const char* const of_one_axis : {"q_rad", "q_m", "torque_nm", "force_n"}) {
    if (small == of_one_axis) return " (of a recording of one axis, which `touchstone axis` takes)";
  }
  if (small.starts_with("time")) return " (did you mean t_s?)";
  return "";
}

Column parse_column(const std::string& name, const std::string& where) {
  const auto underscore = name.rfind('_');
  const std::string_view all = name;
  const std::string_view quantity = all.substr(0, underscore);
  const std::string_view unit = underscore == std::string::npos ? std::string_view{} : all.substr(underscore + 1);
  const QuantityInfo* const info = find_quantity(quantity);
  if (name.empty()) throw BadData(fmt::format("{}: the column has no name; known columns: {}", where, known_columns()));
  if (info == nullptr) {
    throw BadData(
        fmt::format("{}: unknown column '{}'{}; known columns: {}", where, name, hint(name), known_columns()));
  }
  if (info->dimension == Dimension::none && info->quantity != Quantity::cost) {
    if (underscore == std::string::npos) return {info->quantity, name, "1", UnitScale()};
    throw BadData(fmt::format("{}: column '{}': {} carries no unit; name it {}", where, name, info->name, info->name));
  }
  if (unit.empty()) {
    throw BadData(fmt::format("{}: column '{}' has no unit; name it {}_{} or with another of: {}", where, name,
                              info->name, default_unit(*info), units_of(*info)));
  }
  const auto factor = factor_of(*info, unit);
  if (!factor) {
    throw BadData(fmt::format("{}: column '{}' has the unknown unit '{}'; units known for {}: {}", where, name, unit,
                              info->name, units_of(*info)));
  }
  return {info->quantity, name, std::string(unit), UnitScale(*factor)};
}

}  // namespace

const std::array<QuantityInfo, quantity_count>& quantities() {
  using enum Quantity;
  using G = ColumnGroup;
  static constexpr std::array<QuantityInfo, quantity_count> table{{
      {t, "t", G::time, Dimension::time},
      {x, "x", G::position, Dimension::length},
      {y, "y", G::position, Dimension::length},
      {z, "z", G::position, Dimension::length},
      {qw, "qw", G::orientation, Dimension::none},
      {qx, "qx", G::orientation, Dimension::none},
      {qy, "qy", G::orientation, Dimension::none},
      {qz, "qz", G::orientation, Dimension::none},
      {fx, "fx", G::force, Dimension::force},
      {fy, "fy", G::force, Dimension::force},
      {fz, "fz", G::force, Dimension::force},
      {tx, "tx", G::torque, Dimension::torque},
      {ty, "ty", G::torque, Dimension::torque},
      {tz, "tz", G::torque, Dimension::torque},
      {px, "px", G::contact_point, Dimension::length},
      {py, "py", G::contact_point, Dimension::length},
      {pz, "pz", G::contact_point, Dimension::length},
      {contact, "contact", G::contact, Dimension::none},
      {cost, "cost", G::cost, Dimension::none},
  }};
  return table;
}

UnitScale::UnitScale(double factor_to_si)
    : number_(factor_to_si < 1.0 ? 1.0 / factor_to_si : factor_to_si), divides_(factor_to_si < 1.0) {}

ColumnSet ColumnSet::parse(const std::vector<std::string>& names,
                           const std::function<std::string(std::size_t)>& place) {
  ColumnSet set;
  for (std::size_t i = 0; i < names.size(); ++i) {
    Column column = parse_column(names[i], place(i));
    if (const auto first = set.find(column.quantity)) {
      throw BadData(fmt::format("{}: column '{}' gives the same quantity as column {} ('{}'); remove one of them",
                                place(i), names[i], *first + 1, names[*first]));
    }
    set.columns_.push_back(std::move(column));
  }
  for (std::size_t g = 0; g < group_count; ++g) {
    const auto group = static_cast<ColumnGroup>(g);
    const Column* first = nullptr;
    std::string missing;
    for (const QuantityInfo& info : quantities()) {
      if (info.group != group) continue;
      const auto at = set.find(info.quantity);
      if (!at) {
        missing += missing.empty() ? "" : ", ";
        missing += info.name;
        continue;
      }
      const Column& column = set.columns_[*at];
      if (first == nullptr) first = &column;
      if (column.unit != first->unit) {
        throw BadData(fmt::format("{}: columns '{}' and '{}' belong together but have different units; give both in {}",
                                  place(*at), first->name, column.name, first->unit));
      }
    }
    if (first != nullptr && !missing.empty()) {
      throw BadData(fmt::format(
          "{}: column '{}' is there but {} missing; a file has all of {} or none", place(*set.find(first->quantity)),
          first->name, missing + (missing.find(',') == std::string::npos ? " is" : " are"), group_members(group)));
    }
  }
  return set;
}

bool ColumnSet::has(ColumnGroup group) const noexcept {
  return std::ranges::any_of(columns_, [&](const Column& column) {
    return quantities()[static_cast<std::size_t>(column.quantity)].group == group;
  });
}

std::optional<std::size_t> ColumnSet::find(Quantity quantity) const noexcept {
  const auto at = std::ranges::find(columns_, quantity, &Column::quantity);
  if (at == columns_.end()) return std::nullopt;
  return static_cast<std::size_t>(at - columns_.begin());
}

std::vector<Column> make_columns(const std::vector<ColumnGroup>& groups, const ColumnUnits& units) {
  std::vector<Column> columns;
  for (const QuantityInfo& info : quantities()) {
    if (std::ranges::find(groups, info.group) == groups.end()) continue;
    std::string_view unit;
    switch (info.dimension) {
      case Dimension::time:
        unit = units.time;
        break;
      case Dimension::length:
        unit = units.length;
        break;
      case Dimension::force:
        unit = units.force;
        break;
      case Dimension::torque:
        unit = units.torque;
        break;
      case Dimension::none:
        if (info.quantity == Quantity::cost) unit = cost_unit;
        break;
    }
    if (unit.empty()) {
      columns.push_back({info.quantity, std::string(info.name), "1", UnitScale()});
      continue;
    }
    const auto factor = factor_of(info, unit);
    if (!factor) {
      throw UsageError(fmt::format("unknown unit '{}' for {}: use one of {}", unit, group_members(info.group),
                                   known_units(info.dimension)));
    }
    columns.push_back({info.quantity, fmt::format("{}_{}", info.name, unit), std::string(unit), UnitScale(*factor)});
  }
  return columns;
}

std::string group_members(ColumnGroup group) {
  std::string text;
  for (const QuantityInfo& info : quantities()) {
    if (info.group != group) continue;
    if (!text.empty()) text += ", ";
    text += info.name;
  }
  return text;
}

std::string describe_group(ColumnGroup group) {
  std::string text;
  std::string units;
  for (const QuantityInfo& info : quantities()) {
    if (info.group != group) continue;
    if (!text.empty()) text += ", ";
    text += info.name;
    units = units_of(info);
    if (!units.empty()) text += "_" + default_unit(info);
  }
  return units.find(',') == std::string::npos ? text : fmt::format("{} (units: {})", text, units);
}

}  // namespace touchstone::recording
