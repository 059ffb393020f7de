#include "harness/perception/judge/response.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "harness/base/least_squares.h"

namespace touchstone::perception {
namespace {

constexpr std::size_t kMostKnots = 48;
constexpr double kFewestSeen = 10.0;  // samples' weight at a knot that counts
constexpr double kSliding = 0.92;     // direction of sliding that counts: 2.3 mm/s along an axis
constexpr std::size_t kBins = 400;

// Normal equations of one component: two features (1 and a factor) times the two hats that a sample lies between.
// Neighbouring knots alone share samples, so that the matrix is kept as diagonal and first off-diagonal blocks.
//
// A sample at depth d between knots j and j + 1 has the hats h_j = left and h_{j+1} = right = 1 - left there, and with
// its factor q (rate of depth, or direction of sliding) the model
//   f = sum over k in {j, j + 1} of h_k (a_k + q b_k).
// Setting the derivatives of the summed squares by a_k and b_k to zero gives, for each pair of knots k, l that share
// samples, the 2 x 2 block  sum h_k h_l [1 q; q q^2]  and on the right-hand side  sum h_k f [1; q].
struct Sums {
  struct Knot {
    // Products of this knot's features (1, q) with its own and with the next knot's, and with the force.
    double own[3] = {};   // 1 1, 1 q, q q
    double next[3] = {};  // 1 1, 1 q (= q 1), q q
    double force[2] = {};
  };
  std::vector<Knot> knots;

  void add(std::size_t j, double left, double right, double q, double f) {
    Knot& a = knots[j];
    Knot& b = knots[j + 1];
    const double ll = left * left;
    const double lr = left * right;
    const double rr = right * right;
    const double qq = q * q;
    a.own[0] += ll;
    a.own[1] += ll * q;
    a.own[2] += ll * qq;
    a.next[0] += lr;
    a.next[1] += lr * q;
    a.next[2] += lr * qq;
    b.own[0] += rr;
    b.own[1] += rr * q;
    b.own[2] += rr * qq;
    a.force[0] += left * f;
    a.force[1] += left * q * f;
    b.force[0] += right * f;
    b.force[1] += right * q * f;
  }
  void add(const Sums& other, double sign) {
    for (std::size_t j = 0; j < knots.size(); ++j) {
      for (int e = 0; e < 3; ++e) {
        knots[j].own[e] += sign * other.knots[j].own[e];
        knots[j].next[e] += sign * other.knots[j].next[e];
      }
      for (int e = 0; e < 2; ++e) knots[j].force[e] += sign * other.knots[j].force[e];
    }
  }
};

struct Solved {
  std::vector<double> constant;
  std::vector<double> factor;
};

Solved solve(const Sums& sums) {
  const auto n = static_cast<Eigen::Index>(sums.knots.size());
  Eigen::MatrixXd a = Eigen::MatrixXd::Zero(2 * n, 2 * n);
  Eigen::VectorXd b(2 * n);
  for (Eigen::Index j = 0; j < n; ++j) {
    const auto& k = sums.knots[static_cast<std::size_t>(j)];
    a(2 * j, 2 * j) = k.own[0];
    a(2 * j + 1, 2 * j) = k.own[1];
    a(2 * j + 1, 2 * j + 1) = k.own[2];
    if (j + 1 < n) {
      a(2 * j + 2, 2 * j) = k.next[0];
      a(2 * j + 3, 2 * j) = k.next[1];
      a(2 * j + 2, 2 * j + 1) = k.next[1];
      a(2 * j + 3, 2 * j + 1) = k.next[2];
    }
    b(2 * j) = k.force[0];
    b(2 * j + 1) = k.force[1];
  }
  // What no sample sees stays at zero; the share is far below any information of a sample.
  double constant_weight = 0.0;
  double factor_weight = 0.0;
  for (const auto& k : sums.knots) {
    constant_weight = std::max(constant_weight, k.own[0]);
    factor_weight = std::max(factor_weight, k.own[2]);
  }
  for (Eigen::Index j = 0; j < n; ++j) {
    a(2 * j, 2 * j) += 1e-9 * constant_weight + 1e-300;
    a(2 * j + 1, 2 * j + 1) += 1e-6 * factor_weight + 1e-300;
  }
  const Eigen::VectorXd x = solve_symmetric(a, b);
  Solved result;
  for (Eigen::Index j = 0; j < n; ++j) {
    result.constant.push_back(x(2 * j));
    result.factor.push_back(x(2 * j + 1));
  }
  return result;
}

ResponseCurves curves_of(const std::array<Sums, 3>& sums) {
  ResponseCurves curves;
  auto normal = solve(sums[0]);
  curves.normal_N = std::move(normal.constant);
  curves.normal_N_s_per_m = std::move(normal.factor);
  for (std::size_t axis = 0; axis < 2; ++axis) {
    auto side = solve(sums[axis + 1]);
    curves.side_N[axis] = std::move(side.constant);
    curves.friction_N[axis] = std::move(side.factor);
  }
  return curves;
}

}  // namespace

FirstContact first_contact(const FeltSeries& felt, const WeberLaw& force) {
  const auto [low, high] = std::minmax_element(felt.depth_m.begin(), felt.depth_m.end());
  FirstContact result{*low, false};
  const double width = (*high - *low) / static_cast<double>(kBins);
  if (!(width > 0.0)) return result;
  std::vector<double> sum(kBins, 0.0);
  std::vector<double> count(kBins, 0.0);
  std::vector<double> depth(kBins, 0.0);
  for (std::size_t i = 0; i < felt.size(); ++i) {
    const auto bin = std::min(kBins - 1, static_cast<std::size_t>((felt.depth_m[i] - *low) / width));
    sum[bin] += felt.force_N[0][i];
    depth[bin] += felt.depth_m[i];
    count[bin] += 1.0;
  }
  std::vector<double> f;
  std::vector<double> d;
  for (std::size_t b = 0; b < kBins; ++b) {
    if (count[b] == 0.0) continue;
    f.push_back(sum[b] / count[b]);
    d.push_back(depth[b] / count[b]);
  }
  // Near contact the force is k (d - d_0). It passes the level L at d_0 + L / k and 3 L at d_0 + 3 L / k; half of the
  // difference, L / k, taken from the first gives d_0 without knowing k.
  // The depth at which the mean force passes a level for good: the deepest place below it is beneath.
  const auto passes = [&](double level) -> std::optional<double> {
    std::size_t b = 0;
    while (b < f.size() && !(f[b] > level && (b + 1 == f.size() || f[b + 1] > level))) ++b;
    if (b == 0 || b == f.size()) return std::nullopt;
    return d[b - 1] + (level - f[b - 1]) / (f[b] - f[b - 1]) * (d[b] - d[b - 1]);
  };
  const auto once = passes(force.absolute_threshold);
  const auto thrice = passes(3.0 * force.absolute_threshold);
  if (!once || !thrice) return result;
  result.depth_m = *once - 0.5 * std::max(0.0, *thrice - *once);
  result.begins_free = true;
  return result;
}

DepthGrid depth_grid(const FeltSeries& felt, const FirstContact& contact) {
  const double deepest = *std::max_element(felt.depth_m.begin(), felt.depth_m.end()) - contact.depth_m;
  return {deepest / 10.0};
}

std::optional<Response> fit_response(const FeltSeries& felt, const FirstContact& contact, const DepthGrid& grid) {
  Response response;
  response.grid = grid;
  response.contact_m = contact.depth_m;
  response.begins_free = contact.begins_free;
  if (!(grid.spacing_m > 0.0)) return std::nullopt;
  response.deepest_m = *std::max_element(felt.depth_m.begin(), felt.depth_m.end()) - contact.depth_m;
  if (!(response.deepest_m > 0.0)) return std::nullopt;
  const double cells =
      std::min(std::ceil(response.deepest_m / grid.spacing_m * (1.0 - 1e-12)), static_cast<double>(kMostKnots - 1));
  const auto knots = static_cast<std::size_t>(std::max(1.0, cells)) + 1;
  response.seen.assign(knots, 0.0);
  response.speed_m_per_s.assign(knots, 0.0);

  std::vector<std::array<Sums, 3>> blocks(kBlocks);
  for (auto& block : blocks) {
    for (auto& sums : block) sums.knots.resize(knots);
  }
  double in_contact = 0.0;
  for (std::size_t i = 0; i < felt.size(); ++i) {
    const double d = felt.depth_m[i] - contact.depth_m;
    if (!(d >= 0.0)) continue;
    const double at = d / grid.spacing_m;
    const auto j = std::min(static_cast<std::size_t>(at), knots - 2);
    const double right = std::min(at - static_cast<double>(j), 1.0);
    const double left = 1.0 - right;
    auto& block = blocks[i * kBlocks / felt.size()];
    const double v = felt.rate_of_depth_m_per_s[i];
    const double x = felt.slide_x[i];
    const double y = felt.slide_y[i];
    block[0].add(j, left, right, v, felt.force_N[0][i]);
    block[1].add(j, left, right, x, felt.force_N[1][i]);
    block[2].add(j, left, right, y, felt.force_N[2][i]);
    response.seen[j] += left;
    response.seen[j + 1] += right;
    response.speed_m_per_s[j] += left * v * v;
    response.speed_m_per_s[j + 1] += right * v * v;
    in_contact += 1.0;
    if (std::abs(x) > kSliding) response.slid_share[0] += 1.0;
    if (std::abs(y) > kSliding) response.slid_share[1] += 1.0;
  }
  if (*std::max_element(response.seen.begin(), response.seen.end()) < kFewestSeen) return std::nullopt;
  for (std::size_t j = 0; j < knots; ++j) {
    if (response.seen[j] > 0.0) response.speed_m_per_s[j] = std::sqrt(response.speed_m_per_s[j] / response.seen[j]);
    if (response.seen[j] < kFewestSeen) response.seen[j] = 0.0;
  }
  for (double& share : response.slid_share) share /= in_contact;

  std::array<Sums, 3> total;
  for (std::size_t c = 0; c < 3; ++c) total[c].knots.resize(knots);
  for (const auto& block : blocks) {
    for (std::size_t c = 0; c < 3; ++c) total[c].add(block[c], 1.0);
  }
  response.curves = curves_of(total);
  for (const auto& block : blocks) {
    auto rest = total;
    for (std::size_t c = 0; c < 3; ++c) rest[c].add(block[c], -1.0);
    response.without.push_back(curves_of(rest));
  }
  return response;
}

double residual_squares_N2(const Response& response, const FeltSeries& felt) {
  // The forces before contact are zero by this response; all samples count, so that delays can be told apart.
  double squares = 0.0;
  for (std::size_t i = 0; i < felt.size(); ++i) {
    const double error = felt.force_N[0][i] - expected_force_N(response, felt, response.contact_m, i)[0];
    squares += error * error;
  }
  return squares;
}

double apparent_lag_s(const Response& response) {
  // A force that is late by the lag is a(d(t - lag)) = a(d) - lag a'(d) d' to first order, so that the part of the rate
  // is b = -lag a'. Least squares over the stretches between knots: lag = -sum w a' b / sum w a'^2. The weight is the
  // information that the samples have on b: its normal equation holds the sum of their d'^2, `seen` times the mean
  // square.
  const auto& a = response.curves.normal_N;
  const auto& b = response.curves.normal_N_s_per_m;
  double product = 0.0;
  double squares = 0.0;
  for (std::size_t j = 0; j + 1 < response.knots(); ++j) {
    if (response.seen[j] == 0.0 || response.seen[j + 1] == 0.0) continue;
    const double slope = (a[j + 1] - a[j]) / response.grid.spacing_m;
    const double weight = response.seen[j] * std::pow(response.speed_m_per_s[j], 2);
    product -= weight * slope * 0.5 * (b[j] + b[j + 1]);
    squares += weight * slope * slope;
  }
  return squares > 0.0 ? product / squares : 0.0;
}

double at_depth(const std::vector<double>& curve, double depth_m, const DepthGrid& grid) {
  const double at = std::max(0.0, depth_m / grid.spacing_m);
  const auto j = static_cast<std::size_t>(std::min(at, static_cast<double>(curve.size())));
  if (j + 1 >= curve.size()) return curve.back();
  const double share = at - static_cast<double>(j);
  return curve[j] + share * (curve[j + 1] - curve[j]);
}

std::array<double, 3> expected_force_N(const Response& response, const FeltSeries& felt, double contact_m,
                                       std::size_t i) {
  const double d = felt.depth_m[i] - contact_m;
  if (!(d >= 0.0)) return {0.0, 0.0, 0.0};
  const auto& c = response.curves;
  const double at = d / response.grid.spacing_m;
  const auto j =
      std::min(static_cast<std::size_t>(std::min(at, static_cast<double>(kMostKnots))), response.knots() - 2);
  const double share = std::min(at - static_cast<double>(j), 1.0);
  const auto value = [j, share](const std::vector<double>& curve) {
    return curve[j] + share * (curve[j + 1] - curve[j]);
  };
  return {value(c.normal_N) + value(c.normal_N_s_per_m) * felt.rate_of_depth_m_per_s[i],
          value(c.side_N[0]) + value(c.friction_N[0]) * felt.slide_x[i],
          value(c.side_N[1]) + value(c.friction_N[1]) * felt.slide_y[i]};
}

}  // namespace touchstone::perception
