// Replay from file to file in bounded memory.
#pragma once

#include <filesystem>

#include "harness/base/rooms.h"
#include "harness/recording/recording_stream.h"
#include "harness/rendering/operations.h"
#include "harness/rendering/replay.h"

namespace touchstone::rendering {

struct ReplaySummary {
  std::uint64_t samples = 0;
  std::uint64_t in_contact = 0;
  double largest_force_N = 0.0;
  double deepest_m = 0.0;
};

// A source over a file of positions. The stream must outlive it.
TipSource tip_source(RecordingStream& stream);

// Replays `in` through the renderer and writes the rendered file `out` (RenderedWriter), which appears whole or not at
// all.
ReplaySummary replay_file(Renderer& renderer, const std::filesystem::path& in, const std::filesystem::path& out);

// The cost of the steps over the positions of the file, see measure_steps().
ReplayTiming measure_steps(Renderer& renderer, const std::filesystem::path& in);

// The operations of the steps over the positions of the file, see operations.h.
OperationReport count_operations(Renderer& counted, const std::filesystem::path& in);

}  // namespace touchstone::rendering
