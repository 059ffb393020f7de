#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "harness/base/least_squares.h"
#include "harness/perception/judge/place.h"
#include "harness/perception/judge/response.h"

namespace touchstone::perception {
namespace {

constexpr double intervals_per_side = 20.0;  // of the longer side of what was explored
constexpr double smallest_step_s = 0.002;    // places are smoothed over 20 ms: ten samples of it say as much as all

// The four cubic B-splines that are not zero at `share` of an interval.
std::array<double, 4> cubic(double share) {
  const double rest = 1.0 - share;
  return {rest * rest * rest / 6.0, (3.0 * share * share * share - 6.0 * share * share + 4.0) / 6.0,
          (-3.0 * share * share * share + 3.0 * share * share + 3.0 * share + 1.0) / 6.0, share * share * share / 6.0};
}

// The sixteen coefficients that a place draws on, and their weights.
struct Drawn {
  std::array<std::size_t, 16> index{};
  std::array<double, 16> weight{};
};

Drawn drawn_at(const PlaceGain& gain, double x_m, double y_m) {
  std::array<std::size_t, 2> from{};
  std::array<std::array<double, 4>, 2> weights{};
  const double place[2] = {x_m, y_m};
  for (std::size_t a = 0; a < 2; ++a) {
    const double last = static_cast<double>(gain.intervals[a]);
    const double at = std::clamp((place[a] - gain.first_m[a]) / gain.spacing_m, 0.0, last);
    from[a] = std::min(static_cast<std::size_t>(at), gain.intervals[a] - 1);
    weights[a] = cubic(at - static_cast<double>(from[a]));
  }
  Drawn drawn;
  for (std::size_t i = 0; i < 4; ++i) {
    for (std::size_t j = 0; j < 4; ++j) {
      drawn.index[4 * i + j] = (from[0] + i) * (gain.intervals[1] + 3) + from[1] + j;
      drawn.weight[4 * i + j] = weights[0][i] * weights[1][j];
    }
  }
  return drawn;
}

bool touches(const FeltSeries& felt, const Response& response, std::size_t i) {
  return felt.depth_m[i] >= response.contact_m;
}

}  // namespace

std::optional<PlaceRange> explored(const FeltSeries& felt, const Response& response) {
  PlaceRange range;
  for (auto& r : range) r = {std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
  for (std::size_t i = 0; i < felt.size(); ++i) {
    if (!touches(felt, response, i)) continue;
    for (std::size_t a = 0; a < 2; ++a) {
      range[a][0] = std::min(range[a][0], felt.place_m[a][i]);
      range[a][1] = std::max(range[a][1], felt.place_m[a][i]);
    }
  }
  if (!(std::max(range[0][1] - range[0][0], range[1][1] - range[1][0]) > finest_place_m)) return std::nullopt;
  return range;
}

double PlaceGain::of(const FeltSeries& felt, std::size_t i) const {
  if (coefficients.empty()) return 1.0;
  const Drawn drawn = drawn_at(*this, felt.place_m[0][i], felt.place_m[1][i]);
  double sum = 0.0;
  for (std::size_t k = 0; k < drawn.index.size(); ++k) sum += drawn.weight[k] * coefficients[drawn.index[k]];
  return sum;
}

std::optional<PlaceGain> place_gain(const FeltSeries& felt, const Response& response) {
  const auto range = explored(felt, response);
  if (!range) return std::nullopt;
  PlaceGain gain;
  const double side_m[2] = {(*range)[0][1] - (*range)[0][0], (*range)[1][1] - (*range)[1][0]};
  gain.spacing_m = std::max(side_m[0], side_m[1]) / intervals_per_side;
  for (std::size_t a = 0; a < 2; ++a) {
    gain.first_m[a] = (*range)[a][0];
    gain.intervals[a] = static_cast<std::size_t>(std::max(1.0, std::ceil(side_m[a] / gain.spacing_m * (1.0 - 1e-12))));
  }
  const auto n = static_cast<Eigen::Index>((gain.intervals[0] + 3) * (gain.intervals[1] + 3));
  Eigen::MatrixXd information = Eigen::MatrixXd::Zero(n, n);
  Eigen::VectorXd right = Eigen::VectorXd::Zero(n);
  const double* const force_N = felt.force_N[0].data();
  const auto step = static_cast<std::size_t>(std::max(1.0, std::floor(smallest_step_s * felt.rate_Hz)));
  for (std::size_t i = 0; i < felt.size(); i += step) {
    if (!touches(felt, response, i)) continue;
    const double before = response.gain.of(felt, i);
    const double even_N = expected_force_N(response, felt, response.contact_m, i)[0] / before;
    const Drawn drawn = drawn_at(gain, felt.place_m[0][i], felt.place_m[1][i]);
    for (std::size_t k = 0; k < drawn.index.size(); ++k) {
      const auto row = static_cast<Eigen::Index>(drawn.index[k]);
      const double own = drawn.weight[k] * even_N;
      right(row) += own * (force_N[i] - even_N);
      for (std::size_t l = 0; l <= k; ++l)  // indices ascend: the lower triangle
        information(row, static_cast<Eigen::Index>(drawn.index[l])) += own * drawn.weight[l] * even_N;
    }
  }
  // What was not explored stays at 1.
  const double least = 1e-6 * information.diagonal().maxCoeff();
  if (!(least > 0.0)) return std::nullopt;
  information.diagonal().array() += least;
  information.triangularView<Eigen::StrictlyUpper>() = information.transpose();
  const Eigen::VectorXd beyond_1 = solve_symmetric(information, right);
  for (Eigen::Index k = 0; k < n; ++k) gain.coefficients.push_back(1.0 + beyond_1(k));
  // The mean is the curves' own.
  double sum = 0.0;
  double count = 0.0;
  for (std::size_t i = 0; i < felt.size(); ++i) {
    if (!touches(felt, response, i)) continue;
    sum += gain.of(felt, i);
    count += 1.0;
  }
  if (!(sum > 0.0)) return std::nullopt;
  for (double& c : gain.coefficients) c *= count / sum;
  return gain;
}

}  // namespace touchstone::perception
