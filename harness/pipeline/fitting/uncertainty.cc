#include "harness/pipeline/fitting/uncertainty.h"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numeric>

#include "harness/stats/distributions.h"
#include "harness/stats/quantile.h"
#include "harness/stats/sandwich.h"

namespace touchstone::pipeline {
namespace {

double median_step(const std::vector<double>& t_s) {
  std::vector<double> steps;
  for (std::size_t i = 1; i < t_s.size(); ++i) steps.push_back(t_s[i] - t_s[i - 1]);
  return stats::upper_median(std::move(steps));
}

double sum(const std::vector<double>& values, std::size_t begin, std::size_t end) {
  return std::accumulate(values.begin() + static_cast<std::ptrdiff_t>(begin),
                         values.begin() + static_cast<std::ptrdiff_t>(end), 0.0);
}

// Sums of the loss over the blocks.
Eigen::VectorXd block_sums(const std::vector<double>& loss, const std::vector<std::size_t>& starts) {
  Eigen::VectorXd out(static_cast<Eigen::Index>(starts.size()));
  for (std::size_t b = 0; b < starts.size(); ++b) {
    out[static_cast<Eigen::Index>(b)] = sum(loss, starts[b], b + 1 < starts.size() ? starts[b + 1] : loss.size());
  }
  return out;
}

}  // namespace

std::vector<std::size_t> independent_blocks(const std::vector<double>& loss, const std::vector<double>& t_s,
                                            double& block_s) {
  const std::size_t n = loss.size();
  const double step = median_step(t_s);
  std::vector<double> size(n);
  std::ranges::transform(loss, size.begin(), [](double one) { return std::sqrt(std::max(one, 0.0)); });
  const double mean = sum(size, 0, n) / static_cast<double>(n);
  const auto correlation = [&](std::size_t lag) {
    double out = 0.0;
    for (std::size_t i = 0; i + lag < n; ++i) out += (size[i] - mean) * (size[i + lag] - mean);
    return out;
  };
  const double variance = correlation(0);
  std::size_t lag = 1;
  while (variance > 0.0 && lag < n / 20 && correlation(lag) > variance / std::exp(1.0)) ++lag;
  const double sampled_s = step * static_cast<double>(n);
  block_s = std::min(20.0 * step * static_cast<double>(lag), sampled_s / 20.0);
  std::vector<std::size_t> starts{0};
  for (std::size_t i = 1; i < n; ++i) {
    if (t_s[i] - t_s[starts.back()] >= block_s || t_s[i] - t_s[i - 1] > 10.0 * step) starts.push_back(i);
  }
  return starts;
}

Uncertainty sandwich_uncertainty(const LossFunction& loss, const std::vector<double>& best_u,
                                 const std::vector<double>& t_s) {
  Uncertainty out;
  const auto n = static_cast<Eigen::Index>(best_u.size());
  const std::vector<double> at_best = loss(best_u);
  if (at_best.empty() || t_s.size() < 100) {
    out.why_not = at_best.empty() ? "this metric is not a mean over samples" : "fewer than 100 samples";
    return out;
  }
  const std::vector<std::size_t> starts = independent_blocks(at_best, t_s, out.block_s);
  out.blocks = starts.size();
  if (static_cast<Eigen::Index>(out.blocks) < n + 5) {
    out.why_not = fmt::format("only {} blocks of time can be told apart", out.blocks);
    return out;
  }
  // A step that is large beside rounding and small beside the search range, kept inside the bounds.
  constexpr double step = 2e-3;
  const auto shifted = [&](Eigen::Index i, double by, Eigen::Index j = -1, double by_j = 0.0) {
    std::vector<double> u = best_u;
    u[static_cast<std::size_t>(i)] += by;
    if (j >= 0) u[static_cast<std::size_t>(j)] += by_j;
    return u;
  };
  for (const double u : best_u) {
    if (u < step || u > 1.0 - step) {
      out.why_not = "the minimum lies on a bound of the search";
      return out;
    }
  }
  const Eigen::VectorXd middle = block_sums(at_best, starts);
  Eigen::MatrixXd gradients(middle.size(), n);
  Eigen::MatrixXd hessian(n, n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const Eigen::VectorXd up = block_sums(loss(shifted(i, step)), starts);
    const Eigen::VectorXd down = block_sums(loss(shifted(i, -step)), starts);
    gradients.col(i) = (up - down) / (2.0 * step);
    hessian(i, i) = (up.sum() - 2.0 * middle.sum() + down.sum()) / (step * step);
  }
  for (Eigen::Index i = 0; i < n; ++i) {
    for (Eigen::Index j = 0; j < i; ++j) {
      const auto total = [&](double a, double b) { return block_sums(loss(shifted(i, a, j, b)), starts).sum(); };
      hessian(i, j) = hessian(j, i) =
          (total(step, step) - total(step, -step) - total(-step, step) + total(-step, -step)) / (4.0 * step * step);
    }
  }
  const Eigen::LLT<Eigen::MatrixXd> factored(hessian);
  if (factored.info() != Eigen::Success) {
    out.why_not = "the loss does not curve upward at the minimum: the recording does not determine the parameters";
    return out;
  }
  const auto blocks = static_cast<double>(out.blocks);
  const Eigen::MatrixXd centred = gradients.rowwise() - gradients.colwise().mean();
  const Eigen::MatrixXd inverse = factored.solve(Eigen::MatrixXd::Identity(n, n));
  const Eigen::MatrixXd covariance = stats::sandwich_covariance(inverse, centred) * (blocks / (blocks - 1.0));
  const double t = stats::student_t_975(blocks - static_cast<double>(n));
  for (Eigen::Index i = 0; i < n; ++i) {
    const double sigma = std::sqrt(covariance(i, i));
    out.sigma_u.push_back(sigma);
    out.low_u.push_back(std::max(0.0, best_u[static_cast<std::size_t>(i)] - t * sigma));
    out.high_u.push_back(std::min(1.0, best_u[static_cast<std::size_t>(i)] + t * sigma));
  }
  out.known = true;
  return out;
}

}  // namespace touchstone::pipeline
