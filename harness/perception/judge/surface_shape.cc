#include "harness/perception/judge/surface_shape.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <vector>

#include "harness/base/least_squares.h"
#include "harness/base/vec.h"
#include "harness/perception/judge/place.h"

namespace touchstone::perception {
namespace {

constexpr std::size_t force_knots = 12;
constexpr std::size_t term_count = 5;
constexpr std::size_t looked_at = 4000;
constexpr double explains = 0.2;  // of the squares, at most what is left
constexpr double matters = 0.05;  // of the range of depths in contact: less is no shape

std::array<double, term_count> terms_at(double x, double y) { return {x, y, x * x, x * y, y * y}; }

// Root mean square of what `used` of the unknowns leave.
double left_m(const Eigen::MatrixXd& rows, const Eigen::VectorXd& depth_m, Eigen::Index used, Eigen::VectorXd& found) {
  Eigen::MatrixXd information = rows.leftCols(used).transpose() * rows.leftCols(used);
  information.diagonal().array() += 1e-9 * information.diagonal().maxCoeff();
  // Terms reach 1 where the places do: what was not explored stays flat.
  constexpr double unexplored = 1e-4;
  information.diagonal().tail(used - static_cast<Eigen::Index>(force_knots)).array() +=
      unexplored * static_cast<double>(depth_m.size());
  found = solve_symmetric(information, rows.leftCols(used).transpose() * depth_m);
  return (depth_m - rows.leftCols(used) * found).norm() / std::sqrt(static_cast<double>(depth_m.size()));
}

}  // namespace

SurfaceShape::At SurfaceShape::at(double x_m, double y_m) const {
  const double x = (x_m - middle_m[0]) / scale_m;
  const double y = (y_m - middle_m[1]) / scale_m;
  const auto terms = terms_at(x, y);
  At result;
  for (std::size_t k = 0; k < term_count; ++k) result.height_m += height_m[k] * terms[k];
  result.slope[0] = (height_m[0] + 2.0 * height_m[2] * x + height_m[3] * y) / scale_m;
  result.slope[1] = (height_m[1] + height_m[3] * x + 2.0 * height_m[4] * y) / scale_m;
  return result;
}

std::optional<SurfaceShape> surface_shape(const FeltSeries& felt, double least_force_N) {
  std::vector<std::size_t> touching;
  for (std::size_t i = 0; i < felt.size(); ++i)
    if (felt.force_N[0][i] > least_force_N) touching.push_back(i);
  if (touching.size() < 20 * (force_knots + term_count)) return std::nullopt;
  SurfaceShape shape;
  double low_m[2] = {};
  double high_m[2] = {};
  for (std::size_t a = 0; a < 2; ++a) {
    const auto by_place = [&](std::size_t i, std::size_t j) { return felt.place_m[a][i] < felt.place_m[a][j]; };
    const auto [low, high] = std::minmax_element(touching.begin(), touching.end(), by_place);
    low_m[a] = felt.place_m[a][*low];
    high_m[a] = felt.place_m[a][*high];
    shape.middle_m[a] = 0.5 * (low_m[a] + high_m[a]);
  }
  const double wide_m = std::max(high_m[0] - low_m[0], high_m[1] - low_m[1]);
  if (!(wide_m > finest_place_m)) return std::nullopt;
  shape.scale_m = 0.5 * wide_m;
  const auto most_N = [&] {
    double most = 0.0;
    for (const std::size_t i : touching) most = std::max(most, felt.force_N[0][i]);
    return most;
  }();
  const std::size_t stride = touching.size() / looked_at + 1;
  const auto n = static_cast<Eigen::Index>((touching.size() + stride - 1) / stride);
  Eigen::MatrixXd rows = Eigen::MatrixXd::Zero(n, force_knots + term_count);
  Eigen::VectorXd depth_m(n);
  for (Eigen::Index row = 0; row < n; ++row) {
    const std::size_t i = touching[static_cast<std::size_t>(row) * stride];
    const double at = (felt.force_N[0][i] - least_force_N) / (most_N - least_force_N) * (force_knots - 1.0);
    const auto knot = std::min(static_cast<std::size_t>(at), force_knots - 2);
    rows(row, static_cast<Eigen::Index>(knot)) = 1.0 - (at - static_cast<double>(knot));
    rows(row, static_cast<Eigen::Index>(knot) + 1) = at - static_cast<double>(knot);
    const auto terms = terms_at((felt.place_m[0][i] - shape.middle_m[0]) / shape.scale_m,
                                (felt.place_m[1][i] - shape.middle_m[1]) / shape.scale_m);
    for (std::size_t k = 0; k < term_count; ++k) rows(row, static_cast<Eigen::Index>(force_knots + k)) = terms[k];
    depth_m(row) = felt.depth_m[i];
  }
  Eigen::VectorXd found;
  const double flat_m = left_m(rows, depth_m, force_knots, found);
  const double shaped_m = left_m(rows, depth_m, force_knots + term_count, found);
  if (!(shaped_m * shaped_m < explains * flat_m * flat_m)) return std::nullopt;
  for (std::size_t k = 0; k < term_count; ++k) shape.height_m[k] = found(static_cast<Eigen::Index>(force_knots + k));
  const Eigen::VectorXd heights_m = rows.rightCols(term_count) * found.tail(term_count);
  const double spread_m = std::sqrt((heights_m.array() - heights_m.mean()).square().mean());
  if (!(spread_m > matters * (depth_m.maxCoeff() - depth_m.minCoeff()))) return std::nullopt;
  return shape;
}

FeltSeries on_shape(FeltSeries felt, const SurfaceShape& shape) {
  for (std::size_t i = 0; i < felt.size(); ++i) {
    const SurfaceShape::At at = shape.at(felt.place_m[0][i], felt.place_m[1][i]);
    const Vec3 across(1.0, at.slope[0], at.slope[1]);
    const double along = 1.0 / across.norm();
    const double speed_m_per_s = std::hypot(felt.slide_m_per_s[i], rest_m_per_s);
    felt.rate_of_depth_m_per_s[i] =
        along * (felt.rate_of_depth_m_per_s[i] -
                 speed_m_per_s * (at.slope[0] * felt.slide_x[i] + at.slope[1] * felt.slide_y[i]));
    felt.depth_m[i] = along * (felt.depth_m[i] - at.height_m);
    const Vec3 force =
        Quat::FromTwoVectors(across, Vec3::UnitX()) * Vec3(felt.force_N[0][i], felt.force_N[1][i], felt.force_N[2][i]);
    for (std::size_t a = 0; a < 3; ++a) felt.force_N[a][i] = force[static_cast<Eigen::Index>(a)];
  }
  return felt;
}

}  // namespace touchstone::perception
