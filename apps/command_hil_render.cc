#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <memory>
#include <nlohmann/json.hpp>

#include "apps/hil_commands.h"
#include "apps/mesh_flags.h"
#include "apps/plugin_flags.h"
#include "harness/base/atomic_file.h"
#include "harness/base/hash.h"
#include "harness/recording/recording_file.h"
#include "harness/rendering/replay.h"
#include "hil/devices/device_lock.h"
#include "hil/drivers/open_mapped.h"
#include "hil/drivers/plugin_device.h"
#include "hil/lab/live_loop.h"
#include "hil/safety/stop_signal.h"
#include "renderers/catalogue.h"

namespace touchstone::apps {
namespace {

struct LiveRenderOptions {
  std::string device, map, device_plugin, settings, model, mesh, mesh_unit = "m", out, dead_man;
  double seconds = 10.0, rate_Hz = 1000.0, force_limit_N = 0.0, workspace_m = 0.2, command_age_ms = 10.0;
  double power_limit_W = hil::usual_power_W, energy_limit_J = hil::usual_energy_J;
  double tolerance_N = 1e-9;
  MeshFlags meshes;
  PluginFlags plugins;
};

void check(const LiveRenderOptions& options) {
  if (options.device.empty() == options.device_plugin.empty())
    throw UsageError("either --device (of the hardware map) or --device-plugin must be given");
  if (!(options.force_limit_N > 0.0))
    throw UsageError("--force-limit: the largest force [N] that the guard lets pass must be above 0");
  const std::pair<double, const char*> positive[] = {{options.rate_Hz, "--rate"},
                                                     {options.seconds, "--seconds"},
                                                     {options.workspace_m, "--workspace"},
                                                     {options.command_age_ms, "--command-age"},
                                                     {options.power_limit_W, "--power-limit"},
                                                     {options.energy_limit_J, "--energy-limit"}};
  for (const auto& [value, name] : positive) {
    if (!(value > 0.0)) throw UsageError(fmt::format("{}: {} is not above 0", name, value));
  }
}

hil::GuardOptions guard_options_of(const LiveRenderOptions& options) {
  hil::GuardOptions guard;
  guard.limits.force_N = options.force_limit_N;
  // From nothing to the limit within ten ticks.
  guard.limits.slew_N_per_s = options.force_limit_N * options.rate_Hz / 10.0;
  guard.limits.workspace_W_m = Box3(Vec3::Constant(-options.workspace_m), Vec3::Constant(options.workspace_m));
  guard.limits.power_W = options.power_limit_W;
  guard.limits.energy_J = options.energy_limit_J;
  guard.limits.stale_s = 1e-3 * options.command_age_ms;
  // A more patient user is patient with driver and guard, too.
  guard.driver_timeout_s = std::max(guard.driver_timeout_s, 0.6 * guard.limits.stale_s);
  guard.watchdog_s = std::max(guard.watchdog_s, 0.8 * guard.limits.stale_s);
  return guard;
}

// The device behind its guard, with what is held while it is in use.
struct OpenedDevice {
  std::unique_ptr<hil::DeviceLock> lock;
  std::unique_ptr<hil::GuardedDevice> device;
  std::string dead_man;
};

OpenedDevice open_device(const LiveRenderOptions& options) {
  OpenedDevice opened;
  opened.dead_man = options.dead_man;
  if (!options.device_plugin.empty()) {
    opened.device = hil::open_guarded([&] { return hil::open_plugin_device(options.device_plugin, options.settings); },
                                      guard_options_of(options));
    return opened;
  }
  const auto map = options.map.empty() ? hil::hardware_map_from_environment() : hil::load_hardware_map(options.map);
  const auto* const mapped = map.find(options.device);
  if (mapped == nullptr)
    throw UsageError(fmt::format("{}: is not in the hardware map; give one with --map", options.device));
  if (!(options.force_limit_N <= mapped->force_limit_N)) {
    throw UsageError(fmt::format("--force-limit: {} N is more than the {} N that the hardware map allows {}",
                                 options.force_limit_N, mapped->force_limit_N, options.device));
  }
  if (opened.dead_man.empty()) opened.dead_man = mapped->dead_man;
  opened.lock = std::make_unique<hil::DeviceLock>(*mapped);
  opened.device =
      hil::open_guarded([&] { return hil::open_mapped_device(options.device, *mapped); }, guard_options_of(options));
  return opened;
}

Recording recording_of(const hil::LiveRun& run, const std::string& source) {
  Recording recording;
  recording.source = source;
  for (const auto& tick : run.ticks) {
    recording.motion.t_s.push_back(tick.t_s);
    recording.motion.p_W_m.push_back(tick.state.p_W_m);
    recording.f_W_N.push_back(tick.allowed_W_N);
  }
  return recording;
}

double quantile_of(std::vector<double> values, double share) {
  if (values.empty()) return std::numeric_limits<double>::quiet_NaN();
  const auto at = static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), values.begin() + at, values.end());
  return values[static_cast<std::size_t>(at)];
}

// What the run shows, in numbers.
struct LiveFigures {
  std::vector<double> late_ms, step_us;
  double largest_N = 0.0;
  double difference_N = 0.0;  // of the live renderer from its twin in the replay; infinite if one is not finite
};

LiveFigures figures_of(const hil::LiveRun& run, const RenderedTrajectory& replayed) {
  LiveFigures figures;
  for (std::size_t i = 0; i < run.ticks.size(); ++i) {
    const auto& tick = run.ticks[i];
    figures.late_ms.push_back(1e3 * tick.late_s);
    figures.step_us.push_back(tick.step_us);
    figures.largest_N = std::max(figures.largest_N, tick.wanted_W_N.norm());
    const double difference = (replayed.f_W_N[i] - tick.wanted_W_N).norm();
    figures.difference_N = std::max(figures.difference_N,
                                    std::isfinite(difference) ? difference : std::numeric_limits<double>::infinity());
  }
  return figures;
}

nlohmann::json to_json(const LiveRenderOptions& options, const hil::GuardedDevice& device, const hil::LiveRun& run,
                       const LiveFigures& figures, double start_s) {
  const auto& identity = device.identity();
  nlohmann::json json{{"schema", "touchstone-live/1"},
                      {"device", identity.id},
                      {"serial", identity.serial},
                      {"firmware", identity.firmware},
                      {"emulated", identity.emulated},
                      {"model_sha256", sha256_file(options.model)},
                      {"mesh_sha256", sha256_file(options.mesh)},
                      {"ticks", run.ticks.size()},
                      {"wanted_rate_Hz", options.rate_Hz},
                      {"rate_Hz", run.rate_Hz},
                      {"missed_deadlines", run.missed},
                      {"ticks_without_new_state", run.stale},
                      {"late_median_ms", quantile_of(figures.late_ms, 0.5)},
                      {"late_p99_ms", quantile_of(figures.late_ms, 0.99)},
                      {"late_max_ms", quantile_of(figures.late_ms, 1.0)},
                      {"step_median_us", quantile_of(figures.step_us, 0.5)},
                      {"step_p99_us", quantile_of(figures.step_us, 0.99)},
                      {"largest_force_N", figures.largest_N},
                      {"cut_by_guard", run.cut},
                      {"difference_from_replay_N", figures.difference_N},
                      {"trip", hil::to_string(device.tripped())},
                      {"ended", run.ended},
                      {"whole", run.whole},
                      {"guard", nlohmann::json::array()}};
  for (const auto& event : device.events()) {
    json["guard"].push_back({{"t_s", event.t_s - start_s},
                             {"state", hil::to_string(event.phase)},
                             {"reason", hil::to_string(event.reason)},
                             {"what", event.what}});
  }
  return json;
}

ExitStatus live_render(const LiveRenderOptions& options) {
  check(options);
  // The guard forks: before the stop signal's, the surface's and a plug-in's threads.
  const double start_s = hil::MonotonicClock().now_s();
  const OpenedDevice opened = open_device(options);
  hil::GuardedDevice& device = *opened.device;
  const auto& identity = device.identity();
  if (!identity.emulated && opened.dead_man.empty())
    throw UsageError(
        "--dead-man: no force is commanded on hardware without one (terminal, input:DEVICE, pipe:PATH, button:N)");
  hil::StopSignal stop;
  const Model model = load_model(options.model, options.plugins.load());
  const TriangleMesh mesh = options.meshes.load(options.mesh, options.mesh_unit);
  const std::shared_ptr<const Surface> surface = options.meshes.surface(mesh);
  const auto renderer = make_renderer(model, surface), twin = make_renderer(model, surface);
  options.meshes.warn(mesh, *surface);
  renderer->reset();
  const auto dead_man = opened.dead_man.empty() ? nullptr : hil::open_dead_man(opened.dead_man);
  if (dead_man) fmt::print(stderr, "--> {}, and keep it held; let go to stop\n", dead_man->instruction());
  hil::LiveOptions live;
  live.seconds = options.seconds;
  live.rate_Hz = options.rate_Hz;
  bool broken = false;
  auto run = hil::run_live(
      device, live, dead_man.get(), [&] { return broken || stop.asked(); },
      [&](const hil::DeviceState& state, double t_s) -> Vec3 {
        const StepResult result = renderer->step({t_s, state.p_W_m, Quat::Identity()});
        broken = broken || result.status != StepStatus::ok;
        return broken ? Vec3(Vec3::Zero()) : result.f_W_N;
      });
  if (broken) run.ended = fmt::format("the renderer failed: {}", renderer->failure());
  for (const auto& event : device.events()) {
    fmt::print(stderr, "guard {:+.3f} s  {:<12} {}{}\n", event.t_s - start_s, hil::to_string(event.phase), event.what,
               event.reason == hil::Trip::none ? "" : fmt::format(" [{}]", hil::to_string(event.reason)));
  }
  if (run.ticks.size() < 2) throw BadData(fmt::format("{}: nothing was rendered: {}", identity.id, run.ended));

  std::filesystem::create_directories(options.out);
  const std::filesystem::path folder = options.out;
  const Recording recording = recording_of(run, "live");
  save_recording(folder / "live.csv", recording);
  InTrajectory path;
  path.motion = recording.motion;
  const RenderedTrajectory replayed = replay(*twin, path);
  save_rendered(folder / "replayed.csv", replayed);
  const LiveFigures figures = figures_of(run, replayed);
  write_file(folder / "result.json", to_json(options, device, run, figures, start_s).dump(1) + "\n");
  const bool good = run.whole && figures.difference_N <= options.tolerance_N && device.tripped() == hil::Trip::none;
  fmt::print(
      "{}{} {}: {} ticks at {:.1f} Hz of {:.1f} Hz wanted, {} deadlines missed, late by {:.3f} ms (99 %), {:.3f} ms at "
      "worst\nlargest force {:.3g} N, {} ticks cut by the guard; {}\nlargest difference from a replay of the same path "
      "{:.3g} N -> {}\n",
      identity.emulated ? "emulated: " : "", identity.id, identity.serial, run.ticks.size(), run.rate_Hz,
      options.rate_Hz, run.missed, quantile_of(figures.late_ms, 0.99), quantile_of(figures.late_ms, 1.0),
      figures.largest_N, run.cut, run.ended, figures.difference_N, options.out);
  return good ? ExitStatus::passed : ExitStatus::failed;
}

}  // namespace

void add_hil_render(CLI::App& hil_command, Run& run) {
  auto* const command = hil_command.add_subcommand(
      "render", "Run a model live on a haptic device behind the guard, record it, and compare it with its own replay");
  auto options = std::make_shared<LiveRenderOptions>();
  command->add_option("--device", options->device, "The device: its id in the hardware map");
  command->add_option("--map", options->map, "Hardware map; default: the file that TOUCHSTONE_HARDWARE_MAP names");
  command->add_option("--device-plugin", options->device_plugin,
                      "The device: a shared library with the interface touchstone/device.h");
  command->add_option("--settings", options->settings, "Text for the device plug-in");
  command->add_option("--model", options->model, "Model file (touchstone-model/1)")->required();
  command->add_option("--mesh", options->mesh, "OBJ, OFF, PLY or STL, also .gz, in the device's frame")->required();
  command->add_option("--mesh-unit", options->mesh_unit, "Unit of the mesh's coordinates: m, mm, cm, km, um")
      ->capture_default_str();
  options->meshes.add_repair_to(*command);
  options->meshes.add_two_sided_to(*command);
  command->add_option("--force-limit", options->force_limit_N, "Largest force [N] that the guard lets pass")
      ->required();
  command->add_option("--power-limit", options->power_limit_W, "Power [W] given to the hand at which the guard lets go")
      ->capture_default_str();
  command
      ->add_option("--energy-limit", options->energy_limit_J,
                   "Energy [J] given to the hand, net over one contact, at which the guard lets go")
      ->capture_default_str();
  command
      ->add_option("--workspace", options->workspace_m, "Half the side [m] of the cube outside which the guard lets go")
      ->capture_default_str();
  command
      ->add_option("--command-age", options->command_age_ms, "Silence [ms] of the loop after which the guard lets go")
      ->capture_default_str();
  command->add_option("--dead-man", options->dead_man,
                      "What a person holds: terminal, input:DEVICE, pipe:PATH, button:N; default: the hardware map's. "
                      "Only emulated devices go without");
  command->add_option("--seconds", options->seconds, "Length of the run")->capture_default_str();
  command->add_option("--rate", options->rate_Hz, "Ticks per second")->capture_default_str();
  command->add_option("--tolerance", options->tolerance_N, "Largest difference [N] between live and replay")
      ->capture_default_str();
  command->add_option("--out", options->out, "Folder: live.csv (the recording), replayed.csv, result.json")->required();
  options->plugins.add_to(*command);
  command->footer(
      "Exit status: 0 it ran to its end and agrees with its replay, 1 the guard let go, it was stopped, or it "
      "disagrees.\n"
      "Examples:\n  touchstone hil render --device novint-falcon --map lab/hardware.json --model model.json --mesh "
      "plane.obj --force-limit 3 --out live\n  touchstone hil render --device-plugin ./libmine.so --model model.json "
      "--mesh plane.obj --force-limit 3 --dead-man terminal --out live");
  command->callback([options, &run] { run = [options] { return live_render(*options); }; });
}

}  // namespace touchstone::apps
