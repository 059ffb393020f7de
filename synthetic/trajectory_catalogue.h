// Every trajectory by name. A new one is a maker in trajectory_catalogue.cc and a line in its table.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "synthetic/parameters.h"
#include "synthetic/trajectories/path.h"

namespace touchstone::synthetic {

struct TrajectoryEntry {
  std::string name;
  std::string summary;
  std::vector<Parameter> parameters;
  std::unique_ptr<Path> (*make)(const ParameterValues& values, std::uint64_t seed);
};

std::span<const TrajectoryEntry> trajectory_catalogue();

// Throws UsageError listing what is known for a name or parameter that is not.
std::unique_ptr<Path> make_path(std::string_view name, const ParameterOverrides& overrides = {},
                                std::uint64_t seed = 1);

}  // namespace touchstone::synthetic
