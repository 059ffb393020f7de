// A renderer live on a haptic device, judged by its own replay: while a person moves the handle, the renderer answers
// each state with a force; afterwards a twin of it renders the recorded path without any device, and must answer the
// same. What a replay says of a renderer then holds for the device, too.
//   Positions and forces are in the device's frame, which is the frame of the renderer's surface. The force is on the
// handle, which is the virtual probe: by the surface, in N. Times are in s since the run began.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "harness/recording/trajectory.h"
#include "harness/rendering/renderer.h"
#include "lab/live_loop.h"

namespace touchstone::hil {

// What the guard (guardian.h) is to allow a live renderer.
struct LiveLimits {
  double force_N = 0.0;         // largest force; nothing passes at 0
  double workspace_m = 0.2;     // half the side of the cube about the device's origin
  double command_age_s = 0.01;  // silence of the loop
  double power_W = usual_power_W;
  double energy_J = usual_energy_J;
};

// The guard's options for a loop at `rate_Hz`: from nothing to the largest force within ten ticks. Who is more patient
// with the loop than usual is as patient with driver and guard.
[[nodiscard]] GuardOptions live_guard(const LiveLimits& limits, double rate_Hz);

// What a run shows, in numbers. The vectors have an element a tick.
struct LiveFigures {
  std::vector<double> late_ms, step_us;
  double largest_N = 0.0;     // that the renderer wanted
  double difference_N = 0.0;  // of the live renderer from its twin; infinite if one of the two is not finite
};

struct LiveRendering {
  LiveRun run;
  recording::Recording recording;          // where the handle was, and the force that the guard let pass
  recording::RenderedTrajectory replayed;  // by the twin, over the same path
  LiveFigures figures;
  Trip tripped = Trip::none;  // why the guard let go, if it did

  // It ran to its end, the guard did not let go, and live and replay differ by no more than `tolerance_N`.
  [[nodiscard]] bool agrees(double tolerance_N) const;
};

// Runs `renderer` as run_live() does. A step that fails ends the run at zero force, with the reason in `run.ended`.
[[nodiscard]] LiveRun run_renderer(GuardedDevice& device, const LiveOptions& options, DeadMan* dead_man,
                                   const std::function<bool()>& stop, rendering::Renderer& renderer);

// Where the handle was, and the force that the guard let pass. To be saved before anything else: the twin is a renderer
// of others, whose end must not take the recording with it.
[[nodiscard]] recording::Recording recording_of(const LiveRun& run);

// Replays the run by `twin`, made like the renderer that ran. Throws BadData if the twin cannot render the path.
[[nodiscard]] LiveRendering compare_with_replay(LiveRun run, rendering::Renderer& twin, Trip tripped);

// What names the run in its result.
struct LiveProvenance {
  std::string model_sha256, mesh_sha256;
  double wanted_rate_Hz = 0.0;
  double start_s = 0.0;  // of the guard's clock: its events are told from there
};
// Schema "touchstone-live/1" (docs/reference).
[[nodiscard]] std::string live_to_json(const LiveRendering& live, const GuardedDevice& device,
                                       const LiveProvenance& provenance);

// For people: how the loop kept its time, what the guard cut, and how far live and replay are apart. Without a line's
// end.
[[nodiscard]] std::string live_text(const LiveRendering& live, const DeviceIdentity& identity, double wanted_rate_Hz);

}  // namespace touchstone::hil
