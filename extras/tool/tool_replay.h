// A renderer of a tool over a recorded or scripted way of its handle, file to file in bounded memory.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "harness/tool/tool_renderer.h"

namespace touchstone::tool {

struct ToolReplaySummary {
  std::uint64_t samples = 0;
  std::uint64_t in_contact = 0;
  std::uint64_t contacts = 0;  // written
  double largest_force_N = 0.0;
  double largest_torque_Nm = 0.0;
};

struct ToolReplayFiles {
  std::filesystem::path path;  // in: t_s, x_m, y_m, z_m, qw, qx, qy, qz: the handle's poses
  std::filesystem::path out;   // those columns and fx_N.., tx_Nm.. (about the handle, axes of W), contact
  std::optional<std::filesystem::path> proxy;  // out: the proxy's poses, columns as in `path`
  std::uint64_t keep_every = 1;                // of the samples, all are rendered and each keep_every-th is written
  // Out: the contacts of the written samples, a row each: t_s, px_m.. (where), nx.. (unit, out of the object) and
  // fx_N.. (on the tool), axes of W.
  std::optional<std::filesystem::path> contacts = {};
};

// One step per sample, from a reset renderer. Throws BadData for a path without orientation, RendererFailed for a
// renderer that breaks down.
ToolReplaySummary replay_tool(ToolRenderer& renderer, const ToolReplayFiles& files);

// The time of each step of one replay, ascending, in microseconds.
std::vector<double> measure_tool_steps(ToolRenderer& renderer, const std::filesystem::path& path);

// What those times say: {"steps", "median_us", "p99_us", "p999_us", "max_us", "memory_bytes"}, and a line for people.
std::string step_times_to_json(const std::vector<double>& ascending_us, std::optional<std::size_t> memory_bytes);
std::string step_times_to_text(const std::vector<double>& ascending_us);

}  // namespace touchstone::tool
