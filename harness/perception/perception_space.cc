#include "harness/perception/perception_space.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "harness/base/error.h"
#include "harness/perception/leading_eigenpairs.h"

namespace touchstone::perception {

std::string_view name_of(FeatureScaling scaling) {
  switch (scaling) {
    case FeatureScaling::reference_norm:
      return "reference-norm";
    case FeatureScaling::none:
      return "none";
    case FeatureScaling::block_spread:
      return "block-spread";
    case FeatureScaling::standardised:
      return "standardised";
    case FeatureScaling::pooled_range:
      return "pooled-range";
  }
  return "unknown";
}

FeatureScaling feature_scaling(std::string_view name) {
  std::string known;
  for (const auto scaling : feature_scalings) {
    if (name == name_of(scaling)) return scaling;
    known += fmt::format("{}{}", known.empty() ? "" : ", ", name_of(scaling));
  }
  throw UsageError(fmt::format("'{}' is no scaling of features; known are {}", name, known));
}

namespace {

double block_scale(const Eigen::MatrixXd& block, FeatureScaling scaling) {
  const Eigen::Index rows = block.rows();
  switch (scaling) {
    case FeatureScaling::reference_norm:
      return block.row(0).norm();
    case FeatureScaling::block_spread:
      return (block.rowwise() - block.colwise().mean()).norm() / std::sqrt(static_cast<double>(rows));
    case FeatureScaling::pooled_range:
      return block.cwiseAbs().maxCoeff();
    case FeatureScaling::none:
    case FeatureScaling::standardised:
      break;
  }
  return 1.0;
}

}  // namespace

ScaledImages scale_images(std::span<const HapticImage* const> images, FeatureScaling scaling) {
  if (images.empty()) throw BadData("no condition to place in the perception space");
  const auto& features = images.front()->blocks;
  Eigen::Index columns = 0;
  for (const auto& block : features) columns += static_cast<Eigen::Index>(block.values.size());
  ScaledImages result;
  result.rows.resize(static_cast<Eigen::Index>(images.size()), columns);
  for (std::size_t i = 0; i < images.size(); ++i) {
    Eigen::Index at = 0;
    const auto& blocks = images[i]->blocks;
    for (std::size_t b = 0; b < features.size(); ++b) {
      if (blocks.size() != features.size() || blocks[b].name != features[b].name ||
          blocks[b].values.size() != features[b].values.size()) {
        throw BadData(
            fmt::format("condition {} has other features than the first: all must come from the same options, "
                        "rate and duration",
                        i + 1));
      }
      for (const double value : blocks[b].values) {
        if (!std::isfinite(value)) {
          throw BadData(
              fmt::format("condition {}: the feature '{}' has a value that is not finite", i + 1, blocks[b].name));
        }
        result.rows(static_cast<Eigen::Index>(i), at++) = value;
      }
    }
  }
  Eigen::Index at = 0;
  for (const auto& feature : features) {
    auto block = result.rows.middleCols(at, static_cast<Eigen::Index>(feature.values.size()));
    double scale = block_scale(block, scaling);
    // What is rounding beside the conditions' values is nothing: divided by, it would be all that the distances show.
    const double largest = block.cwiseAbs().maxCoeff();
    if (scaling == FeatureScaling::reference_norm && !(scale > 1e-12 * largest)) {
      scale = largest;
      result.remarks.push_back(
          fmt::format("the real process has no {}; that feature is scaled by its largest value "
                      "among the conditions instead",
                      feature.name));
    }
    if (scale > 0.0) {
      block /= scale;
    } else {
      result.remarks.push_back(
          fmt::format("the feature '{}' is the same everywhere and decides nothing", feature.name));
    }
    at += block.cols();
  }
  if (scaling == FeatureScaling::standardised) {
    for (Eigen::Index c = 0; c < columns; ++c) {
      auto column = result.rows.col(c);
      const double centre = column.mean();
      const double spread = (column.array() - centre).matrix().norm() / std::sqrt(static_cast<double>(images.size()));
      // A column whose spread is rounding only carries nothing.
      const double rounding = 1e-12 * column.cwiseAbs().maxCoeff();
      if (spread > rounding)
        column /= spread;
      else
        column.setZero();
    }
  }
  return result;
}

PerceptionSpace build_perception_space(const Eigen::MatrixXd& images, double share) {
  if (images.rows() < 2) {
    throw BadData("a perception space needs the real process and at least one condition");
  }
  if (!(share > 0.0 && share <= 1.0))
    throw UsageError(fmt::format("the explained share must lie in (0, 1], not {}", share));
  if (!images.allFinite()) throw BadData("a haptic image has a value that is not finite");
  const auto n = static_cast<double>(images.rows());
  const Eigen::RowVectorXd average = images.colwise().mean();
  const Eigen::MatrixXd centred = images.rowwise() - average;
  // Eq 18 has k x k entries; with fewer conditions than features the N x N products of the conditions hold the same
  // singular values (method of snapshots, Sirovich 1987) at a fraction of the cost.
  const bool few = images.rows() <= images.cols();
  const Eigen::MatrixXd product =
      few ? Eigen::MatrixXd(centred * centred.transpose()) : Eigen::MatrixXd(centred.transpose() * centred);
  const EigenPairs pairs = leading_eigenpairs(product, share);
  PerceptionSpace space;
  space.available = std::min(images.rows() - 1, images.cols());
  const Eigen::Index known = std::min(space.available, pairs.values.size());
  // Rounding may leave the smallest ones below zero.
  space.eigenvalues = pairs.values.head(known).cwiseMax(0.0) / n;
  const double total = pairs.values.size() < product.rows() ? product.trace() / n : space.eigenvalues.sum();
  // Singular values at the level of rounding are no dimension: then all conditions are the same.
  const double rounding = std::numeric_limits<double>::epsilon() * images.cwiseAbs().maxCoeff();
  const double noise = rounding * rounding * static_cast<double>(images.size());
  const double least = std::max(noise, 1e-14 * space.eigenvalues(0) * n) / n;
  double explained = 0.0;
  while (space.dimensions < known && space.eigenvalues(space.dimensions) > least &&
         explained < share * total * (1.0 - 1e-12)) {
    explained += space.eigenvalues(space.dimensions++);
  }
  if (space.dimensions > 0) space.explained_share = explained / total;
  space.basis = pairs.vectors.leftCols(space.dimensions);
  if (few) {
    space.basis = (centred.transpose() * space.basis).eval();
    for (Eigen::Index d = 0; d < space.dimensions; ++d) space.basis.col(d).normalize();
  }
  for (Eigen::Index d = 0; d < space.dimensions; ++d) {
    Eigen::Index largest = 0;
    space.basis.col(d).cwiseAbs().maxCoeff(&largest);
    if (space.basis(largest, d) < 0.0) space.basis.col(d) *= -1.0;
  }
  space.coordinates = images * space.basis;
  return space;
}

std::vector<double> distances_to(const Eigen::MatrixXd& coordinates, Eigen::Index reference) {
  std::vector<double> result;
  result.reserve(static_cast<std::size_t>(coordinates.rows()));
  for (Eigen::Index i = 0; i < coordinates.rows(); ++i) {
    result.push_back((coordinates.row(i) - coordinates.row(reference)).norm());
  }
  return result;
}

std::vector<double> relative_similarity(std::span<const double> values, bool larger_is_better) {
  if (values.size() < 2) return {};
  const auto [low, high] = std::minmax_element(values.begin(), values.end());
  std::vector<double> result;
  for (const double value : values) {
    const double share = (value - *low) / (*high - *low);  // 0 / 0 is NaN where all are equal
    result.push_back(larger_is_better ? share : 1.0 - share);
  }
  return result;
}

}  // namespace touchstone::perception
