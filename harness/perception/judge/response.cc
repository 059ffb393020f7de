#include "harness/perception/judge/response.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "harness/base/least_squares.h"
#include "harness/perception/judge/replay_path.h"

namespace touchstone::perception {
namespace {

constexpr std::size_t most_knots = 48;
constexpr double fewest_seen = 10.0;  // samples' weight at a knot that counts
constexpr std::size_t bins = 400;

// Normal equations of one component: `features` times the two hats that a sample lies between. Neighbouring knots alone
// share samples, so that the matrix is kept as diagonal and first off-diagonal blocks.
//
// A sample at depth d between knots j and j + 1 has the hats h_j = left and h_{j+1} = right = 1 - left there, and with
// its features q the model  f = sum over k in {j, j + 1} of h_k q . x_k.  Setting the derivatives of the summed squares
// by x_k to zero gives, for each pair of knots k, l that share samples, the block  sum h_k h_l q q'  and on the
// right-hand side  sum h_k f q.
template <int features>
struct Sums {
  using Block = Eigen::Matrix<double, features, features, Eigen::DontAlign>;
  using Vector = Eigen::Matrix<double, features, 1, Eigen::DontAlign>;
  struct Knot {
    Block own = Block::Zero();
    Block next = Block::Zero();
    Vector force = Vector::Zero();
  };
  std::vector<Knot> knots;

  void add(std::size_t j, double left, double right, const Vector& q, double f) {
    const Block qq = q * q.transpose();
    knots[j].own += left * left * qq;
    knots[j].next += left * right * qq;
    knots[j + 1].own += right * right * qq;
    knots[j].force += left * f * q;
    knots[j + 1].force += right * f * q;
  }
  void add(const Sums& other, double sign) {
    for (std::size_t j = 0; j < knots.size(); ++j) {
      knots[j].own += sign * other.knots[j].own;
      knots[j].next += sign * other.knots[j].next;
      knots[j].force += sign * other.knots[j].force;
    }
  }
};

// One curve for each feature. The last one's is that of the rate, or of sliding.
template <int features>
std::array<std::vector<double>, features> solve(const Sums<features>& sums) {
  const auto n = static_cast<Eigen::Index>(sums.knots.size());
  Eigen::MatrixXd a = Eigen::MatrixXd::Zero(features * n, features * n);
  Eigen::VectorXd b(features * n);
  for (Eigen::Index j = 0; j < n; ++j) {
    const auto& k = sums.knots[static_cast<std::size_t>(j)];
    a.block<features, features>(features * j, features * j) = k.own;
    if (j + 1 < n) a.block<features, features>(features * (j + 1), features * j) = k.next.transpose();
    b.segment<features>(features * j) = k.force;
  }
  // What no sample sees stays at zero; the share is far below any information of a sample.
  double constant_weight = 0.0;
  double factor_weight = 0.0;
  for (const auto& k : sums.knots) {
    constant_weight = std::max(constant_weight, k.own(0, 0));
    factor_weight = std::max(factor_weight, k.own(features - 1, features - 1));
  }
  for (Eigen::Index i = 0; i < features * n; ++i)
    a(i, i) += (i % features + 1 < features ? 1e-9 * constant_weight : 1e-6 * factor_weight) + 1e-300;
  const Eigen::VectorXd x = solve_symmetric(a, b);
  std::array<std::vector<double>, features> result;
  for (Eigen::Index i = 0; i < features * n; ++i) result[static_cast<std::size_t>(i % features)].push_back(x(i));
  return result;
}

// The force along the direction of pressing by (1, rate of depth); that across, both axes at once, by (1, 0, s_1) and
// (0, 1, s_2): one friction, against the direction of sliding whatever the axes are.
struct ComponentSums {
  Sums<2> normal;
  Sums<3> side;

  void resize(std::size_t knots) {
    normal.knots.resize(knots);
    side.knots.resize(knots);
  }
  void add(const ComponentSums& other, double sign) {
    normal.add(other.normal, sign);
    side.add(other.side, sign);
  }
};

ResponseCurves curves_of(const ComponentSums& sums) {
  ResponseCurves curves;
  auto normal = solve(sums.normal);
  curves.normal_N = std::move(normal[0]);
  curves.normal_N_s_per_m = std::move(normal[1]);
  auto side = solve(sums.side);
  curves.side_N = {std::move(side[0]), std::move(side[1])};
  curves.friction_N = std::move(side[2]);
  return curves;
}

}  // namespace

FirstContact first_contact(const FeltSeries& felt, const WeberLaw& force) {
  const auto [low, high] = std::minmax_element(felt.depth_m.begin(), felt.depth_m.end());
  FirstContact result{*low, false};
  const double width = (*high - *low) / static_cast<double>(bins);
  if (!(width > 0.0)) return result;
  std::vector<double> sum(bins, 0.0);
  std::vector<double> count(bins, 0.0);
  std::vector<double> depth(bins, 0.0);
  for (std::size_t i = 0; i < felt.size(); ++i) {
    const auto bin = std::min(bins - 1, static_cast<std::size_t>((felt.depth_m[i] - *low) / width));
    sum[bin] += felt.force_N[0][i];
    depth[bin] += felt.depth_m[i];
    count[bin] += 1.0;
  }
  // As many samples for one mean as its noise needs to be a fifth of the threshold: noise is no contact.
  const double needed = std::pow(5.0 * white_noise_of(felt.force_N[0]) / force.absolute_threshold, 2);
  std::vector<double> f;
  std::vector<double> d;
  double of_mean[3] = {};
  for (std::size_t b = 0; b < bins; ++b) {
    of_mean[0] += count[b];
    of_mean[1] += sum[b];
    of_mean[2] += depth[b];
    if (of_mean[0] == 0.0 || of_mean[0] < needed) continue;
    f.push_back(of_mean[1] / of_mean[0]);
    d.push_back(of_mean[2] / of_mean[0]);
    std::fill(std::begin(of_mean), std::end(of_mean), 0.0);
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
  // A weight or an offset of the sensor is no contact: the force that is the same over the least tenth of the depths.
  double steady_N = 0.0;
  std::size_t shallow = 0;
  while (shallow < f.size() && d[shallow] < *low + 0.1 * (*high - *low)) ++shallow;
  if (shallow >= 2) {
    const auto [least, most] = std::minmax_element(f.begin(), f.begin() + static_cast<std::ptrdiff_t>(shallow));
    if (*most - *least < force.absolute_threshold) steady_N = 0.5 * (*most + *least);
    if (std::abs(steady_N) < 0.5 * force.absolute_threshold) steady_N = 0.0;
  }
  const auto once = passes(steady_N + force.absolute_threshold);
  const auto thrice = passes(steady_N + 3.0 * force.absolute_threshold);
  if (!once || !thrice) return result;
  result.depth_m = *once - 0.5 * std::max(0.0, *thrice - *once);
  result.begins_free = true;
  return result;
}

DepthGrid depth_grid(const FeltSeries& felt, const FirstContact& contact) {
  const double deepest = *std::max_element(felt.depth_m.begin(), felt.depth_m.end()) - contact.depth_m;
  return {deepest / 10.0};
}

std::optional<Response> fit_response(const FeltSeries& felt, const FirstContact& contact, const DepthGrid& grid,
                                     const PlaceGain& gain) {
  Response response;
  response.gain = gain;
  response.grid = grid;
  response.contact_m = contact.depth_m;
  response.begins_free = contact.begins_free;
  if (!(grid.spacing_m > 0.0)) return std::nullopt;
  response.deepest_m = *std::max_element(felt.depth_m.begin(), felt.depth_m.end()) - contact.depth_m;
  if (!(response.deepest_m > 0.0)) return std::nullopt;
  const double cells =
      std::min(std::ceil(response.deepest_m / grid.spacing_m * (1.0 - 1e-12)), static_cast<double>(most_knots - 1));
  const auto knots = static_cast<std::size_t>(std::max(1.0, cells)) + 1;
  response.seen.assign(knots, 0.0);
  response.speed_m_per_s.assign(knots, 0.0);

  for (auto& towards : response.slid_towards) towards.assign(knots, 0.0);
  response.slid.assign(knots, 0.0);
  response.slid_depth_m.assign(knots, 0.0);
  response.slid_m_per_s.assign(knots, 0.0);

  std::vector<ComponentSums> blocks(jackknife_blocks);
  for (auto& block : blocks) block.resize(knots);
  for (std::size_t i = 0; i < felt.size(); ++i) {
    const double d = felt.depth_m[i] - contact.depth_m;
    if (!(d >= 0.0)) continue;
    const double at = d / grid.spacing_m;
    const auto j = std::min(static_cast<std::size_t>(at), knots - 2);
    const double right = std::min(at - static_cast<double>(j), 1.0);
    const double left = 1.0 - right;
    auto& block = blocks[i * jackknife_blocks / felt.size()];
    const double v = felt.rate_of_depth_m_per_s[i];
    const double x = felt.slide_x[i];
    const double y = felt.slide_y[i];
    const double g = gain.of(felt, i);
    block.normal.add(j, left, right, {g, g * v}, felt.force_N[0][i]);
    block.side.add(j, left, right, {g, 0.0, g * x}, felt.force_N[1][i]);
    block.side.add(j, left, right, {0.0, g, g * y}, felt.force_N[2][i]);
    const double sliding = slides(felt, i) ? 1.0 : 0.0;
    for (const auto& [knot, share] : {std::pair{j, left}, std::pair{j + 1, right}}) {
      response.seen[knot] += share;
      response.speed_m_per_s[knot] += share * v * v;
      response.slid[knot] += share * sliding;
      response.slid_towards[0][knot] += share * sliding * x;
      response.slid_towards[1][knot] += share * sliding * y;
      response.slid_depth_m[knot] += share * sliding * d;
      response.slid_m_per_s[knot] += share * sliding * felt.slide_m_per_s[i] * felt.slide_m_per_s[i];
    }
  }
  if (*std::max_element(response.seen.begin(), response.seen.end()) < fewest_seen) return std::nullopt;
  for (std::size_t j = 0; j < knots; ++j) {
    if (response.slid[j] > 0.0) {
      for (auto& towards : response.slid_towards) towards[j] /= response.slid[j];
      response.slid_depth_m[j] /= response.slid[j];
      response.slid_m_per_s[j] = std::sqrt(response.slid_m_per_s[j] / response.slid[j]);
    }
    if (response.seen[j] > 0.0) {
      response.speed_m_per_s[j] = std::sqrt(response.speed_m_per_s[j] / response.seen[j]);
      response.slid[j] /= response.seen[j];
    }
    if (response.seen[j] < fewest_seen) response.seen[j] = 0.0;
  }

  ComponentSums total;
  total.resize(knots);
  for (const auto& block : blocks) total.add(block, 1.0);
  response.curves = curves_of(total);
  for (const auto& block : blocks) {
    auto rest = total;
    rest.add(block, -1.0);
    response.without.push_back(curves_of(rest));
  }
  return response;
}

std::optional<Response> with_place(const Response& response, const FeltSeries& felt) {
  constexpr int rounds = 100;
  constexpr double less_share = 1e-3;  // of the squares that a round must still take away
  constexpr double explains = 0.5;
  constexpr double matters = 0.023;  // of the force: a third of the least fraction that is noticed, 7 %
  const FirstContact contact{response.contact_m, response.begins_free};
  Response better = response;
  const double even_N2 = residual_squares_N2(response, felt);
  double left_N2 = even_N2;
  // One after the other, the gain over place and the curves over depth.
  for (int round = 0; round < rounds; ++round) {
    const auto gain = place_gain(felt, better);
    if (!gain) return std::nullopt;
    if (round == 0) {
      Response with_gain = response;
      with_gain.gain = *gain;
      if (!(residual_squares_N2(with_gain, felt) < explains * even_N2)) return std::nullopt;
    }
    auto refitted = fit_response(felt, contact, response.grid, *gain);
    if (!refitted) return std::nullopt;
    better = std::move(*refitted);
    const double before_N2 = left_N2;
    left_N2 = residual_squares_N2(better, felt);
    if (!(left_N2 < (1.0 - less_share) * before_N2)) break;
  }
  // Of the force, not of the gain: where a hand only lands, the gain is of little force.
  double squares_N2 = 0.0;
  for (std::size_t i = 0; i < felt.size(); ++i) {
    if (felt.depth_m[i] >= response.contact_m) squares_N2 += felt.force_N[0][i] * felt.force_N[0][i];
  }
  if (!(even_N2 - left_N2 > matters * matters * squares_N2)) return std::nullopt;
  better.lag_s = response.lag_s;
  return better;
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

void measure_left(Response& response, const FeltSeries& felt) {
  constexpr double window_s = 0.02;
  const auto length = static_cast<std::size_t>(std::max(4.0, std::round(window_s * felt.rate_Hz)));
  const auto n = static_cast<double>(length);
  const std::size_t knots = response.knots();
  std::vector<double> weights[2] = {std::vector<double>(knots, 0.0), std::vector<double>(knots, 0.0)};
  std::vector<double> squares[2] = {weights[0], weights[1]};
  for (std::size_t first = 0; first + length <= felt.size();) {
    std::array<double, 3> mean{};
    std::array<double, 3> last{};
    double noise_N2[2] = {0.0, 0.0};
    double depth_m = 0.0;
    double sliding = 0.0;
    std::size_t i = first;
    for (; i < first + length && felt.depth_m[i] >= response.contact_m; ++i) {
      const auto expected_N = expected_force_N(response, felt, response.contact_m, i);
      for (std::size_t a = 0; a < 3; ++a) {
        const double error_N = felt.force_N[a][i] - expected_N[a];
        mean[a] += error_N / n;
        // Half the mean square of steps is the variance of white noise; of n samples' mean an n-th of that.
        if (i > first) noise_N2[a == 0 ? 0 : 1] += (error_N - last[a]) * (error_N - last[a]) / (2.0 * n * (n - 1.0));
        last[a] = error_N;
      }
      depth_m += (felt.depth_m[i] - response.contact_m) / n;
      sliding += slides(felt, i) ? 1.0 / n : 0.0;
    }
    if (i < first + length) {
      first = i + 1;
      continue;
    }
    first = i;
    const double at = depth_m / response.grid.spacing_m;
    const auto j = std::min(static_cast<std::size_t>(at), knots - 2);
    const double right = std::min(at - static_cast<double>(j), 1.0);
    const double own_N2[2] = {mean[0] * mean[0], mean[1] * mean[1] + mean[2] * mean[2]};
    const bool even = sliding == 0.0 || sliding > 1.0 - 0.5 / n;
    for (std::size_t side = 0; side < (even ? 2u : 1u); ++side) {
      for (const auto& [knot, share] : {std::pair{j, 1.0 - right}, std::pair{j + 1, right}}) {
        weights[side][knot] += share;
        squares[side][knot] += share * (own_N2[side] - noise_N2[side]);
      }
    }
  }
  const auto left = [&](std::size_t side) {
    std::vector<double> result(knots, 0.0);
    double before_N = 0.0;  // where no mean is, as beside it
    for (std::size_t j = 0; j < knots; ++j) {
      if (weights[side][j] > 0.0) before_N = std::sqrt(std::max(0.0, squares[side][j] / weights[side][j]));
      result[j] = before_N;
    }
    return result;
  };
  response.left_N = left(0);
  response.left_side_N = left(1);
}

double apparent_lag_s(const Response& response, const ResponseCurves& curves) {
  // A force that is late by the lag is a(d(t - lag)) = a(d) - lag a'(d) d' to first order, so that the part of the rate
  // is b = -lag a'. Least squares over the stretches between knots: lag = -sum w a' b / sum w a'^2. The weight is the
  // information that the samples have on b: its normal equation holds the sum of their d'^2, `seen` times the mean
  // square.
  const auto& a = curves.normal_N;
  const auto& b = curves.normal_N_s_per_m;
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
      std::min(static_cast<std::size_t>(std::min(at, static_cast<double>(most_knots))), response.knots() - 2);
  const double share = std::min(at - static_cast<double>(j), 1.0);
  const double gain = response.gain.of(felt, i);
  const auto value = [j, share, gain](const std::vector<double>& curve) {
    return gain * (curve[j] + share * (curve[j + 1] - curve[j]));
  };
  return {value(c.normal_N) + value(c.normal_N_s_per_m) * felt.rate_of_depth_m_per_s[i],
          value(c.side_N[0]) + value(c.friction_N) * felt.slide_x[i],
          value(c.side_N[1]) + value(c.friction_N) * felt.slide_y[i]};
}

}  // namespace touchstone::perception
