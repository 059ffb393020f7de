#include <fmt/format.h>

#include <memory>
#include <nlohmann/json.hpp>

#include "apps/commands.h"
#include "apps/hil_commands.h"
#include "harness/base/atomic_file.h"
#include "harness/report/page_html.h"
#include "hil/devices/device_lock.h"
#include "hil/devices/device_table.h"
#include "hil/devices/probe.h"
#include "hil/drivers/comedi_daq.h"
#include "hil/drivers/netft.h"
#include "hil/drivers/onrobot.h"
#include "hil/lab/evidence_page.h"
#include "hil/record/record_session.h"
#include "hil/safety/stop_signal.h"

namespace touchstone::apps {
namespace {

hil::HardwareMap map_from(const std::string& file) {
  return file.empty() ? hil::hardware_map_from_environment() : hil::load_hardware_map(file);
}

struct ProbeOptions {
  std::string map, json;
};

void add_probe(CLI::App& hil_command, Run& run) {
  auto* const command =
      hil_command.add_subcommand("probe", "Which of the known devices are here, and why the others cannot be used");
  auto options = std::make_shared<ProbeOptions>();
  command->add_option("--map", options->map,
                      "Hardware map (JSON); default: the file that TOUCHSTONE_HARDWARE_MAP names");
  command->add_option("--json", options->json, "Write the results to this file");
  command->footer(
      "Exit status: 0 a device is usable, 1 one that the map calls connected is not, 77 none is here.\n"
      "Example:\n  touchstone hil probe --map lab/hardware.json --json probe.json");
  command->callback([options, &run] {
    run = [options] {
      const auto results = hil::probe(map_from(options->map));
      nlohmann::json json{{"schema", "touchstone-probe/1"}};
      bool any = false, broken = false;
      for (const auto& r : results) {
        const bool present = r.status == hil::DeviceStatus::present;
        any = any || present;
        broken = broken || (r.required && !present);
        fmt::print("{:<22} {:<20} {}{}\n", r.id, hil::to_string(r.status), r.reason,
                   r.required ? " [connected by the map]" : "");
        json["devices"].push_back({{"id", r.id},
                                   {"name", r.name},
                                   {"status", hil::to_string(r.status)},
                                   {"serial", r.serial},
                                   {"reason", r.reason},
                                   {"required", r.required}});
      }
      if (!options->json.empty()) write_file(options->json, json.dump(1) + "\n");
      return broken ? ExitStatus::failed : any ? ExitStatus::passed : ExitStatus::skipped;
    };
  });
}

struct RecordCommand {
  std::string device, map, out;
  double seconds = 0.0, rate_Hz = 5000.0;
};

std::unique_ptr<hil::WrenchSource> open_source(const std::string& device, const hil::MappedDevice& mapped,
                                               double rate_Hz) {
  if (device == "ati-netft") {
    if (mapped.address.empty()) throw UsageError("ati-netft: its address must be in the hardware map");
    return hil::open_netft({mapped.address, mapped.http_port, mapped.udp_port}, 5.0, false);
  }
  if (device == "onrobot-hex") {
    if (mapped.address.empty()) throw UsageError("onrobot-hex: its address must be in the hardware map");
    return hil::open_onrobot({mapped.address, mapped.udp_port}, 5.0, false);
  }
  if (device == "ati-nano17-daq") {
    if (!mapped.calibration_file) throw UsageError("ati-nano17-daq: its calibration file must be in the hardware map");
    hil::ComediOptions options;
    if (!mapped.address.empty()) options.node = mapped.address;
    options.library = mapped.library;
    options.calibration_file = *mapped.calibration_file;
    options.sensor_serial = mapped.serial;
    options.rate_Hz = rate_Hz;
    return hil::open_comedi_ati(options);
  }
  throw UsageError(fmt::format("{}: cannot be recorded from; ati-netft, onrobot-hex and ati-nano17-daq can", device));
}

void add_record(CLI::App& hil_command, Run& run) {
  auto* const command = hil_command.add_subcommand("record", "Record a force sensor into a file that survives a crash");
  auto options = std::make_shared<RecordCommand>();
  command
      ->add_option("device", options->device, "ati-netft, onrobot-hex or ati-nano17-daq, described in the hardware map")
      ->required();
  command->add_option("--out", options->out, "Raw recording to make (.tsraw); an existing file is never overwritten")
      ->required();
  command->add_option("--map", options->map, "Hardware map; default: the file that TOUCHSTONE_HARDWARE_MAP names");
  command->add_option("--seconds", options->seconds, "Stop after so long; default: until Ctrl-C");
  command->add_option("--rate", options->rate_Hz, "Scans per second of a data acquisition card")->capture_default_str();
  command->footer(
      "Exit status: 0 every sample is there, 1 samples were lost or the stream stopped (what came is kept), 3 the "
      "device "
      "failed.\n"
      "Example:\n  touchstone hil record ati-netft --map lab/hardware.json --seconds 60 --out run1.tsraw\n  touchstone "
      "hil recover run1.tsraw --out run1.csv");
  command->callback([options, &run] {
    run = [options] {
      hil::StopSignal stop;  // before any thread starts
      const auto map = map_from(options->map);
      const auto* const mapped = map.find(options->device);
      if (mapped == nullptr)
        throw UsageError(fmt::format("{}: is not in the hardware map{}", options->device,
                                     map.source.empty() ? "; give one with --map" : " " + map.source));
      const auto state =
          mapped->calibration_file ? hil::calibration_state(*mapped, hil::today()) : hil::CalibrationState::usable;
      if (state != hil::CalibrationState::usable) throw BadData(hil::probe_one(options->device, map).reason);
      const hil::DeviceLock lock(*mapped);
      const auto source = open_source(options->device, *mapped, options->rate_Hz);
      hil::RecordOptions record;
      record.seconds = options->seconds;
      record.nominal_rate_Hz = options->rate_Hz;
      const auto report = hil::record_session(*source, options->out, record, [&stop] { return stop.asked(); });
      fmt::print(
          "recorded {} samples in {:.1f} s -> {}\nlost on the way {}, repeated {}, late {}, malformed {}, device "
          "errors {}, lost in memory {}\n",
          report.written, report.seconds, options->out, report.stream.lost, report.stream.repeated,
          report.stream.reordered, report.stream.malformed, report.stream.device_errors, report.lost_in_memory);
      const auto problems = report.problems();
      for (const auto& problem : problems) fmt::print(stderr, "{}: {}\n", options->device, problem);
      return problems.empty() ? ExitStatus::passed : ExitStatus::failed;
    };
  });
}

struct RecoverCommand {
  std::vector<std::string> files;
  std::string out;
};

void add_recover(CLI::App& hil_command, Run& run) {
  auto* const command =
      hil_command.add_subcommand("recover", "A raw recording, whole or damaged, to CSV for `touchstone acquire`");
  auto options = std::make_shared<RecoverCommand>();
  command->add_option("files", options->files, "Raw recording (.tsraw), and its spilled rest if there is one")
      ->required();
  command->add_option("--out", options->out, "The CSV to write")->required();
  command->footer("Example:\n  touchstone hil recover run1.tsraw /tmp/run1.tsraw.rest --out run1.csv");
  command->callback([options, &run] {
    run = [options] {
      const auto report = hil::export_raw({options->files.begin(), options->files.end()}, options->out);
      fmt::print(
          "{} samples at {:.3f} Hz -> {}{}\narrivals were {:.3g} ms late on average, {:.3g} ms at worst; the time axis "
          "is "
          "good to {:.2g} ms\n{} damaged bytes skipped, {} samples missing by the device's count (flag 16: the first "
          "one "
          "after a gap)\n",
          report.samples, report.rate_Hz, options->out, report.emulated ? " (emulated)" : "", 1e3 * report.mean_delay_s,
          1e3 * report.worst_delay_s, 1e3 * report.axis_uncertainty_s, report.damaged_bytes, report.missing_samples);
      return ExitStatus::passed;
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
      const auto made = hil::evidence_page(options->folder);
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
  add_record(*command, run);
  add_recover(*command, run);
  add_hil_render(*command, run);
  add_report(*command, run);
}

}  // namespace touchstone::apps
