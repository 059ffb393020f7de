// One renderer over positions as they are: one step per sample, as a servo loop would call it. Streams, so that the
// number of samples is not bounded by memory.
#pragma once

#include <functional>
#include <optional>
#include <string>

#include "harness/recording/trajectory.h"
#include "harness/rendering/renderer.h"

namespace touchstone::rendering {

// Fills the next sample, or returns false at the end.
using TipSource = std::function<bool(TipState&)>;
// Takes what the renderer made of a sample. cost_us is the time of that step alone, NaN where steps are not timed.
using StepSink = std::function<void(const TipState&, const StepResult&, double cost_us)>;

// The cost of the renderer's steps alone, without reading and writing.
struct ReplayTiming {
  std::uint64_t steps = 0;
  double mean_us = 0.0;    // from whole blocks of steps between two clock readings: the clock's cost is not in it
  double median_us = 0.0;  // the rest from single steps, the clock's own cost (measured) taken off
  double p99_us = 0.0;
  double p999_us = 0.0;  // 99.9th percentile: what one step in a thousand takes, once a second at 1 kHz
  double max_us = 0.0;
  double build_ms = 0.0;                    // making the renderer and the surface's structures; filled by the caller
  std::optional<std::size_t> memory_bytes;  // Renderer::memory_bytes()
};

// Resets the renderer and replays. Returns the number of samples. Throws BadData naming the sample when the renderer
// refuses it or answers with a number that is not finite. With `time_steps` each step is timed alone.
std::uint64_t replay(Renderer& renderer, const TipSource& source, const StepSink& sink, bool time_steps = false);
recording::RenderedTrajectory replay(Renderer& renderer, const recording::InTrajectory& trajectory,
                                     bool time_steps = false);

// Replays twice: once timing whole blocks (mean), once every step (quantiles). `open` gives the same samples each time.
ReplayTiming measure_steps(Renderer& renderer, const std::function<TipSource()>& open);

// A source over a trajectory in memory, which must outlive it. Orientations where they were recorded, else identity.
TipSource tip_source(const MotionColumns& motion);

// {"steps", "mean_us", "median_us", "p99_us", "max_us", "build_ms", "memory_bytes", "operations"}; `operations` is what
// operations_to_json() made, or "null".
std::string timing_to_json(const ReplayTiming& timing, const std::string& operations = "null");

}  // namespace touchstone::rendering
