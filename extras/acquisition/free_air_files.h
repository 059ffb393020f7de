// A free-air run from files, and its analysis for people and for programs.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "free_air.h"
#include "harness/recording/tool_load.h"

namespace touchstone::acquisition {
using recording::ToolIdentification;

struct FreeAirFiles {
  std::filesystem::path statics;      // one row per orientation: f, t, rotation, and a where there is an accelerometer
  std::filesystem::path wrench;       // t, f, t
  std::filesystem::path orientation;  // t, rotation
  std::optional<std::filesystem::path> acceleration;  // t, a: any unit, found from the statics
  std::string time_unit;                              // of a column `t` without one: s, ms or us
  bool bare_is_si = false;                            // columns without a unit are in N and N m
  double gravity_m_per_s2 = 9.80665;                  // along -z of the orientations' world
};

struct FreeAirResult {
  ToolIdentification tool;
  std::optional<double> accelerometer_residual_m_per_s2;
  FreeAirReport report;
};

// Throws BadData naming the file for what is missing or does not fit together.
FreeAirResult read_and_analyse_free_air(const FreeAirFiles& files);
// What the residual of the moving run is made of, line by line.
std::string free_air_text(const FreeAirResult& result);
std::string free_air_json(const FreeAirResult& result);

}  // namespace touchstone::acquisition
