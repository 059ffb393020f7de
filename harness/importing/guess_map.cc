#include "harness/importing/guess_map.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>

#include "harness/base/units.h"
#include "harness/importing/guess_curves.h"
#include "harness/importing/import_table.h"

namespace touchstone::importing {
namespace {

using Json = nlohmann::ordered_json;

struct Named {
  std::string quantity, unit;  // lower case; the unit as written
};

// "Extend Force(nN)" -> extend force, nN; "fx_N" -> fx, N; "Time [ms]" -> time, ms; "force.x" -> force.x.
Named split_name(const std::string& name) {
  Named out;
  std::string quantity = name;
  const auto open = name.find_first_of("([{");
  if (open != std::string::npos) {
    const auto close = name.find_first_of(")]}", open);
    out.unit = name.substr(open + 1, close == std::string::npos ? std::string::npos : close - open - 1);
    quantity = name.substr(0, open);
  } else if (const auto under = name.rfind('_'); under != std::string::npos && under + 1 < name.size()) {
    out.unit = name.substr(under + 1);
    quantity = name.substr(0, under);
  }
  while (!quantity.empty() && quantity.back() == ' ') quantity.pop_back();
  std::ranges::transform(quantity, quantity.begin(),
                         [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  out.quantity = quantity;
  return out;
}

struct Meaning {
  const char* column;  // of the result, without its unit
  Dimension dimension;
  const char* si;
  std::vector<const char*> names;
};

const std::vector<Meaning>& meanings() {
  using enum Dimension;
  static const std::vector<Meaning> all{
      {"t", time, "s", {"t", "time", "timestamp", "stamp", "seconds", "series time", "x_value"}},
      {"x", length, "m", {"x", "px", "pos_x", "position.x", "position x", "tip_x"}},
      {"y", length, "m", {"y", "py", "pos_y", "position.y", "position y", "tip_y"}},
      {"z",
       length,
       "m",
       {"z", "pz", "pos_z", "position.z", "position z", "tip_z", "height", "verticaltipposition", "height (measured)",
        "displacement", "indentation"}},
      {"fx", force, "N", {"fx", "force.x", "force_x", "force x"}},
      {"fy", force, "N", {"fy", "force.y", "force_y", "force y"}},
      {"fz", force, "N", {"fz", "force.z", "force_z", "force z", "force", "vdeflection", "load"}},
      {"tx", torque, "Nm", {"tx", "torque.x", "mx", "torque_x"}},
      {"ty", torque, "Nm", {"ty", "torque.y", "my", "torque_y"}},
      {"tz", torque, "Nm", {"tz", "torque.z", "mz", "torque_z"}},
      {"q", none, "rad", {"q", "angle", "joint_angle", "position"}},
      {"qd", none, "rad_per_s", {"qd", "velocity", "joint_velocity"}},
      {"torque", none, "Nm", {"effort", "torque", "tau"}},
  };
  return all;
}

bool increases(const std::vector<double>& v) {
  return v.size() > 1 && std::ranges::adjacent_find(v, [](double a, double b) { return !(b > a); }) == v.end();
}

bool is_utf8(const std::string& text) {
  try {
    static_cast<void>(Json(text).dump());
    return true;
  } catch (const Json::type_error&) {
    return false;
  }
}

class Guesser {
 public:
  explicit Guesser(const std::filesystem::path& path) : tables_(read_foreign(path, {})) {}

  GuessedMap guess() {
    json_["schema"] = "touchstone-import/1";
    json_["about"] = fmt::format("proposed for {}; read every line before use", tables_.front().source);
    if (const auto curves = guess_curves(tables_.front())) return of_curves(*curves);
    for (const ImportTable& table : tables_) by_names(table);
    if (!columns_.contains("t_s")) time_by_numbers(tables_.front());
    if (const auto wrench = guess_wrench(tables_.front()); wrench && columns_.empty()) use_wrench(*wrench);
    quaternion_by_numbers(tables_.front());
    rotation_by_names();
    rate_by_numbers(tables_.front());
    json_["columns"] = columns_;
    GuessedMap out;
    for (const ImportTable& table : tables_) {
      for (std::size_t c = 0; c < table.names.size(); ++c) {
        const std::string name = reference(table, c);
        if (std::ranges::find(used_, name) == used_.end()) {
          reasons_.push_back(fmt::format("{}: not used: {}", name, why_not_used(table.names[c])));
        }
      }
    }
    const bool one_axis = columns_.contains("q_rad") && columns_.contains("torque_Nm");
    const bool static_poses = columns_.contains("fx_N") && !columns_.contains("t_s") &&
                              (json_.contains("quaternion") || json_.contains("rotation_rows"));
    for (const char* const group : {"t_s", "x_", "y_", "z_", "fx_", "fy_", "fz_"}) {
      if (one_axis || static_poses) break;
      const bool there =
          std::ranges::any_of(columns_.items(), [&](const auto& item) { return item.key().starts_with(group); });
      if (!there) out.missing.emplace_back(group);
    }
    out.json = json_.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
    out.reasons = std::move(reasons_);
    return out;
  }

 private:
  static GuessedMap of_curves(const GuessedCurves& curves) {
    return {curves.json.dump(1, ' ', false, Json::error_handler_t::replace) + "\n", curves.reasons, {}};
  }

  void use_wrench(const GuessedWrench& wrench) {
    for (const auto& [name, reason] : wrench.columns) use(name, {{"from", reason.first}}, reason.first, reason.second);
    if (wrench.pose_file.empty()) return;
    json_["files"] = {{"pose", {{"file", wrench.pose_file}}}};
    for (const char* const axis : {"x", "y", "z"}) {
      columns_[fmt::format("{}_m", axis)] = {{"from", fmt::format("pose:{}", axis[0] - 'x' + 1)}};
    }
    json_["quaternion"] = {{"from", {"pose:4", "pose:5", "pose:6", "pose:7"}}, {"order", "xyzw"}};
    reasons_.push_back(fmt::format(
        "x_m, y_m, z_m, quaternion <- {}: it lies beside this file, has as many rows, and the squares of its columns 4 "
        "to 7 "
        "add to 1; metres and order x, y, z, w assumed: check them, and the wrench's frame, with `acquire tool`",
        wrench.pose_file));
  }

  static std::string why_not_used(const std::string& name) {
    const std::string unit = split_name(name).unit;
    if (unit.starts_with("count"))
      return fmt::format("its unit is {}; the scale to rad or N m is not in the file", unit);
    return "nothing tells what it is";
  }

  [[nodiscard]] std::string reference(const ImportTable& table, std::size_t c) const {
    // JSON holds UTF-8 alone; a name in another encoding goes by its number.
    const std::string name = is_utf8(table.names[c]) ? table.names[c] : std::to_string(c + 1);
    return tables_.size() > 1 ? table.name + ":" + name : name;
  }

  void use(const std::string& column, Json how, const std::string& from, const std::string& reason) {
    columns_[column] = std::move(how);
    used_.push_back(from);
    reasons_.push_back(fmt::format("{} <- {}: {}", column, from, reason));
  }

  void by_names(const ImportTable& table) {
    if (!table.names_from_file) return;
    for (std::size_t c = 0; c < table.names.size(); ++c) {
      const Named named = split_name(table.names[c]);
      for (const Meaning& meaning : meanings()) {
        const std::string whole = split_name(table.names[c] + "_").quantity;
        const bool same =
            std::ranges::any_of(meaning.names, [&](const char* n) { return named.quantity == n || whole == n; });
        const std::string column = fmt::format("{}_{}", meaning.column, meaning.si);
        if (!same || columns_.contains(column)) continue;
        Json how{{"from", reference(table, c)}};
        std::string reason = "by its name";
        if (const auto factor = si_factor(meaning.dimension, named.unit)) {
          if (*factor != 1.0) how["scale"] = *factor;
          reason += fmt::format(", in {}", named.unit);
        } else if (named.unit == "nN" || named.unit == "nm") {
          how["scale"] = 1e-9;
          reason += fmt::format(", in {}", named.unit);
        } else if (std::string(meaning.column) == "t") {
          const double scale = time_scale(table.columns[c]);
          if (scale != 1.0) how["scale"] = scale;
          reason += fmt::format("; it steps as a clock in {} does", scale == 1.0 ? "s" : scale == 1e-3 ? "ms" : "us");
        } else {
          reason += fmt::format("; the file names no unit: {} is assumed, check it", meaning.si);
        }
        use(column, std::move(how), reference(table, c), reason);
        break;
      }
    }
  }

  // Steps of a sensible rate (1 Hz to 100 kHz) tell the unit.
  static double time_scale(const std::vector<double>& t) {
    if (t.size() < 2) return 1.0;
    const double step = (t.back() - t.front()) / static_cast<double>(t.size() - 1);
    for (const double scale : {1.0, 1e-3, 1e-6}) {
      if (step * scale >= 1e-5 && step * scale <= 1.0) return scale;
    }
    return 1.0;
  }

  void time_by_numbers(const ImportTable& table) {
    for (std::size_t c = 0; c < table.names.size(); ++c) {
      // A clock begins at zero or later, and its unit, if its name has one, is none of a length or force.
      const std::string unit = split_name(table.names[c]).unit;
      const bool other_unit = si_factor(Dimension::length, unit) || si_factor(Dimension::force, unit) || unit == "nm" ||
                              unit == "nN" || unit.starts_with("count");
      if (!increases(table.columns[c]) || table.columns[c].front() < 0.0) continue;
      if (table.names_from_file && other_unit) continue;
      Json how{{"from", reference(table, c)}};
      const double scale = time_scale(table.columns[c]);
      if (scale != 1.0) how["scale"] = scale;
      use("t_s", std::move(how), reference(table, c),
          fmt::format("its numbers only increase, in steps as of a clock in {}", scale == 1.0    ? "s"
                                                                                 : scale == 1e-3 ? "ms"
                                                                                                 : "us"));
      return;
    }
  }

  void quaternion_by_numbers(const ImportTable& table) {
    for (std::size_t c = 0; c + 4 <= table.names.size(); ++c) {
      bool unit = table.rows() > 2, varies = false;
      for (std::size_t i = 0; unit && i < table.rows(); ++i) {
        double square = 0.0;
        for (std::size_t k = 0; k < 4; ++k) {
          square += std::pow(table.columns[c + k][i], 2);
          varies = varies || table.columns[c + k][i] != table.columns[c + k][0];
        }
        unit = std::abs(square - 1.0) < 1e-3;
      }
      if (!unit || !varies) continue;
      const std::string first = split_name(table.names[c]).quantity;
      const bool scalar_first = first.ends_with("w");
      Json from = Json::array();
      for (std::size_t k = 0; k < 4; ++k) {
        from.push_back(reference(table, c + k));
        used_.push_back(reference(table, c + k));
      }
      json_["quaternion"] = {{"from", from}, {"order", scalar_first ? "wxyz" : "xyzw"}};
      reasons_.push_back(fmt::format(
          "quaternion <- {} and the three after it: the sum of their squares is 1; {}", reference(table, c),
          scalar_first ? "the first is named w"
                       : "order x, y, z, w assumed, as ROS and most robots write it: check it with `acquire tool`"));
      return;
    }
  }

  void rotation_by_names() {
    for (const ImportTable& table : tables_) {
      Json from = Json::array();
      for (int k = 0; k < 9; ++k) {
        const std::string wanted = fmt::format("r{}{}", k / 3 + 1, k % 3 + 1);
        const auto found = std::ranges::find(table.names, wanted);
        if (found == table.names.end()) break;
        from.push_back(reference(table, static_cast<std::size_t>(found - table.names.begin())));
      }
      if (from.size() != 9) continue;
      for (const auto& name : from) used_.push_back(name.get<std::string>());
      json_["rotation_rows"] = from;
      reasons_.emplace_back("orientation <- r11 ... r33: by their names, row by row");
      return;
    }
  }

  static double usual_rate_Hz(double rate_Hz) {
    constexpr double near = 0.1;
    for (const double usual : {10.0, 20.0, 25.0, 30.0, 50.0, 60.0, 100.0, 120.0, 200.0, 250.0, 500.0, 1000.0, 2000.0}) {
      if (std::abs(rate_Hz - usual) < near * usual) return usual;
    }
    return std::round(rate_Hz);
  }

  // A column that is another's rate tells the interval between rows.
  void rate_by_numbers(const ImportTable& table) {
    if (columns_.contains("t_s")) return;
    for (std::size_t a = 0; a < table.names.size(); ++a) {
      for (std::size_t b = 0; b < table.names.size(); ++b) {
        if (a == b) continue;
        const auto& q = table.columns[a];
        const auto& v = table.columns[b];
        double qv = 0.0, vv = 0.0, qq = 0.0;
        for (std::size_t i = 5; i + 5 < q.size(); ++i) {
          const double moved = (q[i + 5] - q[i - 5]) / 10.0;
          qv += moved * v[i], vv += v[i] * v[i], qq += moved * moved;
        }
        if (!(vv > 0.0) || !(qq > 0.0) || qv * qv < 0.9 * qq * vv || !(qv > 0.0)) continue;
        // Noise in the rate makes one ratio too large, the other too small: between them, at a usual rate where one is
        // near.
        const double rate_Hz = usual_rate_Hz(std::sqrt(vv / qq));
        if (!(rate_Hz >= 1.0)) continue;
        columns_["t_s"] = {{"row_rate_Hz", rate_Hz}};
        reasons_.push_back(
            fmt::format("t_s <- row numbers at {} Hz: {} is the rate of {} at about that many rows a second, check it",
                        rate_Hz, reference(table, b), reference(table, a)));
        if (table.names_from_file) return;
        use("q_rad", {{"from", reference(table, a)}}, reference(table, a),
            "its rate stands beside it; radians assumed");
        use("qd_rad_per_s", {{"from", reference(table, b)}}, reference(table, b),
            "it is the rate of " + table.names[a]);
        for (std::size_t c = 0; c < table.names.size(); ++c) {
          if (c == a || c == b || table.names.size() != 3) continue;
          use("torque_Nm", {{"from", reference(table, c)}}, reference(table, c),
              "the one column that is left beside an angle and its rate; N m assumed");
        }
        return;
      }
    }
  }

  std::vector<ImportTable> tables_;
  Json json_, columns_ = Json::object();
  std::vector<std::string> reasons_, used_;
};

}  // namespace

GuessedMap guess_map(const std::filesystem::path& path) { return Guesser(path).guess(); }

}  // namespace touchstone::importing
