// A renderer over a recorded path from file to file, in memory that does not grow with the length of the recording.
#pragma once

#include <filesystem>
#include <string>

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

// {"samples", "in_contact", "largest_force_N", "deepest_m"}
std::string summary_to_json(const ReplaySummary& summary);
// The same for people, and where the rendered file is.
std::string summary_text(const ReplaySummary& summary, const std::filesystem::path& out);

// A source over a file of positions. The stream must outlive it.
TipSource tip_source(recording::RecordingStream& stream);

// Replays `in` through the renderer and writes the rendered file `out` (RenderedWriter), which appears whole or not at
// all.
ReplaySummary replay_file(Renderer& renderer, const std::filesystem::path& in, const std::filesystem::path& out);

// The cost of the steps over the positions of the file, see measure_steps().
ReplayTiming measure_steps(Renderer& renderer, const std::filesystem::path& in);

// The operations of the steps over the positions of the file, see operations.h.
OperationReport count_operations(Renderer& counted, const std::filesystem::path& in);

// For people, a line each: what a step takes, and of how many operations it is.
std::string timing_text(const ReplayTiming& timing);
std::string operations_text(const OperationReport& report);

}  // namespace touchstone::rendering
