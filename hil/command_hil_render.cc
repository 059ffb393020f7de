#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <memory>

#include "apps/mesh_flags.h"
#include "apps/plugin_flags.h"
#include "drivers/open_mapped.h"
#include "drivers/plugin_device.h"
#include "harness/base/atomic_file.h"
#include "harness/base/hash.h"
#include "harness/recording/recording_file.h"
#include "hil_commands.h"
#include "lab/live_rendering.h"
#include "record/device_recording.h"
#include "renderers/catalogue.h"
#include "safety/stop_signal.h"

namespace touchstone::hil {
namespace {

struct LiveRenderOptions {
  std::string device, map, device_plugin, settings, model, mesh, mesh_unit = "m", out, dead_man;
  double seconds = 10.0, rate_Hz = 1000.0, force_limit_N = 0.0, workspace_m = 0.2, command_age_ms = 10.0;
  double power_limit_W = usual_power_W, energy_limit_J = usual_energy_J;
  double tolerance_N = 1e-9;
  apps::MeshFlags meshes;
  apps::PluginFlags plugins;
};

void check(const LiveRenderOptions& options) {
  if (options.device.empty() == options.device_plugin.empty())
    throw UsageError("either --device (of the hardware map) or --device-plugin must be given");
  const std::pair<double, const char*> positive[] = {{options.force_limit_N, "--force-limit"},
                                                     {options.rate_Hz, "--rate"},
                                                     {options.seconds, "--seconds"},
                                                     {options.workspace_m, "--workspace"},
                                                     {options.command_age_ms, "--command-age"},
                                                     {options.power_limit_W, "--power-limit"},
                                                     {options.energy_limit_J, "--energy-limit"}};
  for (const auto& [value, name] : positive) {
    if (!(value > 0.0) || !std::isfinite(value))
      throw UsageError(fmt::format("{}: {} is no finite number above 0", name, value));
  }
  if (!(options.tolerance_N >= 0.0) || !std::isfinite(options.tolerance_N))
    throw UsageError(fmt::format("--tolerance: {} N is no finite number from 0 on", options.tolerance_N));
  // A program that hangs leaves its last force on for so long.
  constexpr double longest_age_ms = 10000.0;
  if (options.command_age_ms > longest_age_ms)
    throw UsageError(fmt::format("--command-age: {} ms is more than {} ms", options.command_age_ms, longest_age_ms));
  // Each tick is kept, about 200 bytes: so many are 2 GB, an hour at 2.8 kHz.
  constexpr double most_ticks = 1e7;
  if (options.seconds * options.rate_Hz > most_ticks) {
    throw UsageError(fmt::format("--seconds {} at --rate {} are {:.3g} ticks, more than {:.0g}: shorten the run",
                                 options.seconds, options.rate_Hz, options.seconds * options.rate_Hz, most_ticks));
  }
}

GuardOptions guard_options_of(const LiveRenderOptions& options) {
  return live_guard({options.force_limit_N, options.workspace_m, 1e-3 * options.command_age_ms, options.power_limit_W,
                     options.energy_limit_J},
                    options.rate_Hz);
}

struct OpenedDevice {
  std::unique_ptr<GuardedDevice> device;
  std::string dead_man;
};

OpenedDevice open_device(const LiveRenderOptions& options) {
  OpenedDevice opened;
  opened.dead_man = options.dead_man;
  if (!options.device_plugin.empty()) {
    opened.device = open_guarded([library = options.device_plugin,
                                  settings = options.settings] { return open_plugin_device(library, settings); },
                                 guard_options_of(options));
    return opened;
  }
  const auto map = hardware_map_from(options.map);
  const auto& mapped = usable_device(options.device, map);
  if (!(options.force_limit_N <= mapped.force_limit_N)) {
    throw UsageError(fmt::format("--force-limit: {} N is more than the {} N that the hardware map allows {}",
                                 options.force_limit_N, mapped.force_limit_N, options.device));
  }
  if (opened.dead_man.empty()) opened.dead_man = mapped.dead_man;
  opened.device = open_guarded([mapped] { return open_handle(mapped); }, guard_options_of(options));
  return opened;
}

ExitStatus live_render(const LiveRenderOptions& options) {
  check(options);
  // The guard forks: before the stop signal's, the surface's and a plug-in's threads.
  const double start_s = MonotonicClock().now_s();
  const OpenedDevice opened = open_device(options);
  GuardedDevice& device = *opened.device;
  // Time within which a rescue is not noticed as one.
  constexpr double quick_s = 0.02;
  if (device.open_took_s() > quick_s)
    fmt::print(stderr, "{} takes {:.2f} s to open: if its driver dies while it pushes, zero comes that much later\n",
               device.identity().id, device.open_took_s());
  const auto& identity = device.identity();
  if (!identity.emulated && opened.dead_man.empty())
    throw UsageError(
        "--dead-man: no force is commanded on hardware without one (terminal, input:DEVICE, pipe:PATH, button:N)");
  StopSignal stop;
  const rendering::Model model = apps::load_model(options.model, options.plugins.load());
  const surface::TriangleMesh mesh = options.meshes.load(options.mesh, options.mesh_unit);
  const std::shared_ptr<const surface::Surface> surface = options.meshes.surface(mesh);
  const auto renderer = renderers::make_renderer(model, surface), twin = renderers::make_renderer(model, surface);
  options.meshes.warn(mesh, *surface);
  const auto dead_man = opened.dead_man.empty() ? nullptr : open_dead_man(opened.dead_man);
  if (dead_man) fmt::print(stderr, "--> {}, and keep it held; let go to stop\n", dead_man->instruction());
  LiveOptions loop;
  loop.seconds = options.seconds;
  loop.rate_Hz = options.rate_Hz;
  loop.tell = [](const std::string& text) { fmt::print(stderr, "--> {}\n", text); };
  LiveRun run = run_renderer(
      device, loop, dead_man.get(), [&] { return stop.asked(); }, *renderer);
  // Whoever stopped the run may not know yet that the force stayed on: a signal after that counts.
  StopSignal acted;
  const bool at_zero = wait_for_zero(device, [&] { return acted.asked(); });
  for (const auto& event : device.events()) {
    fmt::print(stderr, "guard {:+.3f} s  {:<12} {}{}{}\n", event.t_s - start_s, to_string(event.phase), event.what,
               event.reason == Trip::none ? "" : fmt::format(" [{}]", to_string(event.reason)),
               event.times > 1 ? fmt::format(" ({} times)", event.times) : "");
  }
  if (!at_zero) fmt::print(stderr, "{}\n", switch_text(device));
  if (run.ticks.size() < 2) throw BadData(fmt::format("{}: nothing was rendered: {}", identity.id, run.ended));

  const std::filesystem::path folder = options.out;
  ensure_writable_folder(folder);
  save_recording(folder / "live.csv", recording_of(run));
  const LiveRendering live = compare_with_replay(std::move(run), *twin, device.tripped());
  save_rendered(folder / "replayed.csv", live.replayed);
  write_file(
      folder / "result.json",
      live_to_json(live, device, {sha256_file(options.model), sha256_file(options.mesh), options.rate_Hz, start_s}));
  fmt::print("{} -> {}\n", live_text(live, identity, options.rate_Hz), options.out);
  return live.agrees(options.tolerance_N) ? ExitStatus::passed : ExitStatus::failed;
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
  command->add_option("--mesh-unit", options->mesh_unit, "Unit of the mesh's coordinates: m, mm, cm, km, um, in, ft")
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

}  // namespace touchstone::hil
