#include "setup_flags.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "harness/base/named_values.h"

namespace touchstone::loop {

void SetupFlags::add_to(CLI::App& command) {
  command
      .add_option("--device", device,
                  fmt::format("The device, by name or as a file of its figures (touchstone-device/1): {}",
                              fmt::join(servo::device_names(), ", ")))
      ->capture_default_str();
  command
      .add_option("--grip", grip,
                  fmt::format("The hand, by name or as a file of its figures (touchstone-grip/1): {}",
                              fmt::join(servo::grip_names(), ", ")))
      ->capture_default_str();
  add_figures_to(command);
}

void SetupFlags::add_figures_to(CLI::App& command) {
  command.add_option("--set", set,
                     fmt::format("A figure in place of the published one, NAME=VALUE; may be repeated: {}",
                                 fmt::join(servo::names_to_set(), ", ")));
  command.add_option("--seed", seed, "Of the jitter")->capture_default_str();
}

servo::LoopSetup SetupFlags::make(const std::string& device_name, const std::string& grip_name) const {
  return servo::make_setup(device_name, grip_name, named_values("--set", set), seed);
}

}  // namespace touchstone::loop
