#include <fmt/format.h>

#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>

#include "commands.h"
#include "harness/base/atomic_file.h"
#include "harness/base/progress.h"
#include "harness/report/console.h"
#include "harness/report/json_numbers.h"
#include "servo/width.h"
#include "setup_flags.h"

namespace touchstone::loop {
namespace {

struct TuneOptions {
  SetupFlags setup;
  std::vector<std::string> devices = servo::device_names();
  std::vector<std::string> grips{"light", "firm"};
  double margin = 2.0;
  std::string json;
};

struct Tuned {
  servo::LoopSetup setup;  // with the last of the grips
  servo::TunedWall wall;
};

std::string to_json(const std::vector<Tuned>& all, double margin) {
  nlohmann::json devices = nlohmann::json::array();
  for (const Tuned& own : all) {
    const auto published = own.setup.device.value("stable_stiffness_N_per_m");
    devices.push_back({{"device", own.setup.device.name},
                       {"stiffness_N_per_m", own.wall.stiffness_N_per_m},
                       {"virtual_damping_N_s_per_m", own.wall.virtual_damping_N_s_per_m},
                       {"undamped_N_per_m", own.wall.undamped_N_per_m},
                       {"published_N_per_m", published ? nlohmann::json(*published) : nlohmann::json()},
                       {"assumed", own.setup.assumed}});
  }
  const nlohmann::json whole{{"schema", "touchstone-loop-tune/1"}, {"margin", margin}, {"devices", devices}};
  return whole.dump(2) + "\n";
}

ExitStatus tune_command(const TuneOptions& options) {
  std::vector<Tuned> all;
  Progress progress("devices", options.devices.size());
  for (const std::string& device : options.devices) {
    std::vector<servo::LoopSetup> setups;
    for (const std::string& grip : options.grips) setups.push_back(options.setup.make(device, grip));
    all.push_back({setups.back(), servo::tune(setups, options.margin, {})});
    progress.update(all.size());
  }
  if (!options.json.empty()) write_file(options.json, to_json(all, options.margin));
  std::vector<std::vector<std::string>> rows{{"device", "stiffest wall [N/m]", "with virtual damping [N s/m]",
                                              "without [N/m]", "published [N/m]", "mass [kg]"}};
  double everywhere = servo::stiffest_wall_N_per_m;
  for (const Tuned& own : all) {
    const auto published = own.setup.device.value("stable_stiffness_N_per_m");
    const auto& masses = own.setup.device_masses_kg;
    rows.push_back({own.setup.device.name, fmt::format("{:.0f}", own.wall.stiffness_N_per_m),
                    fmt::format("{:g}", own.wall.virtual_damping_N_s_per_m),
                    fmt::format("{:.0f}", own.wall.undamped_N_per_m),
                    published ? fmt::format("{:g}", *published) : "none",
                    masses.size() == 1 ? fmt::format("{:g}", masses.front())
                                       : fmt::format("{:g} to {:g}", masses.front(), masses.back())});
    everywhere = std::min(everywhere, own.wall.undamped_N_per_m);
  }
  fmt::print("{}stable on all of them without virtual damping, {:g} times as stiff too: {:.0f} N/m\n",
             report::align_columns(rows), options.margin, everywhere);
  return ExitStatus::passed;
}

}  // namespace

void add_tune(CLI::App& loop, apps::Run& run) {
  auto* const command = loop.add_subcommand(
      "tune", "The stiffest wall and the least virtual damping that are stable with a margin, on a list of devices");
  auto options = std::make_shared<TuneOptions>();
  command->add_option("--device", options->devices, "As of `touchstone loop`; may be repeated")->capture_default_str();
  command->add_option("--grip", options->grips, "As of `touchstone loop`; stable in all of them")
      ->capture_default_str();
  options->setup.add_figures_to(*command);
  command->add_option("--margin", options->margin, "The wall stays stable when it is this many times as stiff")
      ->check(CLI::Range(1.0, 100.0))
      ->capture_default_str();
  command->add_option("--json", options->json, "Write the figures as JSON");
  command->footer(
      "Published: the largest stable stiffness of the device's sheet, with its source there.\n"
      "Examples:\n"
      "  touchstone loop tune --device touch --device falcon --grip light\n"
      "  touchstone loop tune --device touch-x --set latency_s=0.002 --margin 1.5 --json tuned.json");
  command->callback([options, &run] { run = [options] { return tune_command(*options); }; });
}

}  // namespace touchstone::loop
