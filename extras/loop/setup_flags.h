// --device, --grip, --set and --seed, the same for every command of the loop.
#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <string>
#include <vector>

#include "servo/setup.h"

namespace touchstone::loop {

struct SetupFlags {
  std::string device = "touch";
  std::string grip = "light";
  std::vector<std::string> set;
  std::uint64_t seed = 1;

  void add_to(CLI::App& command);
  // Without --device and --grip: for commands that take several.
  void add_figures_to(CLI::App& command);
  [[nodiscard]] servo::LoopSetup make() const { return make(device, grip); }
  [[nodiscard]] servo::LoopSetup make(const std::string& device_name, const std::string& grip_name) const;
};

}  // namespace touchstone::loop
