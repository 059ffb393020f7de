#include "guess_curves.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "harness/base/error.h"
#include "harness/stats/quantile.h"

namespace touchstone::importing {
namespace {

using Json = nlohmann::ordered_json;

// A curve has no clock: rows stand in for one.
constexpr double row_rate_Hz = 1000.0;

double slope_sign(const std::vector<double>& x, const std::vector<double>& y) {
  double mx = 0.0, my = 0.0, xy = 0.0;
  const auto n = static_cast<double>(x.size());
  for (std::size_t i = 0; i < x.size(); ++i) mx += x[i] / n, my += y[i] / n;
  for (std::size_t i = 0; i < x.size(); ++i) xy += (x[i] - mx) * (y[i] - my);
  return xy < 0.0 ? -1.0 : 1.0;
}

// A recording that presses along z, from the stacked columns z [z_scale mm] and load [load_scale mN].
Json map_of(const ImportTable& table, Json stack, double z_scale, double load_scale) {
  Json json;
  json["schema"] = "touchstone-import/1";
  json["about"] = fmt::format("proposed for {}; read every line before use", table.source);
  json["stack"] = std::move(stack);
  json["columns"] = {{"t_s", {{"row_rate_Hz", row_rate_Hz}}},
                     {"x_mm", {{"constant", 0}}},
                     {"y_mm", {{"constant", 0}}},
                     {"z_mm", {{"from", "z"}, {"scale", z_scale}}},
                     {"fx_mN", {{"constant", 0}}},
                     {"fy_mN", {{"constant", 0}}},
                     {"fz_mN", {{"from", "load"}, {"scale", load_scale}}}};
  return json;
}

constexpr const char* clock_question = "t_s: the file has no clock: put the rate of its rows";

std::string clock_reason() {
  return fmt::format("t_s <- row numbers: the file has no clock; {} Hz stands in for one, put the real rate",
                     row_rate_Hz);
}

std::optional<std::size_t> column_like(const ImportTable& table, std::string_view start, std::string_view unit) {
  for (std::size_t c = 0; c < table.names.size(); ++c) {
    if (table.names[c].starts_with(start) && table.names[c].ends_with(unit)) return c;
  }
  return std::nullopt;
}

std::optional<GuessedCurves> named_side_by_side(const ImportTable& table) {
  const auto z_there = column_like(table, "Extend", "(nm)"), f_there = column_like(table, "Extend", "(nN)");
  const auto z_back = column_like(table, "Retract", "(nm)"), f_back = column_like(table, "Retract", "(nN)");
  if (!z_there || !f_there || !z_back || !f_back) return std::nullopt;
  // The recording's z points out of the object: the force falls with it.
  const double up = -slope_sign(table.columns[*z_there], table.columns[*f_there]);
  const auto part = [&](std::size_t z, std::size_t load) { return Json{{"z", z + 1}, {"load", load + 1}}; };
  GuessedCurves out;
  out.json = map_of(table, Json::array({part(*z_there, *f_there), part(*z_back, *f_back)}), up * 1e-6, 1e-6);
  out.reasons = {fmt::format("stack <- {} and {}, below them {} and {}: approach beside retract, by their names",
                             table.names[*z_there], table.names[*f_there], table.names[*z_back], table.names[*f_back]),
                 fmt::format("z_mm: in nm{}", up < 0.0 ? "; turned round, since the force grows with it" : ""),
                 "fz_mN: in nN, by its name", clock_reason()};
  out.decide = {clock_question};
  return out;
}

std::optional<GuessedCurves> unnamed_side_by_side(const ImportTable& table) {
  constexpr std::size_t fewest = 50;
  if (table.names_from_file || table.columns.size() != 3 || table.rows() < fewest) return std::nullopt;
  const auto& ramp = table.columns[0];
  const double step = (ramp.back() - ramp.front()) / static_cast<double>(ramp.size() - 1);
  for (std::size_t i = 1; i < ramp.size(); ++i) {
    constexpr double even = 0.2;
    if (!(std::abs(ramp[i] - ramp[i - 1] - step) < even * std::abs(step))) return std::nullopt;
  }
  const auto [low, high] = std::ranges::minmax(table.columns[1]);
  const auto apart = [&](std::size_t i) { return std::abs(table.columns[1][i] - table.columns[2][i]); };
  // They meet where the tip turns back, which is the pressed end: there the load is far from what it mostly is.
  constexpr double near = 0.02;
  const double mostly = stats::median(table.columns[1]);
  const bool pressed_first = std::abs(table.columns[1].front() - mostly) > std::abs(table.columns[1].back() - mostly);
  const std::size_t turn = pressed_first ? 0 : ramp.size() - 1;
  if (!(high > low) || !(apart(turn) < near * (high - low))) return std::nullopt;
  const double up = -slope_sign(ramp, table.columns[1]);
  GuessedCurves out;
  // The file of which the format's description is known begins pressed, and pads there (afmformats,
  // fmt_ntmdt_txt: approach[::-1], then retract, both without their constant beginning).
  Json approach{{"z", 1}, {"load", 2}};
  Json retract{{"z", 1}, {"load", 3}};
  (pressed_first ? approach : retract)["reverse"] = true;
  if (pressed_first) approach["padded"] = "load", retract["padded"] = "load";
  out.json = map_of(table, Json::array({approach, retract}), up * 1e-6, 1.0);
  out.reasons = {
      fmt::format(
          "stack <- c1 with c2{}, below it c1 with c3{}: c1 is an even ramp, and c2 and c3 meet at its {}, where "
          "the load is far from its usual value: approach beside retract, which turn there",
          pressed_first ? " in reverse" : "", pressed_first ? "" : " in reverse", pressed_first ? "beginning" : "end"),
      fmt::format("z_mm <- c1: nm assumed, the file names no unit{}: check it",
                  up < 0.0 ? "; turned round, since c2 grows with it" : ""),
      "fz_mN <- c2 and c3: the file names no unit: put the cantilever's N for one of them in place of the scale",
      clock_reason()};
  out.decide = {"z_mm: c1 names no unit: nm is assumed", "fz_mN: c2 and c3 name no unit: put their scale to mN",
                clock_question};
  return out;
}

double mean_size(const ImportTable& table, std::size_t from) {
  double sum = 0.0;
  for (std::size_t c = from; c < from + 3; ++c) {
    for (const double v : table.columns[c]) sum += std::abs(v) / static_cast<double>(3 * table.rows());
  }
  return sum;
}

std::string pose_beside(const ImportTable& wrench) {
  const std::filesystem::path path = wrench.source;
  std::string name = path.filename().string();
  const auto at = name.find("wrench");
  if (at == std::string::npos) return "";
  name.replace(at, 6, "pose");
  try {
    const ImportTable pose = read_foreign(path.parent_path() / name, {}).front();
    if (pose.rows() != wrench.rows() || pose.columns.size() != 7) return "";
    for (std::size_t i = 0; i < pose.rows(); ++i) {
      double square = 0.0;
      for (std::size_t c = 3; c < 7; ++c) square += std::pow(pose.columns[c][i], 2);
      if (!(std::abs(square - 1.0) < 1e-3)) return "";
    }
  } catch (const BadData&) {
    return "";  // none, or none that can be read: the wrench alone is proposed
  }
  return name;
}

double usual_rate_Hz(double rate_Hz) {
  constexpr double near = 0.1;
  for (const double usual : {10.0, 20.0, 25.0, 30.0, 50.0, 60.0, 100.0, 120.0, 200.0, 250.0, 500.0, 1000.0, 2000.0}) {
    if (std::abs(rate_Hz - usual) < near * usual) return usual;
  }
  return std::round(rate_Hz);
}

}  // namespace

std::optional<GuessedJoint> guess_joint(const ImportTable& table) {
  for (std::size_t a = 0; a < table.names.size(); ++a) {
    for (std::size_t b = 0; b < table.names.size(); ++b) {
      if (a == b) continue;
      const auto& q = table.columns[a];
      // What only increases is rather a clock.
      if (std::ranges::adjacent_find(q, [](double x, double y) { return !(y > x); }) == q.end()) continue;
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
      if (rate_Hz >= 1.0) return GuessedJoint{a, b, rate_Hz};
    }
  }
  return std::nullopt;
}

std::optional<GuessedCurves> guess_curves(const ImportTable& table) {
  if (auto named = named_side_by_side(table)) return named;
  return unnamed_side_by_side(table);
}

std::optional<GuessedWrench> guess_wrench(const ImportTable& table) {
  constexpr double larger = 3.0;
  if (table.names_from_file || table.columns.size() != 6 || table.rows() < 2) return std::nullopt;
  if (!(mean_size(table, 0) > larger * mean_size(table, 3))) return std::nullopt;
  GuessedWrench out;
  const std::string axes = "xyz";
  for (std::size_t c = 0; c < 6; ++c) {
    out.columns.push_back(
        {fmt::format("{}{}_{}", c < 3 ? "f" : "t", axes[c % 3], c < 3 ? "N" : "Nm"),
         {table.names[c], c < 3 ? "six columns without names, the first three larger: force, N assumed, check it"
                                : "the last three of six: torque, N m assumed, check it"}});
  }
  out.pose_file = pose_beside(table);
  return out;
}

}  // namespace touchstone::importing
