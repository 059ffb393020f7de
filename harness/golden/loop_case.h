// Golden cases that close a loop: the program touchstone-loop (extras/loop) runs hand, device and renderer, and gives
// the device's path, the commanded force and what they come to.
//
// What is compared follows how far a loop repeats. A stable one forgets: its path and force are compared sample by
// sample, as those of a replay. One that buzzes or throws the hand out amplifies rounding until no sample repeats: of
// it the band of the vibration (a third of an octave about the golden's frequency) and its strength (less than one just
// noticeable difference) are compared. The margin is found to 3 %, so it may be 6 % off. Another verdict is never
// equal.
#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "harness/golden/golden_case.h"
#include "harness/golden/golden_file.h"
#include "harness/recording/trajectory.h"
#include "harness/rendering/model.h"
#include "harness/surface/triangle_mesh.h"

namespace touchstone::golden {

struct LoopFigures {
  std::string verdict;  // "stable", "buzzes", "unstable" or "cannot tell"
  double stable_margin = 0.0;
  double buzz_Hz = 0.0, buzz_N = 0.0, buzz_jnd = 0.0;
  double energy_J = 0.0;

  // Whether its samples repeat.
  [[nodiscard]] bool repeats() const { return verdict == "stable"; }
};

// As attributes of a golden. Reading throws BadData where one is missing.
void add_to(Provenance& provenance, const LoopFigures& figures);
LoopFigures loop_figures_of(const Provenance& provenance, const std::string& source);

struct LoopRun {
  recording::RenderedTrajectory rendered;
  LoopFigures figures;
};

// Throws BadData where `program` is empty (the extra is not installed), ends with an error, or cannot judge the loop:
// it lasts too short, the device's mass is not known, or the renderer is too slow.
LoopRun run_loop_program(const std::filesystem::path& program, const GoldenCase& golden,
                         const surface::TriangleMesh& mesh, const recording::InTrajectory& trajectory,
                         rendering::Model model);

// A sentence for each figure that is not the golden's.
std::vector<std::string> loop_differences(const LoopFigures& golden, const LoopFigures& obtained);

// stable_margin, buzz_N and energy_J.
std::vector<std::pair<std::string, double>> metrics_of(const LoopFigures& figures);

}  // namespace touchstone::golden
