#include "lab/live_rendering.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "harness/rendering/replay.h"
#include "harness/stats/quantile.h"

namespace touchstone::hil {
namespace {

LiveFigures figures_of(const LiveRun& run, const recording::RenderedTrajectory& replayed) {
  LiveFigures figures;
  for (std::size_t i = 0; i < run.ticks.size(); ++i) {
    const LiveTick& tick = run.ticks[i];
    figures.late_ms.push_back(1e3 * tick.late_s);
    figures.step_us.push_back(tick.step_us);
    const double wanted_N = tick.wanted_W_N.norm();
    figures.largest_N =
        std::max(figures.largest_N, std::isfinite(wanted_N) ? wanted_N : std::numeric_limits<double>::infinity());
    const double difference = (replayed.f_W_N[i] - tick.wanted_W_N).norm();
    figures.difference_N = std::max(figures.difference_N,
                                    std::isfinite(difference) ? difference : std::numeric_limits<double>::infinity());
  }
  return figures;
}

}  // namespace

GuardOptions live_guard(const LiveLimits& limits, double rate_Hz) {
  GuardOptions guard;
  guard.limits.force_N = limits.force_N;
  guard.limits.slew_N_per_s = limits.force_N * rate_Hz / 10.0;
  guard.limits.workspace_W_m = Box3(Vec3::Constant(-limits.workspace_m), Vec3::Constant(limits.workspace_m));
  guard.limits.power_W = limits.power_W;
  guard.limits.energy_J = limits.energy_J;
  guard.limits.stale_s = limits.command_age_s;
  guard.driver_timeout_s = std::max(guard.driver_timeout_s, 0.6 * guard.limits.stale_s);
  guard.watchdog_s = std::max(guard.watchdog_s, 0.8 * guard.limits.stale_s);
  return guard;
}

bool LiveRendering::agrees(double tolerance_N) const {
  return run.whole && figures.difference_N <= tolerance_N && tripped == Trip::none;
}

LiveRun run_renderer(GuardedDevice& device, const LiveOptions& options, DeadMan* dead_man,
                     const std::function<bool()>& stop, rendering::Renderer& renderer) {
  renderer.reset();
  bool broken = false;
  LiveRun run = run_live(
      device, options, dead_man, [&] { return broken || stop(); },
      [&](const DeviceState& state, double t_s) -> Vec3 {
        const rendering::StepResult result = renderer.step({t_s, state.p_W_m, Quat::Identity()});
        broken = broken || result.status != rendering::StepStatus::ok;
        return broken ? Vec3(Vec3::Zero()) : result.f_W_N;
      });
  if (broken) run.ended = fmt::format("the renderer failed: {}", renderer.failure());
  return run;
}

recording::Recording recording_of(const LiveRun& run) {
  recording::Recording recording;
  recording.source = "live";
  for (const LiveTick& tick : run.ticks) {
    recording.motion.t_s.push_back(tick.t_s);
    recording.motion.p_W_m.push_back(tick.state.p_W_m);
    recording.f_W_N.push_back(tick.allowed_W_N);
  }
  return recording;
}

LiveRendering compare_with_replay(LiveRun run, rendering::Renderer& twin, Trip tripped) {
  LiveRendering live;
  live.run = std::move(run);
  live.tripped = tripped;
  live.recording = recording_of(live.run);
  recording::InTrajectory path;
  path.motion = live.recording.motion;
  live.replayed = rendering::replay(twin, path);
  live.figures = figures_of(live.run, live.replayed);
  return live;
}

std::string live_to_json(const LiveRendering& live, const GuardedDevice& device, const LiveProvenance& provenance) {
  const auto& identity = device.identity();
  const auto late_ms = [&](double share) { return stats::lower_quantile(live.figures.late_ms, share); };
  const auto step_us = [&](double share) { return stats::lower_quantile(live.figures.step_us, share); };
  nlohmann::json json{{"schema", "touchstone-live/1"},
                      {"device", identity.id},
                      {"serial", identity.serial},
                      {"firmware", identity.firmware},
                      {"emulated", identity.emulated},
                      {"model_sha256", provenance.model_sha256},
                      {"mesh_sha256", provenance.mesh_sha256},
                      {"ticks", live.run.ticks.size()},
                      {"wanted_rate_Hz", provenance.wanted_rate_Hz},
                      {"rate_Hz", live.run.rate_Hz},
                      {"missed_deadlines", live.run.missed},
                      {"ticks_without_new_state", live.run.stale},
                      {"late_median_ms", late_ms(0.5)},
                      {"late_p99_ms", late_ms(0.99)},
                      {"late_max_ms", late_ms(1.0)},
                      {"step_median_us", step_us(0.5)},
                      {"step_p99_us", step_us(0.99)},
                      {"largest_force_N", live.figures.largest_N},
                      {"cut_by_guard", live.run.cut},
                      {"difference_from_replay_N", live.figures.difference_N},
                      {"trip", to_string(live.tripped)},
                      {"zero_confirmed", device.at_zero()},
                      {"device_open_s", device.open_took_s()},
                      {"ended", live.run.ended},
                      {"whole", live.run.whole},
                      {"guard", nlohmann::json::array()}};
  // JSON has no infinity and writes null: which figures were no finite number is said.
  std::vector<std::string> not_finite;
  for (const auto& [key, value] : json.items()) {
    if (value.is_number_float() && !std::isfinite(value.get<double>())) not_finite.push_back(key);
  }
  json["not_finite"] = not_finite;
  for (const auto& event : device.events()) {
    json["guard"].push_back({{"t_s", event.t_s - provenance.start_s},
                             {"state", to_string(event.phase)},
                             {"reason", to_string(event.reason)},
                             {"what", event.what},
                             {"times", event.times}});
  }
  return json.dump(1) + "\n";
}

std::string live_text(const LiveRendering& live, const DeviceIdentity& identity, double wanted_rate_Hz) {
  return fmt::format(
      "{}{} {}: {} ticks at {:.1f} Hz of {:.1f} Hz wanted, {} deadlines missed, late by {:.3f} ms (99 %), {:.3f} ms at "
      "worst\nlargest force {:.3g} N, {} ticks cut by the guard; {}\nlargest difference from a replay of the same path "
      "{:.3g} N",
      identity.emulated ? "emulated: " : "", identity.id, identity.serial, live.run.ticks.size(), live.run.rate_Hz,
      wanted_rate_Hz, live.run.missed, stats::lower_quantile(live.figures.late_ms, 0.99),
      stats::lower_quantile(live.figures.late_ms, 1.0), live.figures.largest_N, live.run.cut, live.run.ended,
      live.figures.difference_N);
}

}  // namespace touchstone::hil
