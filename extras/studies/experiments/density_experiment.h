// Experiments 3 and 4 of Ruffaldi et al. 2006 (sections 4.3 and 4.4, table 3 and figure 7): the force error of the
// proxy over one body at eight densities of its mesh, without and with force shading.
//
// The in-trajectory is made once, over the finest mesh, and rendered over each. The error is against the normal part of
// the recorded force, from which the in-trajectory was made: the paper's errors at its finest mesh (0.009 N) are far
// below what friction alone leaves (0.132 N in its table 2), so that theirs cannot be against the whole force either.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "experiments/friction_experiment.h"
#include "harness/rendering/operations.h"

namespace touchstone::experiments {

struct PublishedDensity {
  double kilo_triangles, flops, error_N, relative;
};
// Table 3.
inline constexpr std::array<PublishedDensity, 8> published_density{{{0.2, 9.7136e6, 0.085, 9.92},
                                                                    {0.5, 10.361e6, 0.031, 3.55},
                                                                    {1, 9.7921e6, 0.031, 3.61},
                                                                    {3, 10.380e6, 0.022, 2.61},
                                                                    {6, 10.560e6, 0.022, 2.61},
                                                                    {9, 10.644e6, 0.015, 1.80},
                                                                    {64, 10.064e6, 0.013, 1.51},
                                                                    {140, 9.2452e6, 0.009, 1.00}}};

struct DensityPoint {
  std::size_t triangles = 0;
  ForceError plain, shaded;          // against the normal part
  ForceError plain_all, shaded_all;  // against the whole recorded force
  // Of the god-object without shading, a ball.
  std::optional<rendering::OperationReport> operations;
};

struct DensityExperiment {
  std::uint64_t seed;
  std::vector<DensityPoint> points;  // from coarse to fine, as published_density
};

// The sizes of its meshes, from coarse to fine.
std::vector<std::size_t> density_triangles();
DensityExperiment run_density_experiment(std::uint64_t seed);
std::vector<PaperFinding> density_findings(const DensityExperiment& experiment);
std::vector<PaperFinding> shading_findings(const DensityExperiment& experiment);

}  // namespace touchstone::experiments
