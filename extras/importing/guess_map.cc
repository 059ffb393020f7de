#include "guess_map.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>

#include "clock_reading.h"
#include "foreign_unit.h"
#include "guess_curves.h"
#include "guess_evidence.h"
#include "guess_names.h"
#include "head_facts.h"
#include "import_table.h"

namespace touchstone::importing {
namespace {

using Json = nlohmann::ordered_json;

class Guesser {
 public:
  explicit Guesser(const std::filesystem::path& path)
      : tables_(read_foreign(path, {})), head_(head_facts(tables_.front().head)), named_(named_columns(tables_)) {}

  GuessedMap guess() {
    json_["schema"] = "touchstone-import/1";
    json_["about"] = fmt::format("proposed for {}; read every line before use", tables_.front().source);
    if (const auto curves = guess_curves(tables_.front())) return of_curves(*curves);
    const AxisChoice position = components(Quantity::position, {"x_m", "y_m", "z_m"}, "");
    components(Quantity::force, {"fx_N", "fy_N", "fz_N"}, position.frame);
    components(Quantity::torque, {"tx_Nm", "ty_Nm", "tz_Nm"}, position.frame);
    joint_by_names();
    clock_by_names();
    if (const auto wrench = guess_wrench(tables_.front()); wrench && columns_.empty()) use_wrench(*wrench);
    quaternion_by_names(position.frame);
    rotation_by_names();
    quaternion_by_numbers(tables_.front());
    if (!columns_.contains("t_s")) rate_by_numbers(tables_.front());
    if (!columns_.contains("t_s") && clock_is_open_) clock_by_numbers(tables_.front());
    json_["columns"] = columns_;
    return finished();
  }

 private:
  GuessedMap finished() {
    GuessedMap out;
    for (std::size_t t = 0; t < tables_.size(); ++t) {
      for (std::size_t c = 0; c < tables_[t].names.size(); ++c) {
        const std::string name = reference(tables_[t], c);
        if (std::ranges::find(used_, name) == used_.end()) {
          out.unused.push_back(fmt::format("{}: not used: {}", name, why_not_used(t, c)));
        }
      }
    }
    const bool one_axis = columns_.contains("q_rad") && columns_.contains("torque_Nm");
    const bool static_poses = columns_.contains("fx_N") && !columns_.contains("t_s") &&
                              (json_.contains("quaternion") || json_.contains("rotation_rows"));
    if (static_poses) {
      reasons_.emplace_back("t_s: no column is a clock and no rate is stated: without one the rows are static poses");
    }
    for (const char* const group : {"t_s", "x_", "y_", "z_", "fx_", "fy_", "fz_"}) {
      if (one_axis || static_poses) break;
      const bool there =
          std::ranges::any_of(columns_.items(), [&](const auto& item) { return item.key().starts_with(group); });
      if (!there) out.missing.emplace_back(group);
    }
    out.json = json_.dump(1, ' ', false, Json::error_handler_t::replace);
    out.reasons = std::move(reasons_);
    out.decide = std::move(decide_);
    out.unit_assumed = std::move(unit_assumed_);
    return out;
  }

  static GuessedMap of_curves(const GuessedCurves& curves) {
    GuessedMap out;
    out.json = curves.json.dump(1, ' ', false, Json::error_handler_t::replace);
    out.reasons = curves.reasons;
    out.decide = curves.decide;
    return out;
  }

  void use_wrench(const GuessedWrench& wrench) {
    for (const auto& [name, reason] : wrench.columns) use(name, {{"from", reason.first}}, reason.first, reason.second);
    decide_.emplace_back(
        "columns: the file names nothing; that the first three are a force in N and the others a torque in N m is "
        "assumed from their size");
    if (wrench.pose_file.empty()) return;
    json_["files"] = {{"pose", {{"file", wrench.pose_file}}}};
    for (const char* const axis : {"x", "y", "z"}) {
      columns_[fmt::format("{}_m", axis)] = {{"from", fmt::format("pose:{}", axis[0] - 'x' + 1)}};
    }
    json_["quaternion"] = {{"from", {"pose:4", "pose:5", "pose:6", "pose:7"}}, {"order", "xyzw"}};
    reasons_.push_back(fmt::format(
        "x_m, y_m, z_m, quaternion <- {}: it lies beside this file, has as many rows, and the squares of its columns 4 "
        "to 7 add to 1; metres and order x, y, z, w assumed: check them, and the wrench's frame, with `acquire tool`",
        wrench.pose_file));
    decide_.push_back(
        fmt::format("quaternion: its order x, y, z, w and the metres of {} are assumed", wrench.pose_file));
  }

  [[nodiscard]] std::string why_not_used(std::size_t t, std::size_t c) const {
    if (tables_[t].is_text(c)) return "it holds text";
    const auto named =
        std::ranges::find_if(named_, [&](const NamedColumn& n) { return n.table == t && n.column == c; });
    return named == named_.end() ? "nothing tells what it is" : why_unused(named->name);
  }

  [[nodiscard]] std::string reference(const ImportTable& table, std::size_t c) const {
    // JSON holds UTF-8 alone; a name in another encoding goes by its number, and so does one that is not the only one.
    const bool plain =
        as_utf8(table.names[c]) == table.names[c] && std::ranges::count(table.names, table.names[c]) == 1;
    const std::string name = plain ? table.names[c] : std::to_string(c + 1);
    return tables_.size() > 1 ? table.name + ":" + name : name;
  }

  void use(const std::string& column, Json how, const std::string& from, const std::string& reason) {
    columns_[column] = std::move(how);
    used_.push_back(from);
    reasons_.push_back(fmt::format("{} <- {}: {}", column, from, reason));
  }

  void ask(const std::string& what, const std::string& why) { decide_.push_back(fmt::format("{}: {}", what, why)); }

  // The factor of a column to SI and why; nothing, and a question, where the file does not settle it.
  std::optional<double> factor_of(const std::string& column, const NamedColumn& named, Quantity quantity,
                                  std::string& reason) {
    const std::string said = said_of(tables_, named.table, named.column);
    if (!named.name.doubt.empty()) {
      ask(column, fmt::format("{}: {}", said, named.name.doubt));
      return std::nullopt;
    }
    const std::string& stated = head_.unit_of(quantity);
    const auto of_head = stated.empty() ? std::nullopt : foreign_unit_factor(stated, si_unit(quantity));
    if (!stated.empty() && !of_head) {
      ask(column, fmt::format("{}: the lines above the table give its unit as '{}', which is not known", said, stated));
      return std::nullopt;
    }
    double factor = 1.0;
    if (named.name.factor) {
      factor = *named.name.factor;
      reason = fmt::format("by its name, in {}", named.name.unit);
      if (of_head && std::abs(*of_head - factor) > 1e-9 * factor) {
        ask(column, fmt::format("{} is in {} by its name, but the lines above the table say {}", said, named.name.unit,
                                stated));
        return std::nullopt;
      }
    } else if (of_head) {
      factor = *of_head;
      reason = fmt::format("by its name; in {}, as the lines above the table say", stated);
    } else if (const std::string convention = si_by_convention(tables_[named.table]); !convention.empty()) {
      reason = fmt::format("by its name; in {}, as {}", si_unit(quantity), convention);
    } else {
      reason = fmt::format("by its name; the file names no unit: {} is assumed", si_unit(quantity));
      unit_assumed_.insert(column);
    }
    if (const auto counts = head_.counts_of(quantity); counts && *counts > 0.0) {
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
      const bool unit = named.name.factor || !named.name.doubt.empty() || !head_.unit_of(quantity).empty();
      (unit ? with : without) = &named;
    }
    const auto said = [&](const NamedColumn* named) { return said_of(tables_, named->table, named->column); };
    if (without != nullptr && choice.axes.contains('0') && quantity != Quantity::torque &&
        si_by_convention(tables_[without->table]).empty()) {
      return fmt::format("{} names neither unit nor axis: put the scale to {}", said(without), si_unit(quantity));
    }
    if (with == nullptr || without == nullptr) return {};
    return fmt::format("{} names a unit and {} none: put the scales", said(with), said(without));
  }

  // x, y, z of a quantity, or z of one that names no axis.
  AxisChoice components(Quantity quantity, const std::vector<std::string>& columns, const std::string& near) {
    AxisChoice choice = choose_axes(named_, tables_, quantity, near);
    const std::string all = fmt::format("{}, {}, {}", columns[0], columns[1], columns[2]);
    if (!choice.doubt.empty()) ask(all, choice.doubt);
    if (const std::string why = why_no_unit_is_assumed(choice, quantity); !why.empty()) {
      ask(all, why);
      return choice;
    }
    for (const auto& [axis, named] : choice.axes) {
      if (axis == '0' && quantity == Quantity::torque) continue;  // of a joint
      const std::string& column = axis == '0' ? columns[2] : columns[static_cast<std::size_t>(axis - 'x')];
      std::string reason;
      const auto factor = factor_of(column, named, quantity, reason);
      if (!factor) continue;
      Json how{{"from", reference(tables_[named.table], named.column)}};
      if (*factor != 1.0) how["scale"] = *factor;
      if (choice.among > 1) {
        reason += fmt::format("; of {} that it may be, that of '{}', as the probe's own are named", choice.among,
                              choice.frame);
      }
      if (axis == '0') reason += "; it names no axis: z, which points out of the object, is assumed: check its sign";
      use(column, std::move(how), reference(tables_[named.table], named.column), reason);
    }
    // Names that stay open between two quantities are asked about once.
    for (const NamedColumn& named : named_) {
      const bool first = !named.name.quantities.empty() && named.name.quantities.front() == quantity;
      if (named.name.quantities.size() < 2 || !first) continue;
      if (quantity == Quantity::position && choice.axes.contains('x')) continue;
      ask(all, fmt::format("{}: {}", said_of(tables_, named.table, named.column), named.name.doubt));
    }
    return choice;
  }

  void joint_by_names() {
    const bool cartesian = columns_.contains("x_m") || columns_.contains("fx_N");
    const AxisChoice angle = choose_axes(named_, tables_, Quantity::angle),
                     torque = choose_axes(named_, tables_, Quantity::torque);
    if (cartesian || !angle.axes.contains('0') || !angle.doubt.empty()) return;
    for (const auto& [quantity, choice, column] :
         {std::tuple{Quantity::angle, &angle, "q_rad"}, {Quantity::torque, &torque, "torque_Nm"}}) {
      const auto found = choice->axes.find('0');
      if (found == choice->axes.end()) continue;
      std::string reason;
      const auto factor = factor_of(column, found->second, quantity, reason);
      if (!factor) continue;
      const std::string from = reference(tables_[found->second.table], found->second.column);
      Json how{{"from", from}};
      if (*factor != 1.0) how["scale"] = *factor;
      use(column, std::move(how), from, reason);
    }
    const ImportTable& table = tables_[angle.axes.at('0').table];
    for (std::size_t c = 0; c < table.names.size(); ++c) {
      const std::string& name = table.names[c];
      if (name != "qd" && name != "velocity" && name != "joint_velocity") continue;
      use("qd_rad_per_s", {{"from", reference(table, c)}}, reference(table, c),
          "by its name; rad/s is assumed, check it");
      return;
    }
  }

  struct Clock {
    const NamedColumn* named;
    ClockReading reading;
  };

  // Those of tables whose other columns are used; where none are, and there are several, their names.
  std::string keep_clocks_of_used_tables(std::vector<Clock>& clocks) const {
    if (tables_.size() < 2 || clocks.size() < 2) return {};
    const auto used = [&](std::size_t t) {
      return std::ranges::any_of(used_,
                                 [&](const std::string& name) { return name.starts_with(tables_[t].name + ":"); });
    };
    if (std::ranges::any_of(clocks, [&](const Clock& c) { return used(c.named->table); })) {
      std::erase_if(clocks, [&](const Clock& c) { return !used(c.named->table); });
      return {};
    }
    std::string names;
    for (const Clock& clock : clocks) names += (names.empty() ? "" : ", ") + tables_[clock.named->table].name;
    return names;
  }

  void clock_by_names() {
    std::vector<Clock> clocks;
    std::string doubts;
    for (const NamedColumn& named : named_) {
      if (!named.name.is(Quantity::time)) continue;
      const auto reading = named.name.doubt.empty()
                               ? read_clock(tables_[named.table].columns[named.column], named.name, head_)
                               : ClockReading{std::nullopt, named.name.doubt, false};
      if (reading.scale) clocks.push_back({&named, reading});
      if (!reading.scale && !reading.stands) {
        doubts += fmt::format("{}{}: {}", doubts.empty() ? "" : "; ", said_of(tables_, named.table, named.column),
                              reading.reason);
      }
    }
    if (use_stamp_of_two()) return;
    if (const std::string tables = keep_clocks_of_used_tables(clocks); !tables.empty()) {
      ask("t_s", "there are clocks in " + tables + ": which is the recording?");
      return;
    }
    // A message's own stamp is when it was measured; the other is when it was written.
    const auto stamp = std::ranges::find_if(
        clocks, [](const Clock& c) { return c.named->name.frame.find("header") != std::string::npos; });
    if (clocks.size() > 1 && stamp != clocks.end()) std::rotate(clocks.begin(), stamp, stamp + 1);
    if (clocks.empty()) {
      if (doubts.empty() && use_counted_rows()) return;
      clock_is_open_ = doubts.empty();
      if (!doubts.empty()) ask("t_s", doubts);
      return;
    }
    const auto duration = [&](const Clock& c) {
      const auto& v = tables_[c.named->table].columns[c.named->column];
      return (v.back() - v.front()) * *c.reading.scale;
    };
    const double first = duration(clocks.front());
    const bool same = std::ranges::all_of(clocks, [&](const Clock& c) {
      constexpr double apart = 0.01;
      return c.named->table != clocks.front().named->table || std::abs(duration(c) - first) <= apart * first;
    });
    if (!same) {
      std::string list;
      for (const Clock& c : clocks)
        list += (list.empty() ? "" : ", ") + said_of(tables_, c.named->table, c.named->column);
      ask("t_s", list + " are clocks of different lengths: which is that of the samples?");
      return;
    }
    const auto& [named, reading] = clocks.front();
    Json how{{"from", reference(tables_[named->table], named->column)}};
    if (*reading.scale != 1.0) how["scale"] = *reading.scale;
    use("t_s", std::move(how), reference(tables_[named->table], named->column), reading.reason);
  }

  // Seconds in one column, nanoseconds within them in another, as ROS 2 has its stamps.
  bool use_stamp_of_two() {
    const NamedColumn *whole = nullptr, *part = nullptr;
    for (const NamedColumn& named : named_) {
      if (!named.name.is(Quantity::time) || !named.name.factor) continue;
      const auto& values = tables_[named.table].columns[named.column];
      const bool below_a_second = std::ranges::all_of(values, [](double v) { return !(v >= 1e9) && !(v < 0.0); });
      const bool counts_seconds = std::ranges::all_of(values, [](double v) { return v == std::floor(v); });
      if (*named.name.factor == 1.0 && counts_seconds && whole == nullptr) whole = &named;
      if (*named.name.factor == 1e-9 && below_a_second && part == nullptr) part = &named;
    }
    const bool both = whole != nullptr && part != nullptr && whole->table == part->table;
    if (!both || whole->name.frame != part->name.frame) return false;
    const std::string s = reference(tables_[whole->table], whole->column),
                      ns = reference(tables_[part->table], part->column);
    used_.push_back(ns);
    const Json terms = Json::array({Json{{"from", s}}, Json{{"from", ns}, {"scale", 1e-9}}});
    use("t_s", {{"sum", terms}}, s, fmt::format("seconds, with the nanoseconds of {} added", ns));
    return true;
  }

  // A counter of rows is no clock unless the lines above the table state the rate.
  bool use_counted_rows() {
    if (!head_.rate_Hz) {
      for (const NamedColumn& named : named_) {
        if (!named.name.is(Quantity::count) || !counts_rows(tables_[named.table].columns[named.column])) continue;
        clock_is_open_ = false;
        ask("t_s", fmt::format("{} counts rows and no line states their rate: put it, as {{\"row_rate_Hz\": ...}}",
                               said_of(tables_, named.table, named.column)));
        return true;
      }
      return false;
    }
    columns_["t_s"] = {{"row_rate_Hz", *head_.rate_Hz}};
    reasons_.push_back(
        fmt::format("t_s <- row numbers at {} Hz: '{}' stands above the table", *head_.rate_Hz, head_.rate_line));
    for (const NamedColumn& named : named_) {
      const auto& values = tables_[named.table].columns[named.column];
      if (!named.name.is(Quantity::count) || values.size() < 2 || !(values.back() > values.front())) continue;
      if (!std::ranges::is_sorted(values)) continue;
      const std::string from = reference(tables_[named.table], named.column);
      use("t_s", {{"from", from}, {"scale", 1.0 / *head_.rate_Hz}}, from,
          fmt::format("it counts the samples, and '{}' stands above the table", head_.rate_line));
      break;
    }
    return true;
  }

  // Without a name a clock is sure only where its numbers are seconds since 1970.
  void clock_by_numbers(const ImportTable& table) {
    std::string rising;
    for (std::size_t c = 0; c < table.names.size(); ++c) {
      const auto& values = table.columns[c];
      const bool used = std::ranges::find(used_, reference(table, c)) != used_.end();
      const auto falls = [](double a, double b) { return !(b > a); };
      if (used || values.size() < 2 || std::ranges::adjacent_find(values, falls) != values.end()) continue;
      if (is_since_1970(values)) {
        const ClockReading reading = read_clock(values, {}, head_);
        if (!reading.scale) continue;
        Json how{{"from", reference(table, c)}};
        if (*reading.scale != 1.0) how["scale"] = *reading.scale;
        use("t_s", std::move(how), reference(table, c), reading.reason);
        return;
      }
      rising += (rising.empty() ? "" : ", ") + reference(table, c);
    }
    if (rising.empty()) return;
    ask("t_s", fmt::format("no name says which column is the clock; the numbers of {} only increase: put it, and its "
                           "scale to seconds",
                           rising));
  }

  void quaternion_by_names(const std::string& near) {
    const AxisChoice choice = choose_axes(named_, tables_, Quantity::quaternion, near);
    if (!choice.doubt.empty()) ask("quaternion", choice.doubt);
    if (choice.axes.size() != 4) return;
    const ImportTable& table = tables_[choice.axes.at('w').table];
    std::vector<std::size_t> parts;
    Json from = Json::array();
    for (const char axis : std::string_view("wxyz")) {
      parts.push_back(choice.axes.at(axis).column);
      from.push_back(reference(table, parts.back()));
    }
    bool varies = false;
    if (!have_norm_one(table, parts, varies)) {
      ask("quaternion", fmt::format("the squares of {} and the three named with it do not add to 1", from[0].dump()));
      return;
    }
    for (const auto& name : from) used_.push_back(name.get<std::string>());
    json_["quaternion"] = {{"from", from}, {"order", "wxyz"}};
    reasons_.push_back(fmt::format("quaternion <- {}: by their names; the sum of their squares is 1", from.dump()));
  }

  // Whether the name of a column of the first table says that it is no part of a quaternion.
  [[nodiscard]] bool named_otherwise(std::size_t c) const {
    return std::ranges::any_of(named_, [&](const NamedColumn& n) {
      return n.table == 0 && n.column == c && !n.name.quantities.empty() && !n.name.may_be(Quantity::quaternion);
    });
  }

  void quaternion_by_numbers(const ImportTable& table) {
    if (json_.contains("quaternion") || json_.contains("rotation_rows")) return;
    for (std::size_t c = 0; c + 4 <= table.names.size(); ++c) {
      const std::vector<std::size_t> parts{c, c + 1, c + 2, c + 3};
      const bool used = std::ranges::any_of(parts, [&](std::size_t p) {
        return std::ranges::find(used_, reference(table, p)) != used_.end() || named_otherwise(p);
      });
      bool varies = false;
      if (used || !have_norm_one(table, parts, varies) || !varies) continue;
      Json from = Json::array();
      for (const std::size_t p : parts) {
        from.push_back(reference(table, p));
        used_.push_back(reference(table, p));
      }
      json_["quaternion"] = {{"from", from}, {"order", "xyzw"}};
      reasons_.push_back(
          fmt::format("quaternion <- {} and the three after it: the sum of their squares is 1; order x, y, z, w "
                      "assumed, as ROS and "
                      "most robots write it: check it with `acquire tool`",
                      reference(table, c)));
      decide_.push_back(fmt::format(
          "quaternion: the order of {} and the three after it is not in the file: xyzw or wxyz?", reference(table, c)));
      return;
    }
  }

  void rotation_by_names() {
    for (const ImportTable& table : tables_) {
      const auto columns = rotation_columns(table);
      if (columns.empty()) continue;
      json_["rotation_rows"] = Json::array();
      for (const std::size_t c : columns) {
        json_["rotation_rows"].push_back(reference(table, c));
        used_.push_back(reference(table, c));
      }
      reasons_.emplace_back("orientation <- r11 ... r33: by their names, row by row");
      return;
    }
  }

  // An angle beside its rate, and a torque, in a table that names nothing.
  void rate_by_numbers(const ImportTable& table) {
    // Of many columns two that look like an angle and its rate are found by chance.
    constexpr std::size_t most_columns = 4;
    const bool few = table.names_from_file ? columns_.contains("q_rad") : table.names.size() <= most_columns;
    const auto joint = few ? guess_joint(table) : std::nullopt;
    if (!joint) return;
    columns_["t_s"] = {{"row_rate_Hz", joint->rate_Hz}};
    decide_.push_back(fmt::format("t_s: no clock: {} Hz is assumed from the ratio of two columns", joint->rate_Hz));
    reasons_.push_back(
        fmt::format("t_s <- row numbers at {} Hz: {} is the rate of {} at about that many rows a second, check it",
                    joint->rate_Hz, table.names[joint->rate], table.names[joint->angle]));
    if (table.names_from_file) return;
    decide_.emplace_back("q_rad, qd_rad_per_s, torque_Nm: assumed from the numbers; the file names nothing");
    const auto use_as = [&](const char* column, std::size_t c, const std::string& reason) {
      use(column, {{"from", reference(table, c)}}, reference(table, c), reason);
    };
    use_as("q_rad", joint->angle, "its rate stands beside it; radians assumed");
    use_as("qd_rad_per_s", joint->rate, "it is the rate of " + table.names[joint->angle]);
    for (std::size_t c = 0; c < table.names.size() && table.names.size() == 3; ++c) {
      if (c == joint->angle || c == joint->rate) continue;
      use_as("torque_Nm", c, "the one column that is left beside an angle and its rate; N m assumed");
    }
  }

  std::vector<ImportTable> tables_;
  HeadFacts head_;
  std::vector<NamedColumn> named_;
  Json json_, columns_ = Json::object();
  std::vector<std::string> reasons_, used_, decide_;
  std::set<std::string> unit_assumed_;
  bool clock_is_open_ = false;  // no name tells of a clock: the numbers are looked at
};

}  // namespace

GuessedMap guess_map(const std::filesystem::path& path) {
  GuessedMap guess = Guesser(path).guess();
  hold_against_numbers(path, guess);
  return guess;
}

}  // namespace touchstone::importing
