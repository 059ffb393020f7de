#include <fmt/format.h>

#include <memory>

#include "acquire_command.h"
#include "acquired_file.h"
#include "frame_check.h"
#include "free_air_files.h"
#include "harness/base/atomic_file.h"

namespace touchstone::acquisition {
using apps::Run;

namespace {

struct RunOptions {
  std::string description, out, json;
  RawStreams streams;
  bool check = false;
};

ExitStatus acquire_streams(const RunOptions& options) {
  if (options.streams.force.empty() != options.streams.motion.empty())
    throw UsageError("--force and --motion: both streams are needed, or neither");
  if (options.check == !options.out.empty()) throw UsageError("--out: the recording to write, or --check");
  const auto named = options.streams.force.empty() ? std::nullopt : std::optional(options.streams);
  const AcquisitionDescription description = read_description(options.description, named);
  if (options.check) return ExitStatus::passed;
  const auto result = acquire_into(description, options.out, options.json);
  fmt::print("{}", result.text());
  return result.passed() ? ExitStatus::passed : ExitStatus::failed;
}

struct ToolOptions {
  std::string table, json;
  double gravity_m_per_s2 = 9.80665;
  bool si = false;
  std::string wrench_frame = "sensor", orientation = "given";
  bool flip_force = false;
};

PoseReading reading_of(const ToolOptions& options) {
  PoseReading reading;
  if (options.wrench_frame == "world") reading.wrench = WrenchFrame::world;
  if (options.orientation == "inverse") reading.orientation = OrientationReading::inverse;
  if (options.orientation == "scalar-last") reading.orientation = OrientationReading::scalar_last;
  reading.flip_force = options.flip_force;
  return reading;
}

// Passed, or failed where the best tool does not explain the poses: its mass and bias are not to be relied on.
ExitStatus identify_from_poses(const ToolOptions& options) {
  const Vec3 gravity(0, 0, -options.gravity_m_per_s2);
  const PoseReading reading = reading_of(options);
  const auto poses = recording::read_static_poses(options.table, options.si);
  AcquisitionReport report;
  report.tool = recording::identify_tool(read_as(poses, reading), gravity, options.table);
  report.gains = identify_gains(read_as(poses, reading), gravity);
  const FrameCheck check = check_frames(poses, reading, *report.tool, gravity, options.table);
  fmt::print("{}", tool_text(*report.tool, report.gains, check.forces_fit()));
  if (check.bad_fit) {
    report.notes.push_back(check.message(*report.tool, options.table));
    fmt::print(stderr, "warning: {}\n", report.notes.back());
  }
  if (!options.json.empty()) write_file(options.json, report_json(report));
  return check.bad_fit ? ExitStatus::failed : ExitStatus::passed;
}

void add_run(CLI::App& acquire_command, Run& run) {
  auto* const command = acquire_command.add_subcommand(
      "run", "Raw force and motion streams to a recording, every step with its residual");
  auto options = std::make_shared<RunOptions>();
  command
      ->add_option("description", options->description,
                   "Acquisition description (JSON, schema touchstone-acquisition/1)")
      ->required();
  command->add_option("--out", options->out, "The recording to write (.csv, .csv.gz or .h5)");
  command->add_option("--json", options->json, "Write the report with all residuals to this file");
  command->add_option("--force", options->streams.force,
                      "The force's stream, for a description that names no files (`hil record --acquire`)");
  command->add_option("--motion", options->streams.motion, "The motion's stream, likewise");
  command->add_flag("--check", options->check, "Only read the description: is it complete?");
  command->footer(
      "Exit status 1: the recording is written, but it is not sane (force reversed or in another frame, place), or\n"
      "something is touched where there should be free air; a note says what to do. Exit status 3: the streams\n"
      "contradict what the description assumes (bias, frames, tip, markers, an object at rest), and nothing is "
      "written.\n\n"
      "Example:\n  touchstone acquire run session/acquisition.json --out session/recording.csv --json "
      "session/report.json");
  command->callback([options, &run] { run = [options] { return acquire_streams(*options); }; });
}

void add_tool_load(CLI::App& acquire_command, Run& run) {
  auto* const command =
      acquire_command.add_subcommand("tool", "Mass, centre of mass and bias from static orientations");
  auto options = std::make_shared<ToolOptions>();
  command
      ->add_option("table", options->table,
                   "Columns fx_N ... tz_Nm and qw, qx, qy, qz (or r11 ... r33), one row per orientation")
      ->required();
  command->add_option("--gravity", options->gravity_m_per_s2, "Gravity along -z of the orientations' world, m/s^2")
      ->capture_default_str();
  command->add_flag("--si", options->si, "Columns without a unit (fx, tx) are in N and N m");
  command
      ->add_option("--wrench-frame", options->wrench_frame,
                   "Frame that force and torque are written in; world: turned by the orientation already")
      ->check(CLI::IsMember({"sensor", "world"}))
      ->capture_default_str();
  command
      ->add_option("--orientation", options->orientation,
                   "given: turns the sensor's frame into the world's; inverse: the other way; scalar-last: the columns "
                   "qw, qx, qy, qz hold x, y, z, w")
      ->check(CLI::IsMember({"given", "inverse", "scalar-last"}))
      ->capture_default_str();
  command->add_flag("--flip-force", options->flip_force, "The file has the reversed force: negate force and torque");
  command->add_option("--json", options->json, "Write the result to this file");
  command->footer(
      "Exit status 1: the best tool leaves more than a tenth of its weight; the message names the reading of the file "
      "that fits, where one does.\n\n"
      "Examples:\n"
      "  touchstone acquire tool orientations.csv --json tool.json\n"
      "  touchstone acquire tool orientations.csv --wrench-frame world");
  command->callback([options, &run] { run = [options] { return identify_from_poses(*options); }; });
}

struct FreeAirOptions {
  FreeAirFiles files;
  std::string acceleration, json;
};

void add_free_air(CLI::App& acquire_command, Run& run) {
  auto* const command = acquire_command.add_subcommand(
      "free-air", "The residual force when a moving tool touches nothing, and its causes");
  auto options = std::make_shared<FreeAirOptions>();
  auto& files = options->files;
  command
      ->add_option("statics", files.statics,
                   "Static orientations as for `acquire tool`, with ax, ay, az where there is an accelerometer")
      ->required();
  command->add_option("--wrench", files.wrench, "The run: t, fx ... tz")->required();
  command->add_option("--orientation", files.orientation, "The run: t and qw ... qz or r11 ... r33, on its own clock")
      ->required();
  command->add_option("--acceleration", options->acceleration, "The run: t, ax, ay, az in any unit, on its own clock");
  command->add_option("--time-unit", files.time_unit, "Of a column t without one")
      ->check(CLI::IsMember({"s", "ms", "us"}));
  command->add_option("--gravity", files.gravity_m_per_s2, "Gravity along -z of the orientations' world, m/s^2")
      ->capture_default_str();
  command->add_flag("--si", files.bare_is_si, "Columns without a unit (fx, tx) are in N and N m");
  command->add_option("--json", options->json, "Write the result to this file");
  command->footer(
      "Example:\n  touchstone acquire free-air statics.csv --wrench wrench.csv --orientation orientations.csv "
      "--acceleration accel.csv --time-unit us --si");
  command->callback([options, &run] {
    run = [options] {
      if (!options->acceleration.empty()) options->files.acceleration = options->acceleration;
      const auto result = read_and_analyse_free_air(options->files);
      fmt::print("{}", free_air_text(result));
      if (!options->json.empty()) write_file(options->json, free_air_json(result));
      const std::string contact = contact_message(result.report, options->files.wrench.string());
      if (contact.empty()) return ExitStatus::passed;
      fmt::print(stderr, "warning: {}\n", contact);
      return ExitStatus::failed;
    };
  });
}

}  // namespace

void add_acquire(CLI::App& program, Run& run) {
  auto* const command = program.add_subcommand("acquire", "Raw sensor and tracker streams to a recording");
  command->require_subcommand(1);
  add_run(*command, run);
  add_tool_load(*command, run);
  add_free_air(*command, run);
}

}  // namespace touchstone::acquisition
