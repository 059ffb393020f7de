#include <fmt/format.h>

#include <memory>
#include <nlohmann/json.hpp>

#include "devices/probe.h"
#include "harness/base/atomic_file.h"
#include "harness/report/page_html.h"
#include "hil_commands.h"
#include "lab/evidence_page.h"

namespace touchstone::hil {
namespace {

struct ProbeOptions {
  std::string map, json;
  std::vector<std::string> devices;
};

// Those that are named, or all.
std::vector<ProbeResult> probed(const ProbeOptions& options) {
  const auto map = hardware_map_from(options.map);
  if (options.devices.empty()) return probe(map);
  std::vector<ProbeResult> results;
  for (const auto& id : options.devices) results.push_back(probe_one(id, map));
  return results;
}

void add_probe(CLI::App& hil_command, Run& run) {
  auto* const command =
      hil_command.add_subcommand("probe", "Which of the known devices are here, and why the others cannot be used");
  auto options = std::make_shared<ProbeOptions>();
  command->add_option("devices", options->devices,
                      "Only these, by their ids. Devices that serve few clients (onrobot-hex, optitrack, vrpn) are "
                      "connected to only if they are named");
  command->add_option("--map", options->map,
                      "Hardware map (JSON); default: the file that TOUCHSTONE_HARDWARE_MAP names");
  command->add_option("--json", options->json, "Write the results to this file");
  command->footer(
      "Exit status: 0 a device is usable, 1 one that the map calls connected is not, 77 none is here. A device that "
      "was not asked counts for none of them.\n"
      "Examples:\n  touchstone hil probe --map lab/hardware.json --json probe.json\n  touchstone hil probe optitrack "
      "--map lab/hardware.json");
  command->callback([options, &run] {
    run = [options] {
      const auto results = probed(*options);
      nlohmann::json json{{"schema", "touchstone-probe/1"}};
      bool any = false, broken = false;
      for (const auto& r : results) {
        const bool present = r.status == DeviceStatus::present;
        any = any || present;
        broken = broken || (r.required && !present && r.status != DeviceStatus::not_asked);
        fmt::print("{:<22} {:<20} {}{}\n", r.id, to_string(r.status), r.reason,
                   r.required ? " [connected by the map]" : "");
        json["devices"].push_back({{"id", r.id},
                                   {"name", r.name},
                                   {"status", to_string(r.status)},
                                   {"serial", r.serial},
                                   {"reason", r.reason},
                                   {"required", r.required}});
      }
      if (!options->json.empty()) write_file(options->json, json.dump(1) + "\n");
      return broken ? ExitStatus::failed : any ? ExitStatus::passed : ExitStatus::skipped;
    };
  });
}

struct ReportCommand {
  std::string folder, out;
};

void add_report(CLI::App& hil_command, Run& run) {
  auto* const command = hil_command.add_subcommand("report", "The evidence of a lab's run as an HTML page");
  auto options = std::make_shared<ReportCommand>();
  command->add_option("folder", options->folder, "Evidence: the folder hardware or emulated of a run")->required();
  command->add_option("--out", options->out, "The page to write (.html)")->required();
  command->footer(
      "Exit status: 0 all limits hold, 1 some do not.\n"
      "Example:\n  TOUCHSTONE_HIL_EVIDENCE=evidence ctest -L '^hil$'\n  touchstone hil report evidence/hardware --out "
      "lab.html");
  command->callback([options, &run] {
    run = [options] {
      const auto made = evidence_page(options->folder);
      write_html(options->out, made.page);
      fmt::print("{}{} tests, {} out of their limits -> {}\n", made.emulated ? "emulated: " : "", made.tests,
                 made.failed, options->out);
      return made.failed == 0 ? ExitStatus::passed : ExitStatus::failed;
    };
  });
}

}  // namespace

void add_hil(CLI::App& program, Run& run) {
  auto* const command = program.add_subcommand(
      "hil", "Hardware in the loop: find devices, record from them, recover recordings, render live");
  command->require_subcommand(1);
  add_probe(*command, run);
  add_hil_record(*command, run);
  add_hil_recover(*command, run);
  add_hil_render(*command, run);
  add_report(*command, run);
}

}  // namespace touchstone::hil
