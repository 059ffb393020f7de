#include "harness/discrepancy/joint_fit.h"

#include <ceres/ceres.h>
#include <glog/logging.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <optional>

#include "harness/base/error.h"
#include "harness/base/in_parallel.h"
#include "harness/discrepancy/field_prior.h"
#include "harness/discrepancy/huber_loss.h"
#include "harness/stats/sandwich.h"

namespace touchstone::discrepancy {
using rendering::Model;

namespace {

// The whitened, robustified residuals of all blocks.
void residuals(const FitData& data, const Model& model, double* out) {
  const rendering::Prediction prediction = data.predictor->predict(model);
  const auto means = block_means(data.blocks, prediction.f_W_N);
  for (std::size_t b = 0; b < means.size(); ++b) {
    const Vec3 e = whitened(data.measured_N[b] - means[b], data.noise[b]);
    const double square = e.squaredNorm();
    const double factor = huber_weight(square) < 1.0 ? std::sqrt(huber_loss(square) / square) : 1.0;
    Eigen::Map<Vec3>(out + 3 * b) = factor * e;
  }
}

class BlocksCost final : public ceres::CostFunction {
 public:
  BlocksCost(const FitData& data, const Model& start, const std::vector<FreeParameter>& parameters)
      : data_(data),
        start_(start),
        parameters_(parameters),
        has_field_(std::any_of(parameters.begin(), parameters.end(), [](const auto& p) { return p.coefficient; })) {
    set_num_residuals(static_cast<int>(3 * data.blocks.size() + prior_rows(start)));
    mutable_parameter_block_sizes()->push_back(static_cast<int>(parameters.size()));
  }

  bool Evaluate(double const* const* u, double* out, double** jacobians) const override {
    const auto rows = static_cast<Eigen::Index>(num_residuals());
    const auto columns = static_cast<Eigen::Index>(parameters_.size());
    const Eigen::VectorXd x = Eigen::Map<const Eigen::VectorXd>(u[0], columns);
    if (!last_ || last_->u != x) {
      Point point{x, Eigen::VectorXd(rows)};
      if (!evaluate(x, point.residuals.data())) return false;
      last_ = std::move(point);
    }
    Eigen::Map<Eigen::VectorXd>(out, rows) = last_->residuals;
    if (jacobians == nullptr || jacobians[0] == nullptr) return true;
    return differentiate(*last_, Eigen::Map<Jacobian>(jacobians[0], rows, columns));
  }

 private:
  using Jacobian = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

  // Where it was asked last: Ceres asks of a point for its line search, once it has gone there, and for the
  // derivatives. Those it asks for once, and keeps.
  struct Point {
    Eigen::VectorXd u;
    Eigen::VectorXd residuals;
  };

  // Derivatives by what moves the contact, each of which costs a search for contact or two, and where they were taken.
  struct Moving {
    Eigen::VectorXd u;
    std::vector<std::optional<Eigen::VectorXd>> columns;  // by parameter
  };

  // Whether none of what moves the contact has gone further since than the way over which its derivative was taken.
  [[nodiscard]] bool still_holds(const Moving& moving, const Eigen::VectorXd& u) const {
    constexpr double way = 0.02;  // of one that has no step of its own
    for (std::size_t i = 0; i < parameters_.size(); ++i) {
      if (!parameters_[i].moves_contact) continue;
      const auto c = static_cast<Eigen::Index>(i);
      if (std::abs(u[c] - moving.u[c]) > (parameters_[i].step > 0.0 ? parameters_[i].step : way)) return false;
    }
    return true;
  }

  bool differentiate(const Point& point, Eigen::Map<Jacobian> jacobian) const {
    std::atomic<bool> usable = true;
    if (!moving_ || !still_holds(*moving_, point.u))
      moving_ = Moving{point.u, std::vector<std::optional<Eigen::VectorXd>>(parameters_.size())};
    // A field has a hundred columns: these on all cores.
    const auto one = [&](std::size_t index) {
      const FreeParameter& parameter = parameters_[index];
      const auto c = static_cast<Eigen::Index>(index);
      if (moving_->columns[index]) {
        jacobian.col(c) = *moving_->columns[index];
        return;
      }
      const auto column = parameter.step > 0.0 ? across(point.u, c, parameter)
                                               : to_one_side(point.u, c, parameter, point.residuals.data());
      if (column) {
        jacobian.col(c) = *column;
        if (parameter.moves_contact) moving_->columns[index] = *column;
      } else {
        usable = false;
      }
    };
    in_parallel(parameters_.size(), one, has_field_ ? 1 : parameters_.size());
    return usable;
  }

  // Friction and contact make small kinks: a step well above them, inward at a bound.
  std::optional<Eigen::VectorXd> to_one_side(Eigen::VectorXd u, Eigen::Index c, const FreeParameter& parameter,
                                             const double* here) const {
    const double h = u[c] + derivative_step > parameter.upper ? -derivative_step : derivative_step;
    Eigen::VectorXd there(num_residuals());
    u[c] += h;
    if (!evaluate(u, there.data())) return std::nullopt;
    return (there - Eigen::Map<const Eigen::VectorXd>(here, num_residuals())) / h;
  }

  std::optional<Eigen::VectorXd> across(Eigen::VectorXd u, Eigen::Index c, const FreeParameter& parameter) const {
    const double low = std::max(parameter.lower, u[c] - parameter.step);
    const double high = std::min(parameter.upper, u[c] + parameter.step);
    Eigen::VectorXd below(num_residuals());
    Eigen::VectorXd above(num_residuals());
    u[c] = low;
    if (!evaluate(u, below.data())) return std::nullopt;
    u[c] = high;
    if (!evaluate(u, above.data())) return std::nullopt;
    return (above - below) / (high - low);
  }

  bool evaluate(const Eigen::VectorXd& u, double* out) const {
    Model model = start_;
    // Rounding may carry a step just across a bound, where a model file's check would refuse it.
    for (std::size_t i = 0; i < parameters_.size(); ++i) {
      parameters_[i].set(model,
                         std::clamp(u[static_cast<Eigen::Index>(i)], parameters_[i].lower, parameters_[i].upper));
    }
    try {
      residuals(data_, model, out);
      field_prior(model, out + 3 * data_.blocks.size());
    } catch (const BadData&) {
      return false;  // outside of what the model accepts: Ceres tries a shorter step
    }
    return Eigen::Map<const Eigen::VectorXd>(out, num_residuals()).allFinite();
  }

  const FitData& data_;
  const Model& start_;
  const std::vector<FreeParameter>& parameters_;
  const bool has_field_;
  // Of one fit, which is one thread's.
  mutable std::optional<Point> last_;
  mutable std::optional<Moving> moving_;
};

}  // namespace

std::vector<double> block_chi_squared(const FitData& data, const Model& model) {
  std::vector<double> out(3 * data.blocks.size());
  residuals(data, model, out.data());
  std::vector<double> squares(data.blocks.size());
  for (std::size_t b = 0; b < squares.size(); ++b)
    squares[b] = Eigen::Map<const Vec3>(out.data() + 3 * b).squaredNorm();
  return squares;
}

double chi_squared(const FitData& data, const Model& model) {
  double sum = 0.0;
  for (const double square : block_chi_squared(data, model)) sum += square;
  return sum;
}

Eigen::MatrixXd information_matrix(const FitData& data, const Model& model,
                                   const std::vector<FreeParameter>& parameters) {
  const auto n = static_cast<Eigen::Index>(parameters.size());
  if (n == 0) return {};
  Eigen::VectorXd u(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const FreeParameter& parameter = parameters[static_cast<std::size_t>(i)];
    u[i] = std::clamp(parameter.get(model), parameter.lower, parameter.upper);
  }
  const BlocksCost cost(data, model, parameters);
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> jacobian(cost.num_residuals(), n);
  Eigen::VectorXd out(cost.num_residuals());
  const double* point = u.data();
  double* rows = jacobian.data();
  if (!cost.Evaluate(&point, out.data(), &rows)) return {};
  return jacobian.transpose() * jacobian;
}

bool time_is_up(const FitData& data) {
  return data.budget != nullptr && !data.budget->allows("the last steps of a fit");
}

namespace {

// Ends a fit when time is up, or when the rest of its iterations will not bring it below a bar.
class EndsEarly final : public ceres::IterationCallback {
 public:
  EndsEarly(const FitData& data, double abandon_above, int iterations)
      : data_(data), abandon_cost_(0.5 * abandon_above), iterations_(iterations) {}

  ceres::CallbackReturnType operator()(const ceres::IterationSummary& now) override {
    // A step that was refused says nothing of the next one.
    if (now.iteration == 0 || now.step_is_successful) costs_.push_back(now.cost);
    return time_is_up(data_) || is_hopeless(now) ? ceres::SOLVER_TERMINATE_SUCCESSFULLY : ceres::SOLVER_CONTINUE;
  }

 private:
  [[nodiscard]] bool is_hopeless(const ceres::IterationSummary& now) const {
    constexpr std::size_t looked_back = 4;
    if (costs_.size() <= looked_back) return false;
    double largest = 0.0;
    for (std::size_t i = costs_.size() - looked_back; i < costs_.size(); ++i)
      largest = std::max(largest, costs_[i - 1] - costs_[i]);
    return costs_.back() - largest * std::max(0, iterations_ - now.iteration) > abandon_cost_;
  }

  const FitData& data_;
  double abandon_cost_;
  int iterations_;
  std::vector<double> costs_;
};

JointFit fit_below(double abandon_above, const FitData& data, BlocksCost& cost, const Model& start,
                   const std::vector<FreeParameter>& parameters, int iterations) {
  JointFit fit;
  const auto n = static_cast<Eigen::Index>(parameters.size());
  fit.u.resize(n);
  ceres::Problem::Options problem_options;
  problem_options.cost_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  ceres::Problem problem(problem_options);
  problem.AddResidualBlock(&cost, nullptr, fit.u.data());
  for (Eigen::Index i = 0; i < n; ++i) {
    const FreeParameter& parameter = parameters[static_cast<std::size_t>(i)];
    fit.u[i] = std::clamp(parameter.get(start), parameter.lower, parameter.upper);
    problem.SetParameterLowerBound(fit.u.data(), static_cast<int>(i), parameter.lower);
    problem.SetParameterUpperBound(fit.u.data(), static_cast<int>(i), parameter.upper);
  }
  ceres::Solver::Options options;
  options.max_num_iterations = iterations;
  // Of the hundreds of columns of a field a QR decomposition costs twice the normal equations, whose prior keeps them
  // well conditioned.
  constexpr Eigen::Index many = 40;
  options.linear_solver_type = n > many ? ceres::DENSE_NORMAL_CHOLESKY : ceres::DENSE_QR;
  options.function_tolerance = least_decrease;
  options.parameter_tolerance = 1e-6;
  options.logging_type = ceres::SILENT;
  // Within bounds every step ends with a line search. A cubic one asks for derivatives at each of its points, which
  // cost more than all else, and takes those of kinks at their word.
  options.line_search_interpolation_type = ceres::QUADRATIC;
  options.num_threads = 1;
  // A trial that the renderer refuses ends that trial; Ceres would also say so on stderr, to nobody's use.
  static const bool quiet = [] {
    FLAGS_minloglevel = google::GLOG_FATAL;
    return true;
  }();
  static_cast<void>(quiet);
  EndsEarly ends_early(data, abandon_above, iterations);
  options.callbacks.push_back(&ends_early);
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);

  fit.model = start;
  fit.at_bound.resize(parameters.size());
  for (Eigen::Index i = 0; i < n; ++i) {
    const FreeParameter& parameter = parameters[static_cast<std::size_t>(i)];
    parameter.set(fit.model, fit.u[i]);
    // u is of order one, however far its bounds are.
    const double near = 1e-6 * std::min(1.0, parameter.upper - parameter.lower);
    fit.at_bound[static_cast<std::size_t>(i)] =
        fit.u[i] <= parameter.lower + near || fit.u[i] >= parameter.upper - near;
  }
  fit.chi_squared = 2.0 * summary.final_cost;
  fit.ok = summary.IsSolutionUsable() && std::isfinite(fit.chi_squared);
  return fit;
}

}  // namespace

JointFit fit_jointly_below(double abandon_above, const FitData& data, const Model& start,
                           const std::vector<FreeParameter>& parameters, int iterations) {
  BlocksCost cost(data, start, parameters);
  return fit_below(abandon_above, data, cost, start, parameters, iterations);
}

JointFit fit_jointly(const FitData& data, const Model& start, const std::vector<FreeParameter>& parameters,
                     int iterations, bool with_covariance) {
  const auto n = static_cast<Eigen::Index>(parameters.size());
  BlocksCost cost(data, start, parameters);
  constexpr double any = std::numeric_limits<double>::infinity();
  JointFit fit = fit_below(any, data, cost, start, parameters, iterations);
  if (!with_covariance || !fit.ok) return fit;

  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> jacobian(cost.num_residuals(), n);
  Eigen::VectorXd out(cost.num_residuals());
  const double* point = fit.u.data();
  double* rows = jacobian.data();
  fit.ok = cost.Evaluate(&point, out.data(), &rows);
  if (!fit.ok) return fit;
  const Eigen::MatrixXd normal = jacobian.transpose() * jacobian;
  const Eigen::LDLT<Eigen::MatrixXd> curvature(normal);
  fit.ok =
      curvature.info() == Eigen::Success && curvature.vectorD().minCoeff() > 1e-12 * curvature.vectorD().maxCoeff();
  if (!fit.ok) return fit;
  const Eigen::MatrixXd inverse = curvature.solve(Eigen::MatrixXd::Identity(n, n));
  Eigen::MatrixXd scores(static_cast<Eigen::Index>(data.blocks.size()), n);
  for (Eigen::Index b = 0; b < scores.rows(); ++b)
    scores.row(b) = out.segment<3>(3 * b).transpose() * jacobian.middleRows<3>(3 * b);
  fit.covariance = stats::sandwich_covariance(inverse, stats::long_run_gradients(scores));
  const Eigen::VectorXd wider =
      inverse.diagonal().cwiseQuotient(fit.covariance.diagonal().cwiseMax(1e-300)).cwiseMax(1.0).cwiseSqrt();
  fit.covariance = Eigen::MatrixXd(wider.asDiagonal() * fit.covariance * wider.asDiagonal());
  return fit;
}

}  // namespace touchstone::discrepancy
