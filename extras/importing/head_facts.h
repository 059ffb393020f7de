// What the lines above a table say of all its columns: the rate, and units that the names leave out.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "column_name.h"

namespace touchstone::importing {

struct HeadFacts {
  std::optional<double> rate_Hz;  // "RDT Sample Rate: 7000"; nothing where two lines state different ones
  std::string rate_line;          // where it stands
  std::string length_unit, force_unit, torque_unit;           // "Length Units,Millimeters"; as written
  std::optional<double> counts_per_force, counts_per_torque;  // of network force sensors: the columns hold counts

  [[nodiscard]] const std::string& unit_of(Quantity quantity) const;
  [[nodiscard]] std::optional<double> counts_of(Quantity quantity) const;
};

HeadFacts head_facts(const std::vector<std::string>& head);

}  // namespace touchstone::importing
