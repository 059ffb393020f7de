#include "harness/discrepancy/nearby_fits.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "harness/base/error.h"
#include "harness/base/least_squares.h"
#include "harness/discrepancy/huber_loss.h"

namespace touchstone::discrepancy {
using rendering::Model;

namespace {

// Whitened residuals of what was measured, without Huber's loss; nothing if the model cannot run.
std::optional<Eigen::VectorXd> plain_residuals(const FitData& data, const std::vector<Vec3>& measured_N,
                                               const Model& model) {
  try {
    const auto means = block_means(data.blocks, data.predictor->predict(model).f_W_N);
    Eigen::VectorXd left(static_cast<Eigen::Index>(3 * means.size()));
    for (std::size_t b = 0; b < means.size(); ++b)
      left.segment<3>(static_cast<Eigen::Index>(3 * b)) = whitened(measured_N[b] - means[b], data.noise[b]);
    if (left.allFinite()) return left;
  } catch (const BadData&) {
    // Outside of what the model accepts.
  }
  return std::nullopt;
}

double robust_sum(const Eigen::VectorXd& left) {
  double sum = 0.0;
  for (Eigen::Index row = 0; row < left.size(); row += 3) sum += huber_loss(left.segment<3>(row).squaredNorm());
  return sum;
}

// Of the least squares of the step from u within the bounds: what would cross one stays there, the others make up for
// it.
Eigen::VectorXd bounded_step(const Eigen::MatrixXd& curvature, const Eigen::VectorXd& slope, const Eigen::VectorXd& u,
                             const std::vector<FreeParameter>& parameters) {
  const Eigen::Index n = u.size();
  Eigen::VectorXd step = Eigen::VectorXd::Zero(n);
  std::vector<Eigen::Index> inside(static_cast<std::size_t>(n));
  for (Eigen::Index i = 0; i < n; ++i) inside[static_cast<std::size_t>(i)] = i;
  while (!inside.empty()) {
    const Eigen::VectorXd wanted = -slope - curvature * step;
    Eigen::VectorXd changes = Eigen::VectorXd::Zero(n);
    const Eigen::MatrixXd own = curvature(inside, inside);
    const Eigen::VectorXd solved = solve_symmetric(own, wanted(inside));
    changes(inside) = solved;
    const auto held = std::erase_if(inside, [&](Eigen::Index i) {
      const FreeParameter& parameter = parameters[static_cast<std::size_t>(i)];
      const double bounded = std::clamp(u[i] + step[i] + changes[i], parameter.lower, parameter.upper) - u[i];
      const bool crosses = bounded != step[i] + changes[i] && std::abs(bounded - step[i] - changes[i]) > 1e-12;
      if (crosses) step[i] = bounded;
      return crosses;
    });
    if (held > 0) continue;
    return step + changes;
  }
  return step;
}

}  // namespace

NearbyFits::NearbyFits(const FitData& data, const Model& model, const std::vector<FreeParameter>& parameters)
    : data_(&data), parameters_(&parameters) {
  const bool field = std::any_of(parameters.begin(), parameters.end(), [](const auto& p) { return p.coefficient; });
  if (field || time_is_up(data)) return;
  const auto n = static_cast<Eigen::Index>(parameters.size());
  derivatives_.resize(static_cast<Eigen::Index>(3 * data.blocks.size()), n);
  const auto here = plain_residuals(data, data.measured_N, model);
  if (!here) return;
  for (Eigen::Index i = 0; i < n; ++i) {
    const FreeParameter& parameter = parameters[static_cast<std::size_t>(i)];
    const double u = std::clamp(parameter.get(model), parameter.lower, parameter.upper);
    const double high = std::min(parameter.upper, u + (parameter.step > 0.0 ? parameter.step : derivative_step));
    const double low = parameter.step > 0.0 || high <= u
                           ? std::max(parameter.lower, u - std::max(parameter.step, derivative_step))
                           : u;
    Model moved = model;
    parameter.set(moved, high);
    const auto above = high > u ? plain_residuals(data, data.measured_N, moved) : here;
    parameter.set(moved, low);
    const auto below = low < u ? plain_residuals(data, data.measured_N, moved) : here;
    if (!above || !below || !(high > low)) return;
    derivatives_.col(i) = (*above - *below) / (high - low);
  }
  usable_ = true;
}

JointFit NearbyFits::fit(const std::vector<Vec3>& measured_N, const Model& start, int steps) const {
  const std::vector<FreeParameter>& parameters = *parameters_;
  const auto n = static_cast<Eigen::Index>(parameters.size());
  JointFit fit;
  fit.model = start;
  fit.u.resize(n);
  const auto at = [&](const Eigen::VectorXd& u) {
    Model model = start;
    for (Eigen::Index i = 0; i < n; ++i) parameters[static_cast<std::size_t>(i)].set(model, u[i]);
    return model;
  };
  for (Eigen::Index i = 0; i < n; ++i) {
    const FreeParameter& parameter = parameters[static_cast<std::size_t>(i)];
    fit.u[i] = std::clamp(parameter.get(start), parameter.lower, parameter.upper);
  }
  auto left = plain_residuals(*data_, measured_N, at(fit.u));
  if (!left || !usable_) return fit;
  double sum = robust_sum(*left);
  for (int taken = 0; taken < steps && !time_is_up(*data_); ++taken) {
    Eigen::VectorXd weights(left->size());
    for (Eigen::Index row = 0; row < left->size(); row += 3) {
      const double square = left->segment<3>(row).squaredNorm();
      weights.segment<3>(row).setConstant(huber_weight(square));
    }
    Eigen::MatrixXd curvature = derivatives_.transpose() * weights.asDiagonal() * derivatives_;
    // What the recording does not determine stays where it is.
    constexpr double damping = 1e-8;
    curvature.diagonal() *= 1.0 + damping;
    curvature.diagonal().array() += 1e-300 + damping * damping * curvature.diagonal().maxCoeff();
    const Eigen::VectorXd slope = derivatives_.transpose() * weights.cwiseProduct(*left);
    Eigen::VectorXd step = bounded_step(curvature, slope, fit.u, parameters);
    bool better = false;
    double decrease = 0.0;
    constexpr int shortenings = 3;
    for (int shorter = 0; shorter <= shortenings && !better; ++shorter, step *= 0.5) {
      const Eigen::VectorXd there = fit.u + step;
      const auto then = plain_residuals(*data_, measured_N, at(there));
      if (!then) continue;
      decrease = sum - robust_sum(*then);
      if (!(decrease > 0.0)) continue;
      better = true;
      fit.u = there;
      left = then;
      sum -= decrease;
    }
    if (!better || decrease < least_decrease * sum) break;
  }
  fit.model = at(fit.u);
  fit.chi_squared = sum;
  fit.ok = std::isfinite(sum);
  return fit;
}

}  // namespace touchstone::discrepancy
