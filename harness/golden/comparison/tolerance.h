// How far a result may be from its baseline. Per sample, for each axis and for the magnitude:
//   |obtained - golden| <= atol + rtol |golden| + rpeak peak,
// peak being the largest magnitude of the golden over the run; at most `beyond` samples may break it. Gates on the
// whole run come on top. A tolerance file:
//   {"schema": "touchstone-tolerance/1", "reason": "why these",
//    "force": {"atol_N": 1e-6, "rtol": 1e-6, "rpeak": 0, "direction_rad": 0.01, "direction_floor_N": 0.05,
//              "rms_N": 1e-3, "p99_N": 2e-3, "max_N": 0.01, "beyond": 0},
//    "position": {"atol_m": 1e-7, ...}, "contact_position": {...}, "torque": {"atol_Nm": ...},
//    "orientation": {"atol_rad": ...}, "time": {"atol_s": ...}, "contact": {"tube_s": 0.002, "beyond": 0}}
// What is not given keeps its default; a quantity cannot be left out of the comparison.
#pragma once

#include <cstddef>
#include <filesystem>
#include <map>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <string_view>

#include "harness/base/json_reader.h"

namespace touchstone::golden {

// Limits of one quantity, in its SI unit.
struct GroupTolerance {
  double atol = 0.0;
  double rtol = 0.0;
  double rpeak = 0.0;
  std::size_t beyond = 0;  // samples that may break the per-sample bound
  std::optional<double> rms = std::nullopt;
  std::optional<double> p99 = std::nullopt;
  std::optional<double> max = std::nullopt;
  std::optional<double> direction_rad =
      std::nullopt;  // angle to the golden's vector, where that is longer than the floor
  double direction_floor = 0.0;
};

struct Tolerance {
  std::string reason;
  std::map<std::string, GroupTolerance, std::less<>> groups;  // by the names of compared_quantities()
  // Contact events may come this much earlier or later; within that time of a golden event the obtained values must lie
  // inside the band that the golden covers there. 0: sample by sample.
  double tube_s = 0.0;

  [[nodiscard]] const GroupTolerance& of(std::string_view group) const { return groups.find(group)->second; }
};

// 1e-6 N, 1e-7 m, relative 1e-6; 1e-6 s, 1e-7 N m, 1e-6 rad; contact states exactly.
Tolerance default_tolerance();
Tolerance load_tolerance(const std::filesystem::path& path);
// From an object that may also stand inside another file; changes `base` where it says so. Throws BadData for a
// negative or unknown value.
Tolerance read_tolerance(JsonObject object, Tolerance base);
nlohmann::json to_json(const Tolerance& tolerance);

}  // namespace touchstone::golden
