#include "guess_map.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>

#include "foreign_unit.h"
#include "guess_clock.h"
#include "guess_curves.h"
#include "guess_evidence.h"
#include "guess_names.h"
#include "guess_proposal.h"
#include "import_table.h"

namespace touchstone::importing {
namespace {

class Guesser {
 public:
  explicit Guesser(const std::filesystem::path& path) : map_(read_foreign(path, {})) {}

  GuessedMap guess() {
    map_.json["schema"] = "touchstone-import/1";
    map_.json["about"] = fmt::format("proposed for {}; read every line before use", map_.tables.front().source);
    if (const auto curves = guess_curves(map_.tables.front())) return of_curves(*curves);
    const AxisChoice position = components(Quantity::position, {"x_m", "y_m", "z_m"}, "");
    components(Quantity::force, {"fx_N", "fy_N", "fz_N"}, position.frame);
    components(Quantity::torque, {"tx_Nm", "ty_Nm", "tz_Nm"}, position.frame);
    joint_by_names();
    const bool clock_is_open = clock_by_names(map_);
    if (const auto wrench = guess_wrench(map_.tables.front()); wrench && map_.columns.empty()) use_wrench(*wrench);
    quaternion_by_names(position.frame);
    rotation_by_names();
    if (map_.decide.empty() || !map_.decide.back().starts_with("quaternion")) {
      quaternion_by_numbers(map_.tables.front());
    }
    if (!map_.columns.contains("t_s")) rate_by_numbers(map_.tables.front());
    if (!map_.columns.contains("t_s") && clock_is_open) clock_by_numbers(map_, map_.tables.front());
    map_.json["columns"] = map_.columns;
    return finished();
  }

 private:
  GuessedMap finished() {
    GuessedMap out;
    for (std::size_t t = 0; t < map_.tables.size(); ++t) {
      for (std::size_t c = 0; c < map_.tables[t].names.size(); ++c) {
        const std::string name = map_.reference(map_.tables[t], c);
        if (std::ranges::find(map_.used, name) == map_.used.end()) {
          out.unused.push_back(fmt::format("{}: not used: {}", map_.shown(name), why_not_used(t, c)));
        }
      }
    }
    const bool one_axis = map_.columns.contains("q_rad") && map_.columns.contains("torque_Nm");
    const bool static_poses = map_.columns.contains("fx_N") && !map_.columns.contains("t_s") &&
                              (map_.json.contains("quaternion") || map_.json.contains("rotation_rows"));
    if (static_poses && moves_on(map_)) {
      map_.ask(
          "t_s",
          "no column is a clock and no rate is stated, and the rows follow one another as a motion does: put their "
          "rate, "
          "as {\"row_rate_Hz\": ...}; static poses would jump");
    } else if (static_poses) {
      out.static_poses = true;
      map_.reasons.emplace_back(
          "t_s: no column is a clock and no rate is stated: without one the rows are static poses");
    }
    ask_for_axes_that_lack();
    for (const char* const group : {"t_s", "x_", "y_", "z_", "fx_", "fy_", "fz_"}) {
      if (one_axis || static_poses) break;
      const bool there =
          std::ranges::any_of(map_.columns.items(), [&](const auto& item) { return item.key().starts_with(group); });
      if (!there) out.missing.emplace_back(group);
    }
    out.json = map_.json.dump(1, ' ', false, Json::error_handler_t::replace);
    out.reasons = std::move(map_.reasons);
    out.decide = std::move(map_.decide);
    out.from = std::move(map_.from);
    out.unit_assumed = std::move(map_.unit_assumed);
    out.sign_assumed = std::move(map_.sign_assumed);
    return out;
  }

  // A recording in which the probe is on a plane or a line says so itself.
  void ask_for_axes_that_lack() {
    if (!map_.columns.contains("x_m") || !map_.columns.contains("fx_N")) return;
    for (const char* const column : {"y_m", "z_m", "fy_N", "fz_N"}) {
      const bool asked = std::ranges::any_of(map_.decide, [&](const auto& d) { return d.find(column) < d.find(": "); });
      if (map_.columns.contains(column) || asked) continue;
      map_.ask(
          column,
          "nothing was found for it, and a recording has all three axes: put {\"constant\": 0} if it was not measured");
    }
  }

  static GuessedMap of_curves(const GuessedCurves& curves) {
    GuessedMap out;
    out.json = curves.json.dump(1, ' ', false, Json::error_handler_t::replace);
    out.reasons = curves.reasons;
    out.decide = curves.decide;
    return out;
  }

  void use_wrench(const GuessedWrench& wrench) {
    for (const auto& [name, reason] : wrench.columns)
      map_.use(name, {{"from", reason.first}}, reason.first, reason.second);
    map_.decide.emplace_back(
        "columns: the file names nothing; that the first three are a force in N and the others a torque in N m is "
        "assumed from their size");
    if (wrench.pose_file.empty()) return;
    map_.json["files"] = {{"pose", {{"file", wrench.pose_file}}}};
    for (const char* const axis : {"x", "y", "z"}) {
      map_.columns[fmt::format("{}_m", axis)] = {{"from", fmt::format("pose:{}", axis[0] - 'x' + 1)}};
    }
    map_.json["quaternion"] = {{"from", {"pose:4", "pose:5", "pose:6", "pose:7"}}, {"order", "xyzw"}};
    map_.reasons.push_back(fmt::format(
        "x_m, y_m, z_m, quaternion <- {}: it lies beside this file, has as many rows, and the squares of its columns 4 "
        "to 7 add to 1; metres and order x, y, z, w assumed: check them, and the wrench's frame, with `acquire tool`",
        wrench.pose_file));
    map_.decide.push_back(
        fmt::format("quaternion: its order x, y, z, w and the metres of {} are assumed", wrench.pose_file));
  }

  [[nodiscard]] std::string why_not_used(std::size_t t, std::size_t c) const {
    if (map_.tables[t].is_text(c)) return "it holds text";
    if (names_angle_of_orientation(map_.tables[t].names[c])) {
      return "of three angles, which are an orientation once \"euler\" in the map states their order and unit";
    }
    const auto named =
        std::ranges::find_if(map_.named, [&](const NamedColumn& n) { return n.table == t && n.column == c; });
    return named == map_.named.end() ? "nothing tells what it is" : why_unused(named->name);
  }

  // The factor of a column to SI and why; nothing, and a question, where the file does not settle it.
  std::optional<double> factor_of(const std::string& column, const NamedColumn& named, Quantity quantity,
                                  std::string& reason) {
    const std::string said = said_of(map_.tables, named.table, named.column);
    if (!named.name.doubt.empty()) {
      map_.ask(column, fmt::format("{}: {}", said, named.name.doubt));
      return std::nullopt;
    }
    const std::string& stated = map_.head.unit_of(quantity);
    const auto of_head = stated.empty() ? std::nullopt : foreign_unit_factor(stated, si_unit(quantity));
    if (!stated.empty() && !of_head) {
      map_.ask(column,
               fmt::format("{}: the lines above the table give its unit as '{}', which is not known", said, stated));
      return std::nullopt;
    }
    double factor = 1.0;
    if (named.name.factor) {
      factor = *named.name.factor;
      reason = fmt::format("by its name, in {}", named.name.unit);
      if (of_head && std::abs(*of_head - factor) > 1e-9 * factor) {
        map_.ask(column, fmt::format("{} is in {} by its name, but the lines above the table say {}", said,
                                     named.name.unit, stated));
        return std::nullopt;
      }
    } else if (of_head) {
      factor = *of_head;
      reason = fmt::format("by its name; in {}, as the lines above the table say", stated);
    } else if (const std::string convention = si_by_convention(map_.tables[named.table]); !convention.empty()) {
      reason = fmt::format("by its name; in {}, as {}", si_unit(quantity), convention);
    } else {
      reason = fmt::format("by its name; the file names no unit: {} is assumed", si_unit(quantity));
      map_.unit_assumed.insert(column);
    }
    if (const auto counts = map_.head.counts_of(quantity); counts && *counts > 0.0) {
      factor /= *counts;
      reason += fmt::format("; {} counts of it by the lines above the table", *counts);
    }
    return factor;
  }

  // Where the names of a set have no unit, SI is assumed, but not where another of the set has one, nor of a machine
  // that names no axis: those write mm, kN and gf.
  std::string why_no_unit_is_assumed(const AxisChoice& choice, Quantity quantity) const {
    const NamedColumn *with = nullptr, *without = nullptr;
    for (const auto& [axis, named] : choice.axes) {
      const bool unit = named.name.factor || !named.name.doubt.empty() || !map_.head.unit_of(quantity).empty();
      (unit ? with : without) = &named;
    }
    const auto said = [&](const NamedColumn* named) { return said_of(map_.tables, named->table, named->column); };
    if (without != nullptr && choice.axes.contains('0') && quantity != Quantity::torque &&
        si_by_convention(map_.tables[without->table]).empty()) {
      return fmt::format("{} names neither unit nor axis: put the scale to {}", said(without), si_unit(quantity));
    }
    if (with == nullptr || without == nullptr) return {};
    return fmt::format("{} names a unit and {} none: put the scales", said(with), said(without));
  }

  // x, y, z of a quantity, or z of one that names no axis.
  AxisChoice components(Quantity quantity, const std::vector<std::string>& columns, const std::string& near) {
    AxisChoice choice = choose_axes(map_.named, map_.tables, quantity, near);
    const std::string all = fmt::format("{}, {}, {}", columns[0], columns[1], columns[2]);
    if (!choice.doubt.empty()) map_.ask(all, choice.doubt);
    if (const std::string why = why_no_unit_is_assumed(choice, quantity); !why.empty()) {
      map_.ask(all, why);
      return choice;
    }
    for (const auto& [axis, named] : choice.axes) {
      if (axis == '0' && quantity == Quantity::torque) continue;  // of a joint
      const std::string& column = axis == '0' ? columns[2] : columns[static_cast<std::size_t>(axis - 'x')];
      std::string reason;
      const auto factor = factor_of(column, named, quantity, reason);
      if (!factor) continue;
      Json how{{"from", map_.reference(map_.tables[named.table], named.column)}};
      if (*factor != 1.0) how["scale"] = *factor;
      if (choice.among > 1) {
        reason += fmt::format("; of {} that it may be, that of '{}', as the probe's own are named", choice.among,
                              choice.frame);
      }
      if (axis == '0') {
        reason += "; it names no axis: z, which points out of the object, is assumed";
        map_.sign_assumed.insert(column);
      }
      map_.use(column, std::move(how), map_.reference(map_.tables[named.table], named.column), reason);
    }
    // Names that stay open between two quantities are asked about once.
    for (const NamedColumn& named : map_.named) {
      const bool first = !named.name.quantities.empty() && named.name.quantities.front() == quantity;
      if (named.name.quantities.size() < 2 || !first) continue;
      if (quantity == Quantity::position && choice.axes.contains('x')) continue;
      map_.ask(all, fmt::format("{}: {}", said_of(map_.tables, named.table, named.column), named.name.doubt));
    }
    return choice;
  }

  void joint_by_names() {
    const bool cartesian = map_.columns.contains("x_m") || map_.columns.contains("fx_N");
    const AxisChoice angle = choose_axes(map_.named, map_.tables, Quantity::angle),
                     torque = choose_axes(map_.named, map_.tables, Quantity::torque);
    if (cartesian || !angle.axes.contains('0') || !angle.doubt.empty()) return;
    for (const auto& [quantity, choice, column] :
         {std::tuple{Quantity::angle, &angle, "q_rad"}, {Quantity::torque, &torque, "torque_Nm"}}) {
      const auto found = choice->axes.find('0');
      if (found == choice->axes.end()) continue;
      std::string reason;
      const auto factor = factor_of(column, found->second, quantity, reason);
      if (!factor) continue;
      const std::string from = map_.reference(map_.tables[found->second.table], found->second.column);
      Json how{{"from", from}};
      if (*factor != 1.0) how["scale"] = *factor;
      map_.use(column, std::move(how), from, reason);
    }
    const ImportTable& table = map_.tables[angle.axes.at('0').table];
    for (std::size_t c = 0; c < table.names.size(); ++c) {
      const std::string& name = table.names[c];
      if (name != "qd" && name != "velocity" && name != "joint_velocity") continue;
      map_.use("qd_rad_per_s", {{"from", map_.reference(table, c)}}, map_.reference(table, c),
               "by its name; rad/s is assumed, check it");
      return;
    }
  }

  void quaternion_by_names(const std::string& near) {
    const AxisChoice choice = choose_axes(map_.named, map_.tables, Quantity::quaternion, near);
    if (!choice.doubt.empty()) map_.ask("quaternion", choice.doubt);
    if (choice.axes.size() != 4) return;
    const ImportTable& table = map_.tables[choice.axes.at('w').table];
    std::vector<std::size_t> parts;
    Json from = Json::array();
    for (const char axis : std::string_view("wxyz")) {
      parts.push_back(choice.axes.at(axis).column);
      from.push_back(map_.reference(table, parts.back()));
      map_.from[fmt::format("q{}", axis)] = from.back();
    }
    bool varies = false;
    if (!have_norm_one(table, parts, varies)) {
      map_.ask("quaternion",
               fmt::format("the squares of {} and the three named with it do not add to 1", from[0].dump()));
      return;
    }
    for (const auto& name : from) map_.used.push_back(name.get<std::string>());
    map_.json["quaternion"] = {{"from", from}, {"order", "wxyz"}};
    map_.reasons.push_back(fmt::format("quaternion <- {}: by their names; the sum of their squares is 1", from.dump()));
  }

  // Whether the name of a column of the first table says that it is no part of a quaternion.
  [[nodiscard]] bool named_otherwise(std::size_t c) const {
    return std::ranges::any_of(map_.named, [&](const NamedColumn& n) {
      return n.table == 0 && n.column == c && !n.name.quantities.empty() && !n.name.may_be(Quantity::quaternion);
    });
  }

  void quaternion_by_numbers(const ImportTable& table) {
    if (map_.json.contains("quaternion") || map_.json.contains("rotation_rows")) return;
    for (std::size_t c = 0; c + 4 <= table.names.size(); ++c) {
      const std::vector<std::size_t> parts{c, c + 1, c + 2, c + 3};
      const bool used = std::ranges::any_of(parts, [&](std::size_t p) {
        return std::ranges::find(map_.used, map_.reference(table, p)) != map_.used.end() || named_otherwise(p);
      });
      bool varies = false;
      if (used || !have_norm_one(table, parts, varies) || !varies) continue;
      Json from = Json::array();
      for (const std::size_t p : parts) {
        from.push_back(map_.reference(table, p));
        map_.used.push_back(map_.reference(table, p));
      }
      map_.json["quaternion"] = {{"from", from}, {"order", "xyzw"}};
      map_.reasons.push_back(
          fmt::format("quaternion <- {} and the three after it: the sum of their squares is 1; order x, y, z, w "
                      "assumed, as ROS and "
                      "most robots write it: check it with `acquire tool`",
                      map_.reference(table, c)));
      map_.decide.push_back(
          fmt::format("quaternion: the order of {} and the three after it is not in the file: xyzw or wxyz?",
                      map_.reference(table, c)));
      return;
    }
  }

  void rotation_by_names() {
    for (const ImportTable& table : map_.tables) {
      const auto columns = rotation_columns(table);
      if (columns.empty()) continue;
      map_.json["rotation_rows"] = Json::array();
      for (const std::size_t c : columns) {
        map_.json["rotation_rows"].push_back(map_.reference(table, c));
        map_.used.push_back(map_.reference(table, c));
      }
      map_.reasons.emplace_back("orientation <- r11 ... r33: by their names, row by row");
      return;
    }
  }

  // An angle beside its rate, and a torque, in a table that names nothing.
  void rate_by_numbers(const ImportTable& table) {
    // Of many columns two that look like an angle and its rate are found by chance.
    constexpr std::size_t most_columns = 4;
    const bool few = table.names_from_file ? map_.columns.contains("q_rad") : table.names.size() <= most_columns;
    const auto joint = few ? guess_joint(table) : std::nullopt;
    if (!joint) return;
    map_.columns["t_s"] = {{"row_rate_Hz", joint->rate_Hz}};
    map_.decide.push_back(fmt::format("t_s: no clock: {} Hz is assumed from the ratio of two columns", joint->rate_Hz));
    map_.reasons.push_back(
        fmt::format("t_s <- row numbers at {} Hz: {} is the rate of {} at about that many rows a second, check it",
                    joint->rate_Hz, table.names[joint->rate], table.names[joint->angle]));
    if (table.names_from_file) return;
    map_.decide.emplace_back("q_rad, qd_rad_per_s, torque_Nm: assumed from the numbers; the file names nothing");
    const auto use_as = [&](const char* column, std::size_t c, const std::string& reason) {
      map_.use(column, {{"from", map_.reference(table, c)}}, map_.reference(table, c), reason);
    };
    use_as("q_rad", joint->angle, "its rate stands beside it; radians assumed");
    use_as("qd_rad_per_s", joint->rate, "it is the rate of " + table.names[joint->angle]);
    for (std::size_t c = 0; c < table.names.size() && table.names.size() == 3; ++c) {
      if (c == joint->angle || c == joint->rate) continue;
      use_as("torque_Nm", c, "the one column that is left beside an angle and its rate; N m assumed");
    }
  }

  MapProposal map_;
};

}  // namespace

GuessedMap guess_map(const std::filesystem::path& path) {
  GuessedMap guess = Guesser(path).guess();
  hold_against_numbers(path, guess);
  return guess;
}

}  // namespace touchstone::importing
