#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>

#include "commands.h"
#include "harness/base/atomic_file.h"
#include "harness/recording/recording_file.h"
#include "harness/report/console.h"
#include "servo/data_sheet.h"
#include "servo/device_fit.h"

namespace touchstone::loop {
namespace {

struct FitOptions {
  std::string recording, name = "own", out;
};

std::string_view words(servo::Named named) {
  switch (named) {
    case servo::Named::present:
      return "";
    case servo::Named::negligible:
      return "negligible";
    case servo::Named::cannot_tell:
      return "cannot tell";
  }
  return "";
}

ExitStatus fit_command(const FitOptions& options) {
  const recording::Recording recording = recording::load_recording(options.recording);
  const servo::DeviceFit fit = servo::fit_device(recording);
  nlohmann::json figures = nlohmann::json::object(), unknown = nlohmann::json::object();
  std::vector<std::vector<std::string>> rows{{"effect", "share", "figure", "value", "+- (95 %)", "unit", ""}};
  const auto add = [&](std::string_view name, const servo::FittedFigure& own, const servo::DeviceEffect& effect) {
    const auto& entries = servo::device_entries();
    const auto entry = std::ranges::find(entries, name, &servo::FigureEntry::name);
    if (own.determined) {
      figures[std::string(name)] = {{"value", own.value},
                                    {"source", fmt::format("fitted to {} by touchstone loop fit: +- {:.2g} (95 %)",
                                                           options.recording, own.error95)},
                                    {"read_in", options.recording}};
    } else {
      unknown[std::string(name)] =
          fmt::format("{} does not determine it: {:.3g} +- {:.2g}", options.recording, own.value, own.error95);
    }
    rows.push_back({std::string(effect.name), fmt::format("{:.2g} %", 100.0 * effect.share), std::string(name),
                    fmt::format("{:.4g}", own.value), fmt::format("{:.2g}", own.error95), std::string(entry->unit),
                    std::string(words(effect.named))});
  };
  add("mass_kg", fit.mass_kg, fit.effects[0]);
  add("damping_N_s_per_m", fit.damping_N_s_per_m, fit.effects[1]);
  add("friction_N", fit.friction_N, fit.effects[2]);
  add("latency_s", fit.latency_s, fit.effects[3]);
  if (fit.resolution_m > 0.0) {
    figures["resolution_m"] = {
        {"value", fit.resolution_m}, {"source", "all positions are multiples of it"}, {"read_in", options.recording}};
  }
  figures["period_s"] = {{"value", fit.period_s}, {"source", "the recording's"}, {"read_in", options.recording}};
  const nlohmann::json sheet{
      {"schema", "touchstone-device/1"}, {"name", options.name}, {"figures", figures}, {"not_published", unknown}};
  write_file(options.out, sheet.dump(1) + "\n");
  fmt::print("{}", report::align_columns(rows));
  fmt::print("of the motion, {:.3g} m, the fit leaves {:.3g} m (root mean square, {} samples); ", fit.moved_m,
             fit.residual_m, fit.samples);
  if (fit.resolution_m > 0.0)
    fmt::print("the encoder's steps of {:.3g} m are {:.3g} m of it; ", fit.resolution_m,
               fit.resolution_m / std::sqrt(12.0));
  fmt::print("unexplained: {:.2g} % of the motion\n", 100.0 * fit.unexplained);
  if (!fit.mass_kg.determined && fit.unexplained > 0.1)
    fmt::print("something else moves the device: a hand, gravity, a spring that is not commanded\n");
  if (!fit.latency_s.determined || !fit.damping_N_s_per_m.determined) {
    fmt::print(
        "a slow swing does not tell latency from viscous friction: let the servo command forces that jump, too\n");
  }
  fmt::print("{}: figures for --device\n", options.out);
  return ExitStatus::passed;
}

}  // namespace

void add_fit(CLI::App& loop, apps::Run& run) {
  auto* const command = loop.add_subcommand(
      "fit", "A device's mass, friction and latency from a recording of the device alone, as a file for --device");
  auto options = std::make_shared<FitOptions>();
  command
      ->add_option("--recording", options->recording,
                   "Position and commanded force ON the device, one sample a period of the servo, nobody's hand on it: "
                   "CSV or HDF5 with t_s, x_m, y_m, z_m, fx_N, fy_N, fz_N")
      ->required();
  command->add_option("--name", options->name, "The device's name in the file")->capture_default_str();
  command->add_option("--out", options->out, "File to write (touchstone-device/1)")->required();
  command->footer(
      "Share: of the commanded force, what became of it (m a, b v, dry friction, the force less the late one), by mean "
      "square.\n"
      "Examples:\n"
      "  touchstone loop fit --recording shaken.csv --name mine --out mine.json\n"
      "  touchstone loop width --device mine.json --grip firm");
  command->callback([options, &run] { run = [options] { return fit_command(*options); }; });
}

}  // namespace touchstone::loop
