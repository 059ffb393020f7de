#include "harness/pipeline/discrepancy/curve_zero.h"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <vector>

namespace touchstone::pipeline {
namespace {

constexpr std::size_t most_points = 400;
constexpr std::size_t fewest_points = 20;  // six coefficients, and something to be left
constexpr std::size_t fewest_in_part = 5;  // in free air, and in contact
constexpr double most_aside = 1e-3;        // of the way along z
constexpr double least_share_gone = 0.5;   // of the square that another zero leaves
constexpr double negligible_depth = 0.1;

struct Approach {
  std::vector<double> z_m, f_N;
};

Box3 box_of(const recording::Recording& recording) {
  Box3 box;
  for (const Vec3& p : recording.motion.p_W_m) box.extend(p);
  return box;
}

// From the first sample to the deepest one, evenly thinned.
Approach first_approach(const recording::Recording& recording) {
  const std::vector<Vec3>& p = recording.motion.p_W_m;
  const auto deepest =
      static_cast<std::size_t>(std::ranges::min_element(p, {}, [](const Vec3& at) { return at.z(); }) - p.begin());
  const std::size_t every = deepest / most_points + 1;
  Approach approach;
  for (std::size_t i = deepest % every; i <= deepest; i += every) {
    approach.z_m.push_back(p[i].z());
    approach.f_N.push_back(recording.f_W_N[i].z());
  }
  return approach;
}

// The square that is left where contact begins at `zero_m`.
double square_left(const Approach& approach, double zero_m, double way_m) {
  const auto n = static_cast<Eigen::Index>(approach.z_m.size());
  Eigen::MatrixXd terms(n, 5);
  for (Eigen::Index i = 0; i < n; ++i) {
    const double z_m = approach.z_m[static_cast<std::size_t>(i)];
    const double depth = std::max(0.0, zero_m - z_m) / way_m;
    terms.row(i) << 1.0, (z_m - zero_m) / way_m, depth, std::pow(depth, 1.5), depth * depth;
  }
  const Eigen::Map<const Eigen::VectorXd> force(approach.f_N.data(), n);
  return (force - terms * terms.colPivHouseholderQr().solve(force)).squaredNorm();
}

}  // namespace

std::optional<CurveZero> find_curve_zero(const recording::Recording& recording) {
  if (recording.size() < fewest_points) return std::nullopt;
  const Vec3 ways = box_of(recording).sizes();
  if (!(ways.z() > 0.0) || ways.head<2>().norm() > most_aside * ways.z()) return std::nullopt;
  const Approach approach = first_approach(recording);
  if (approach.z_m.size() < fewest_points) return std::nullopt;
  std::vector<double> zeros = approach.z_m;
  std::ranges::sort(zeros, std::greater<>());
  const double deepest = zeros.back();
  const auto left = [&](double zero_m) { return square_left(approach, zero_m, ways.z()); };
  double best = std::numeric_limits<double>::infinity(), best_m = 0.0;
  for (std::size_t i = fewest_in_part; i + fewest_in_part < zeros.size(); ++i) {
    const double square = left(zeros[i]);
    if (square < best) best = square, best_m = zeros[i];
  }
  const double depth_m = best_m - deepest;
  if (!(best < least_share_gone * left(zeros.front()))) return std::nullopt;
  if (std::abs(best_m) < negligible_depth * depth_m || !(best < least_share_gone * left(0.0))) return std::nullopt;
  return CurveZero{best_m, depth_m};
}

}  // namespace touchstone::pipeline
