// What tables of numbers look like that name little: approach and retract of an indentation side by side, and wrenches
// with a file of poses beside them; an angle beside its rate.
#pragma once

#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "import_table.h"

namespace touchstone::importing {

struct GuessedCurves {
  nlohmann::ordered_json json;  // the whole map
  std::vector<std::string> reasons;
  std::vector<std::string> decide;  // what was assumed
};

// Two columns named "Extend ..." and two named "Retract ..." (AFM Workshop), or three without names of which the first
// is a ramp and the others meet where they are pressed (NT-MDT). Nothing for other tables.
std::optional<GuessedCurves> guess_curves(const ImportTable& table);

struct GuessedWrench {
  std::vector<std::pair<std::string, std::pair<std::string, std::string>>> columns;  // of the map: from, reason
  std::string pose_file;                                                             // beside it; "" if there is none
};

// Six columns without names, the first three larger than the others: force and torque. Its poses: a file beside it with
// "pose" for "wrench" in its name, as many rows, seven columns, the last four a quaternion.
std::optional<GuessedWrench> guess_wrench(const ImportTable& table);

struct GuessedJoint {
  std::size_t angle = 0, rate = 0;  // columns
  double rate_Hz = 0.0;             // of the rows
};

// A column that is another's rate tells the interval between rows.
std::optional<GuessedJoint> guess_joint(const ImportTable& table);

}  // namespace touchstone::importing
