#include <fmt/format.h>

#include <filesystem>
#include <memory>

#include "apps/extras.h"
#include "hil_commands.h"
#include "record/device_recording.h"
#include "safety/stop_signal.h"

namespace touchstone::hil {
namespace {

struct RecordFlags {
  std::vector<std::string> devices;
  std::string map, out, acquire, force, motion;
  double seconds = 0.0, rate_Hz = 5000.0, handle_rate_Hz = 1000.0, silence_s = 2.0;
};

ExitStatus said(const std::vector<std::string>& problems, const std::string& who) {
  for (const auto& problem : problems) fmt::print(stderr, "{}{}\n", who, problem);
  return problems.empty() ? ExitStatus::passed : ExitStatus::failed;
}

std::vector<std::string> axis_problems(const SessionExport& session) {
  std::vector<std::string> problems;
  for (const auto& table : session.tables) {
    if (const auto problem = table.report.axis_problem(); !problem.empty())
      problems.push_back(fmt::format("{}: {}", table.name, problem));
  }
  return problems;
}

// `touchstone acquire run`, which is an extra.
ExitStatus acquire(const RecordFlags& options, const std::string& force, const std::string& motion,
                   const std::vector<std::string>& more) {
  const std::optional<apps::Extra> extra = apps::find_extra("acquire");
  if (!extra) {
    throw UsageError(
        "--acquire needs the extra `touchstone acquire`; touchstone-acquire is neither beside this program nor on "
        "PATH");
  }
  std::vector<std::string> words{"run", options.acquire, "--force", force, "--motion", motion};
  words.insert(words.end(), more.begin(), more.end());
  return apps::run_extra_and_wait(*extra, words);
}

ExitStatus record_one(const RecordFlags& options, const std::function<bool()>& stop) {
  RecordOptions record;
  record.seconds = options.seconds;
  record.silence_s = options.silence_s;
  record.nominal_rate_Hz = options.rate_Hz;
  const std::string& id = options.devices.front();
  const auto report = record_device(id, hardware_map_from(options.map), options.out, record, stop);
  fmt::print("{}", record_text(report, options.out));
  return said(report.problems(), id + ": ");
}

ExitStatus record_many(const RecordFlags& options, const std::function<bool()>& stop) {
  const std::filesystem::path folder = options.out;
  // What is wrong in it is said before anything is recorded.
  if (!options.acquire.empty()) {
    if (const ExitStatus read = acquire(options, "force.csv", "motion.csv", {"--check"}); read != ExitStatus::passed)
      return read;
  }
  MultiOptions record;
  record.seconds = options.seconds;
  record.silence_s = options.silence_s;
  record.show = show_on_terminal();
  const auto report =
      record_devices(options.devices, hardware_map_from(options.map), folder,
                     {.card_rate_Hz = options.rate_Hz, .handle_rate_Hz = options.handle_rate_Hz}, record, stop);
  fmt::print("{}", record_text(report));
  ExitStatus status = said(report.problems(), "");
  const auto session = export_session(folder);
  fmt::print("{}", session_text(session));
  const auto uncertain = axis_problems(session);
  if (said(uncertain, "") != ExitStatus::passed) status = ExitStatus::failed;
  if (options.acquire.empty()) return status;
  if (!uncertain.empty()) {
    fmt::print(stderr, "no recording is acquired from streams without a sound time axis\n");
    return status;
  }
  const ExitStatus acquired =
      acquire(options, table_of(session, StreamKind::force, options.force, "--force"),
              table_of(session, StreamKind::motion, options.motion, "--motion"),
              {"--out", folder / "recording.csv", "--json", folder / "acquisition-report.json"});
  return acquired == ExitStatus::passed ? status : acquired;
}

}  // namespace

HardwareMap hardware_map_from(const std::string& file) {
  return file.empty() ? hardware_map_from_environment() : load_hardware_map(file);
}

void add_hil_record(CLI::App& hil_command, Run& run) {
  auto* const command = hil_command.add_subcommand(
      "record", "Record force sensors, trackers and haptic devices together, into files that survive a crash");
  auto options = std::make_shared<RecordFlags>();
  command->add_option("devices", options->devices, "Devices of the hardware map, by their ids")->required();
  command
      ->add_option("--out", options->out,
                   "Folder to make, with a file for each device; for a force sensor alone also a file (.tsraw). What "
                   "exists is never overwritten")
      ->required();
  command->add_option("--map", options->map, "Hardware map; default: the file that TOUCHSTONE_HARDWARE_MAP names");
  command->add_option("--seconds", options->seconds, "Stop after so long; default: until Ctrl-C");
  command->add_option("--rate", options->rate_Hz, "Scans per second of a data acquisition card")->capture_default_str();
  command
      ->add_option("--handle-rate", options->handle_rate_Hz,
                   "Readings per second of a haptic device's handle, at zero force")
      ->capture_default_str();
  command->add_option("--silence", options->silence_s, "A stream that sends nothing for so long has stopped [s]")
      ->capture_default_str();
  command->add_option("--acquire", options->acquire,
                      "Acquisition description whose force and motion name no file: what was recorded becomes "
                      "recording.csv in the folder, as by touchstone acquire run");
  command->add_option("--force", options->force, "For --acquire: the force sensor, if there are several");
  command->add_option("--motion", options->motion, "For --acquire: the tracker or handle, if there are several");
  command->footer(
      "Exit status: 0 every sample is there, 1 samples were lost, a stream stopped, its device failed or its time axis "
      "is "
      "uncertain (what came is kept), 3 nothing could be recorded.\n"
      "Examples:\n  touchstone hil record ati-netft optitrack --map lab/hardware.json --seconds 60 --out run1\n  "
      "touchstone hil record ati-netft --map lab/hardware.json --out run1.tsraw");
  command->callback([options, &run] {
    run = [options] {
      StopSignal stop;  // before any thread starts
      const std::function<bool()> asked = [&stop] { return stop.asked(); };
      const bool file = std::filesystem::path(options->out).extension() == ".tsraw";
      if (file && options->devices.size() != 1)
        throw UsageError("--out: several devices need a folder, not a .tsraw file");
      if (file && !options->acquire.empty()) throw UsageError("--acquire: needs a folder in --out");
      return file ? record_one(*options, asked) : record_many(*options, asked);
    };
  });
}

void add_hil_recover(CLI::App& hil_command, Run& run) {
  struct Options {
    std::vector<std::string> files;
    std::string out;
  };
  auto* const command =
      hil_command.add_subcommand("recover", "A raw recording, whole or damaged, to tables for `touchstone acquire`");
  auto options = std::make_shared<Options>();
  command
      ->add_option("files", options->files,
                   "Raw recording (.tsraw), and its spilled rest if there is one; or the folder of a run")
      ->required();
  command->add_option("--out", options->out, "The CSV to write; a folder gets its tables beside its files");
  command->footer(
      "Exit status 1: the tables are written, but a time axis is uncertain by more than half a sample.\n"
      "Examples:\n  touchstone hil recover run1.tsraw /tmp/run1.tsraw.rest --out run1.csv\n  touchstone hil recover "
      "run1");
  command->callback([options, &run] {
    run = [options] {
      if (std::filesystem::is_directory(options->files.front())) {
        if (options->files.size() > 1 || !options->out.empty())
          throw UsageError("a folder is recovered alone, and into itself: give no --out and no other file");
        const auto session = export_session(options->files.front());
        fmt::print("{}", session_text(session));
        return said(axis_problems(session), "");
      }
      if (options->out.empty()) throw UsageError("--out: the CSV to write is needed");
      const auto report = export_raw({options->files.begin(), options->files.end()}, options->out);
      fmt::print("{}", recovery_text(report, options->out));
      const auto problem = report.axis_problem();
      return problem.empty() ? ExitStatus::passed : said({problem}, "");
    };
  });
}

}  // namespace touchstone::hil
