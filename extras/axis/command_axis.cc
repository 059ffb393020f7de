#include "command_axis.h"

#include <fmt/format.h>

#include <memory>

#include "axis_run.h"
#include "harness/base/atomic_file.h"

namespace touchstone::axis {
namespace {

struct AxisOptions {
  AxisRequest request;
  std::string out, json;  // a folder for axis.json and report.html, and a file for axis.json; empty: none
};

ExitStatus axis_command(const AxisOptions& options) {
  AxisInput input = load_axis(options.request.recording, options.request.flip_force);
  for (const std::string& remark : check_axis(input)) fmt::print(stderr, "warning: {}\n", remark);
  const AxisResult result = run_axis(options.request, std::move(input));
  fmt::print("{}", result.text());
  if (!options.json.empty()) write_file(options.json, result.json());
  if (!options.out.empty()) {
    fmt::print("report: {}\n", write_axis(options.request, result, apps::command_line(), options.out).string());
  }
  return ExitStatus::passed;
}

}  // namespace

void add_axis(CLI::App& program, apps::Run& run) {
  auto* const command = program.add_subcommand(
      "axis", "Torque over angle or force over indentation: what the place makes, friction, inertia, relaxation");
  const auto options = std::make_shared<AxisOptions>();
  command
      ->add_option("recording", options->request.recording,
                   "t_s with q_rad, torque_Nm and, if known, qd_rad_per_s; with q_m and force_N; or a recording that "
                   "presses along z")
      ->required();
  command->add_option("--repeat", options->request.repeat,
                      "The same motion recorded again: what they differ by is the floor");
  command->add_flag("--flip-force", options->request.flip_force,
                    "The file has the reversed torque or force: negate it");
  command->add_option("--out", options->out, "Folder for axis.json and report.html");
  command->add_option("--json", options->json, "Write axis.json here too");
  command->footer(
      "A load that drives the motion is refused (exit status 3), and so is a run that never turns back: friction and "
      "what "
      "depends on the place are then one.\n"
      "Examples:\n"
      "  touchstone axis sweep.csv --out sweep\n"
      "  touchstone axis press.csv --repeat press2.csv --json press.json");
  command->callback([&run, options] { run = [options] { return axis_command(*options); }; });
}

}  // namespace touchstone::axis
