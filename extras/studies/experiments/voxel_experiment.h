// The first experiment of Ruffaldi et al. 2006 (section 4.1, table 1): the proxy (god-object) against a voxel grid of
// 32^3 and 64^3 voxels, on one in-trajectory: force error, floating-point operations, initialisation time, memory.
//
// Their duck and its scan are not to be had; the body here is the duck-like one of synthetic/, scanned by a simulated
// point probe with friction and the instruments of their section 2, and the in-trajectory is made from what the
// instruments saw (equation 2). Findings are compared, never digits.
//
// The probe is a point, because a voxel renderer renders one. Two errors: against the measured forces, as in the table
// (most of it is the friction that no renderer here has), and against the frictionless answer on the smooth body to the
// same positions, which leaves the renderer's own part and the mesh's.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "harness/rendering/operations.h"
#include "harness/rendering/replay.h"

namespace touchstone::experiments {

struct VoxelExperimentOptions {
  std::uint64_t seed = 1;
  std::size_t triangles = 20000;
  std::vector<int> resolutions{16, 32, 64, 128};
  double reach_m = 0.010;  // how deep voxels push; deeper than any sample of the scan
};

struct VoxelRow {
  std::string renderer;    // "god-object", "voxel", "voxel-sparse"
  int resolution = 0;      // 0: no grid
  double rms_N = 0.0;      // of |f - f_measured| over all samples
  double mean_N = 0.0;     // the paper's equation 3 as printed
  double own_rms_N = 0.0;  // of |f - f_exact|
  std::optional<rendering::OperationReport> operations;
  rendering::ReplayTiming timing;  // build_ms of the renderer's own structures; the surface's are made before
  std::vector<Vec3> f_W_N;
};
// NaN where it is not known.
double memory_MB(const VoxelRow& row);

struct VoxelFinding {
  std::string statement;  // of the paper
  bool holds = false;
  std::string here;  // what was found
};

struct VoxelExperiment {
  VoxelExperimentOptions options;
  std::size_t samples = 0;
  std::size_t in_contact = 0;
  double deepest_m = 0.0;
  double surface_build_ms = 0.0;
  double rms_measured_N = 0.0;
  std::vector<double> t_s;
  std::vector<Vec3> measured_W_N;
  std::vector<VoxelRow> rows;  // the god-object first
  std::vector<VoxelFinding> findings;

  [[nodiscard]] const VoxelRow* find(const std::string& renderer, int resolution) const;
};

struct PublishedVoxelRow {
  const char* algorithm;
  int resolution;  // 0: no grid
  double rms_N;
  double operations;
  double init_s;
  double memory_MB;
};
// Table 1 of the paper.
const std::vector<PublishedVoxelRow>& published_voxel_table();

using ExperimentProgress = std::function<void(std::size_t done, std::size_t all)>;
// Resolutions must hold 32 and 64, which the findings are about.
VoxelExperiment run_voxel_experiment(const VoxelExperimentOptions& options, const ExperimentProgress& progress = {});

// Of rows that have the god-object and 32^3 and 64^3 voxels; the statements do not depend on the numbers.
std::vector<VoxelFinding> voxel_findings(const VoxelExperiment& experiment);
inline constexpr std::size_t timed_voxel_finding = 6;  // the one about preprocessing rests on times

// Ours and the paper's beside it; the findings.
std::string voxel_table(const VoxelExperiment& experiment);
std::string voxel_experiment_to_json(const VoxelExperiment& experiment);

// The same in two parts, to be kept and read back: what is the same in every run, with the series that the report draws
// where `series`, and the times, which are not.
std::string voxel_document(const VoxelExperiment& experiment, bool series);
std::string voxel_times(const VoxelExperiment& experiment);
// Throws BadData for other text.
VoxelExperiment voxel_from(const std::string& document, const std::string& times);

}  // namespace touchstone::experiments
