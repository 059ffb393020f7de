// What a search for missing effects is asked: its files and how they are read.
#pragma once

#include <cstdint>
#include <filesystem>
#include <limits>
#include <optional>
#include <string>
#include <vector>

namespace touchstone::plugin {
class Plugins;
}

namespace touchstone::pipeline {

struct DiscrepancyFiles {
  std::filesystem::path model;
  std::filesystem::path mesh;  // empty: the half-space below z = 0, for force against displacement
  std::string mesh_unit = "m";
  bool repair = false;      // turn triangles that are inside out (harness/surface/mesh_repair.h)
  bool flip_force = false;  // the files have the force BY the probe
  std::filesystem::path recording;
  std::filesystem::path holdout;               // empty: alternating blocks of `recording` are kept back
  double block_s = 2.0;                        // of the blocks kept back; a short recording has shorter ones
  std::filesystem::path repeat;                // the motion of `recording` recorded again; empty: none
  std::optional<double> tolerance_N;           // a held-out error that is good enough
  bool unnoticed_passes = false;               // one that a fingertip does not notice is good enough
  std::filesystem::path instrument;            // empty: the noise is estimated
  std::vector<std::filesystem::path> effects;  // files of effects that are searched beside the catalogue's
  // Measured positions enter a compliant object as they stand; on a rigid one the in-trajectory is made from the
  // out-trajectory and the force (Ruffaldi et al. 2006, equation 2).
  bool synthesize_in_trajectory = false;
  std::filesystem::path out;
  std::filesystem::path golden;  // where a golden case of the result is to be made; empty: none
  std::uint64_t seed = 1;
  double time_limit_s = std::numeric_limits<double>::infinity();  // beyond it the search tries nothing new
  const plugin::Plugins* plugins = nullptr;                       // where the model's renderer may come from one
  std::vector<std::string> command_line;                          // for the report
  // The program `touchstone`, which runs the written model once more and has nothing of this process; empty: this
  // process reads the files once more.
  std::filesystem::path program;
};

}  // namespace touchstone::pipeline
