// The perceptual evaluation on a real raster of presses: do two neighbouring rows of the same object lie nearer to each
// other than a row does to what a renderer without the right effects makes of the other row's motion?
#pragma once

#include <cstddef>
#include <vector>

#include "harness/perception/perceptual_evaluation.h"
#include "harness/recording/trajectory.h"

namespace touchstone::experiments {

struct RasterRow {
  std::size_t first;  // sample of its first deepest point
  std::size_t end;    // one past that of its last
};

// Rows of a raster along x with at least `presses` presses in the direction of growing x, from deepest point to deepest
// point over exactly that many presses. Presses are minima of z. Throws BadData where there are fewer than two such
// rows.
std::vector<RasterRow> raster_rows(const recording::Recording& recording, std::size_t presses);

// One spring on one plane, F = k max(0, z0 + b x + c y - z), fitted by least squares to the samples in contact: a
// rendering that lacks the object's shape and the variation of its stiffness.
struct PlaneSpring {
  double k_N_per_m;
  double z0_m, b, c;
  [[nodiscard]] double force_N(const Vec3& p_W_m) const;
};
PlaneSpring fit_plane_spring(const recording::Recording& recording, double contact_force_N);

struct RowComparison {
  RasterRow row{};
  RasterRow next{};
  perception::PerceptualEvaluation evaluation;  // real: the row; conditions: the next row as measured, and as rendered
  [[nodiscard]] double same() const { return evaluation.conditions[0].distance; }
  [[nodiscard]] double rendered() const { return evaluation.conditions[1].distance; }
};

// The settings for a raster of about two presses a second recorded at 66 Hz: its own rate, a window of 75 ms.
perception::EvaluationOptions raster_options();

// Every row against the one after it.
std::vector<RowComparison> compare_rows(const recording::Recording& recording, std::size_t presses,
                                        const perception::EvaluationOptions& options);

}  // namespace touchstone::experiments
