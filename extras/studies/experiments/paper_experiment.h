// The four experiments of Ruffaldi et al. 2006 (section 4) on any recording, with one definition for all of them, as
// the paper has it: "these analyses have all been performed using the same model and input trajectory".
//  - Tip: a point ("a single point of contact"); of a ball it is the point where it touched.
//  - Input: one in-trajectory over the mesh as it is given, by default equation 2.
//  - Error: the root mean square of |rendered - recorded| over all samples of the out-trajectory, which the paper calls
//    "RMS Force Error" (its equation 3 is printed as a mean; `average` gives that).
//  - Experiments 3 and 4 also show the error against the normal part of the recorded force, from which equation 2 makes
//    the input: the paper's 0.009 N at its finest mesh are far below what friction alone leaves (0.132 N in its table
//    2).
//  - Floors: what the law that is right (a proxy with the data set's friction, or the fitted one) scores on this input
//    by the same definition, with the instruments' noise and this mesh (input_floor.h).
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "experiments/friction_experiment.h"
#include "harness/pipeline/evaluation/input_floor.h"
#include "harness/recording/dataset.h"
#include "harness/recording/trajectory.h"
#include "harness/rendering/operations.h"
#include "harness/surface/surface.h"

namespace touchstone::experiments {

enum class Average : std::uint8_t { rms, mean };
enum class Counted : std::uint8_t { all, contact };  // samples

struct PaperOptions {
  Average average = Average::rms;
  Counted counted = Counted::all;
  recording::InTrajectoryMode in_trajectory = recording::InTrajectoryMode::synthesize;
  double contact_threshold_N = 0.05;
  double reach_m = 0.010;  // of voxels; deeper than a press
};

struct PaperScan {
  std::string name;
  recording::Recording recording;  // force ON the probe
  surface::TriangleMesh mesh;
  double stiffness_N_per_m = 0.0;
  // For the floors: "" estimates the noise from the recording; without a coefficient the fitted one is taken.
  std::filesystem::path instrument = {};
  std::optional<double> friction = {};
  double probe_radius_m = 0.0;  // of the ball that made the recording; for the floors
};

// What the right law scores: see input_floor.h.
struct PaperFloors {
  pipeline::Floor all;          // of experiments 1, 3 and 4
  pipeline::Floor second_half;  // of experiment 2
  pipeline::Floor normal_part;  // of the right law without friction, against the normal part
};

struct PaperRow {
  std::string renderer;
  double error_N = 0.0;
  std::optional<rendering::OperationReport> operations;
  double build_ms = 0.0;
  std::size_t memory_bytes = 0;
};

struct PaperDensity {
  std::size_t triangles = 0;
  double plain_N = 0.0, shaded_N = 0.0;                // against the recorded force
  double plain_normal_N = 0.0, shaded_normal_N = 0.0;  // against its normal part
};

struct JudgedFinding {
  std::string statement;
  std::optional<bool> holds;  // empty: this scan cannot say
  std::string here;           // the numbers that say so, or why there are none
};

struct PaperResult {
  std::string scan;
  double measured_N = 0.0;               // the recorded force by the same average
  std::vector<PaperRow> voxel;           // proxy, 32^3, 64^3
  double fitted_mu = 0.0;                // on the first half
  double without_N = 0.0, with_N = 0.0;  // on the second half
  std::vector<PaperDensity> density;     // from coarse to fine; of an open mesh itself alone
  PaperFloors floors;
  std::vector<JudgedFinding> findings;  // the same statements for every scan, in the same order
};

// An open mesh is not decimated: its border would move, and the probe slip off. Throws BadData where the mesh cannot be
// decimated, or no sample touches.
PaperResult run_paper_experiments(const PaperScan& scan, const PaperOptions& options);

// Which finding holds by the figures of the result, and why.
std::vector<JudgedFinding> paper_findings(const PaperResult& result);

// The tables, and which finding holds on which scan.
std::string paper_text(const std::vector<PaperResult>& results);
std::string paper_to_json(const std::vector<PaperResult>& results, const PaperOptions& options);

}  // namespace touchstone::experiments
