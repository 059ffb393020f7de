// The perception space (eq 6, 16-21): haptic images of N conditions, scaled, reduced to their principal components, and
// the distances between conditions there.
//
// The paper does not say how features of different units are scaled before the principal components are taken, and the
// ranking can depend on it: the rule is an option that every result names.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "harness/perception/haptic_image.h"

namespace touchstone::perception {

enum class FeatureScaling {
  reference_norm,  // each feature over its norm in the real process: 1 is a difference as large as the feature itself
  none,            // SI units as they are: the feature with the largest numbers decides
  block_spread,    // each feature over its total spread among the conditions: all features weigh the same
  standardised,    // each column over its standard deviation among the conditions
  pooled_range,    // each feature over its largest magnitude in any condition
};
inline constexpr std::array feature_scalings{FeatureScaling::reference_norm, FeatureScaling::none,
                                             FeatureScaling::block_spread, FeatureScaling::standardised,
                                             FeatureScaling::pooled_range};
std::string_view name_of(FeatureScaling scaling);
// Throws UsageError that lists the names.
FeatureScaling feature_scaling(std::string_view name);

// The scaled sample set, one condition a row, the reference first; and the remarks to show (features without content).
struct ScaledImages {
  Eigen::MatrixXd rows;
  std::vector<std::string> remarks;
};
// Throws BadData when the images have different features or a value that is not finite.
ScaledImages scale_images(std::span<const HapticImage* const> images, FeatureScaling scaling);

struct PerceptionSpace {
  Eigen::MatrixXd basis;         // T of eq 19: k x d, orthonormal columns; the largest loading of each is positive
  Eigen::MatrixXd coordinates;   // eq 20, Im T without centring, as the paper's table 2: N x d
  Eigen::VectorXd eigenvalues;   // of the covariance (eq 18, over N), descending; of many conditions the leading ones
  Eigen::Index available = 0;    // min(N - 1, k): how many there are
  Eigen::Index dimensions = 0;   // d; 0 when all conditions are the same
  double explained_share = 0.0;  // of the d dimensions
};

// `share` of the variance that the dimensions must explain (the paper's 90 %). Singular values and vectors of the
// centred sample set, from the smaller of its two products; components below 1e-14 of the largest eigenvalue are
// rounding. Throws BadData for fewer than two conditions, UsageError for a share outside (0, 1].
PerceptionSpace build_perception_space(const Eigen::MatrixXd& images, double share = 0.9);

// Eq 7, 8, 21: Euclidean distance of every row to row `reference`.
std::vector<double> distances_to(const Eigen::MatrixXd& coordinates, Eigen::Index reference);

// Figure 13: 1 for the best, 0 for the worst. `larger_is_better` for similarities. Empty for fewer than two values;
// values that are all equal cannot be told apart and are all NaN.
std::vector<double> relative_similarity(std::span<const double> values, bool larger_is_better);

}  // namespace touchstone::perception
