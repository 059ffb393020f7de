#include "harness/perception/subjective/psychological_scale.h"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>

#include "harness/base/error.h"
#include "harness/stats/distributions.h"
#include "harness/stats/summary.h"

namespace touchstone::perception {
namespace {

double logistic(double x) { return 1.0 / (1.0 + std::exp(-x)); }

// Which conditions can be reached from the first by following `edges(i, j) > 0`.
std::vector<bool> reached(const Eigen::MatrixXd& edges) {
  std::vector<bool> seen(static_cast<std::size_t>(edges.rows()), false);
  std::vector<Eigen::Index> open{0};
  seen[0] = true;
  while (!open.empty()) {
    const Eigen::Index i = open.back();
    open.pop_back();
    for (Eigen::Index j = 0; j < edges.cols(); ++j) {
      if (edges(i, j) > 0.0 && !seen[static_cast<std::size_t>(j)]) {
        seen[static_cast<std::size_t>(j)] = true;
        open.push_back(j);
      }
    }
  }
  return seen;
}

void check_connected(const PairedComparisons& comparisons) {
  if (comparisons.conditions.size() < 2) throw BadData("a psychological scale needs at least two conditions");
  const Eigen::MatrixXd w = comparisons.wins();
  const auto seen = reached(w + w.transpose());
  const auto lost = std::find(seen.begin(), seen.end(), false);
  if (lost != seen.end()) {
    throw BadData(fmt::format("'{}' was never compared with '{}', not even by way of others: they have no common scale",
                              comparisons.conditions[static_cast<std::size_t>(lost - seen.begin())],
                              comparisons.conditions[0]));
  }
}

// Every condition beaten by every other, directly or by way of others (Ford 1957): then the maximum is finite.
bool strongly_connected(const Eigen::MatrixXd& wins) {
  const auto all = [](const std::vector<bool>& seen) {
    return std::all_of(seen.begin(), seen.end(), [](bool s) { return s; });
  };
  return all(reached(wins)) && all(reached(wins.transpose()));
}

struct BradleyTerryFit {
  Eigen::VectorXd parameters;  // b_0 .. b_{n-1} (mean 0), g
  bool firth = false;
};

BradleyTerryFit fit_bradley_terry(const PairedComparisons& comparisons) {
  const auto n = static_cast<Eigen::Index>(comparisons.conditions.size());
  const Eigen::MatrixXd first_wins = comparisons.wins_as_first();
  const Eigen::MatrixXd wins = comparisons.wins();
  const Eigen::MatrixXd second_wins = (wins - first_wins).transpose();  // (i, j): i came first and j was chosen
  // The order term too needs answers of both kinds.
  const bool finite = strongly_connected(wins) && first_wins.sum() > 0.0 && second_wins.sum() > 0.0;
  BradleyTerryFit fit{Eigen::VectorXd::Zero(n + 1), !finite};
  // b_0 is held at 0 while fitting; the mean is taken out afterwards.
  for (int iteration = 0; iteration < 200; ++iteration) {
    Eigen::MatrixXd information = Eigen::MatrixXd::Zero(n, n);  // of b_1 .. b_{n-1}, g
    std::vector<Eigen::VectorXd> designs;
    std::vector<double> weights;
    std::vector<double> residuals;
    std::vector<double> totals;
    std::vector<double> chances;
    for (Eigen::Index i = 0; i < n; ++i) {
      for (Eigen::Index j = 0; j < n; ++j) {
        const double total = first_wins(i, j) + second_wins(i, j);
        if (total == 0.0) continue;
        Eigen::VectorXd x = Eigen::VectorXd::Zero(n);
        if (i > 0) x(i - 1) = 1.0;
        if (j > 0) x(j - 1) = -1.0;
        x(n - 1) = 1.0;
        const double p = logistic(fit.parameters(i) - fit.parameters(j) + fit.parameters(n));
        designs.push_back(x);
        weights.push_back(total * p * (1.0 - p));
        residuals.push_back(first_wins(i, j) - total * p);
        totals.push_back(total);
        chances.push_back(p);
        information += weights.back() * x * x.transpose();
      }
    }
    // With one order only, the order term may not be identified: the smallest ridge keeps it at 0 then.
    information.diagonal().array() += 1e-12 * information.trace();
    const Eigen::LDLT<Eigen::MatrixXd> solver(information);
    Eigen::VectorXd score = Eigen::VectorXd::Zero(n);
    for (std::size_t c = 0; c < designs.size(); ++c) {
      double residual = residuals[c];
      if (fit.firth) {
        const double leverage = weights[c] * designs[c].dot(solver.solve(designs[c]));
        residual += leverage * (0.5 - chances[c]);
      }
      score += residual * designs[c];
    }
    Eigen::VectorXd step = solver.solve(score);
    const double longest = step.cwiseAbs().maxCoeff();
    if (longest > 1.0) step /= longest;
    fit.parameters.segment(1, n - 1) += step.head(n - 1);
    fit.parameters(n) += step(n - 1);
    if (longest < 1e-12) break;
  }
  fit.parameters.head(n).array() -= fit.parameters.head(n).mean();
  return fit;
}

std::vector<double> fit_thurstone(const PairedComparisons& comparisons) {
  const Eigen::MatrixXd w = comparisons.wins();
  std::vector<double> values(static_cast<std::size_t>(w.rows()), 0.0);
  for (Eigen::Index i = 0; i < w.rows(); ++i) {
    for (Eigen::Index j = 0; j < w.cols(); ++j) {
      const double n = w(i, j) + w(j, i);
      if (i == j) continue;
      if (n == 0.0) {
        throw BadData(fmt::format("'{}' and '{}' were never compared; Thurstone's case V needs every pair",
                                  comparisons.conditions[static_cast<std::size_t>(i)],
                                  comparisons.conditions[static_cast<std::size_t>(j)]));
      }
      values[static_cast<std::size_t>(i)] +=
          stats::normal_quantile((w(i, j) + 0.5) / (n + 1.0)) / static_cast<double>(w.rows());
    }
  }
  return values;
}

// Standard errors by leaving out one subject at a time; the last of each estimate's entries may be the order effect.
template <class Fit>
std::vector<double> jackknife(const PairedComparisons& comparisons, Fit fit) {
  const std::size_t subjects = comparisons.subjects.size();
  if (subjects < 2) return {};
  std::vector<std::vector<double>> estimates;
  for (std::size_t s = 0; s < subjects; ++s) {
    const PairedComparisons others = comparisons.without_subject(s);
    if (((others.wins() + others.wins().transpose()).array() > 0.0).count() <
        ((comparisons.wins() + comparisons.wins().transpose()).array() > 0.0).count()) {
      return {};  // only this subject compared some pair
    }
    estimates.push_back(fit(others));
  }
  std::vector<double> errors;
  for (std::size_t v = 0; v < estimates.front().size(); ++v) {
    std::vector<double> column;
    column.reserve(estimates.size());
    for (const auto& estimate : estimates) column.push_back(estimate[v]);
    errors.push_back(stats::standard_deviation(column) * std::sqrt(static_cast<double>(subjects - 1)));
  }
  return errors;
}

double cell_deviance(double observed, double expected) {
  return observed > 0.0 ? 2.0 * observed * std::log(observed / expected) : 0.0;
}

}  // namespace

std::string_view name_of(ScaleModel model) {
  return model == ScaleModel::thurstone_case_v ? "Thurstone case V" : "Bradley-Terry with order term";
}

PsychologicalScale thurstone_case_v(const PairedComparisons& comparisons) {
  check_connected(comparisons);
  PsychologicalScale scale;
  scale.model = ScaleModel::thurstone_case_v;
  scale.value = fit_thurstone(comparisons);
  scale.standard_error = jackknife(comparisons, fit_thurstone);
  const Eigen::MatrixXd w = comparisons.wins();
  bool extreme = false;
  for (Eigen::Index i = 0; i < w.rows(); ++i) {
    for (Eigen::Index j = i + 1; j < w.cols(); ++j) {
      const double n = w(i, j) + w(j, i);
      extreme = extreme || w(i, j) == 0.0 || w(j, i) == 0.0;
      const double expected =
          stats::normal_cdf(scale.value[static_cast<std::size_t>(i)] - scale.value[static_cast<std::size_t>(j)]);
      // Mosteller: the arcsine of the root of a proportion has the variance 1 / (4 n) whatever the proportion.
      const double difference = std::asin(std::sqrt(w(i, j) / n)) - std::asin(std::sqrt(expected));
      scale.misfit += 4.0 * n * difference * difference;
    }
  }
  const auto n = static_cast<double>(w.rows());
  scale.degrees_of_freedom = 0.5 * (n - 1.0) * (n - 2.0);
  if (scale.degrees_of_freedom > 0.0) scale.misfit_p = stats::chi_squared_tail(scale.misfit, scale.degrees_of_freedom);
  if (extreme) scale.remark = "unanimous pairs: every proportion is taken as (wins + 1/2) / (n + 1)";
  return scale;
}

PsychologicalScale bradley_terry(const PairedComparisons& comparisons) {
  check_connected(comparisons);
  const auto estimate = [](const PairedComparisons& own) {
    const BradleyTerryFit fit = fit_bradley_terry(own);
    return std::vector<double>(fit.parameters.data(), fit.parameters.data() + fit.parameters.size());
  };
  const BradleyTerryFit fit = fit_bradley_terry(comparisons);
  const auto n = static_cast<std::size_t>(fit.parameters.size() - 1);
  PsychologicalScale scale;
  scale.value.assign(fit.parameters.data(), fit.parameters.data() + n);
  scale.order_effect = fit.parameters(static_cast<Eigen::Index>(n));
  scale.standard_error = jackknife(comparisons, estimate);
  if (!scale.standard_error.empty()) {
    scale.order_effect_error = scale.standard_error.back();
    scale.standard_error.pop_back();
  }
  const Eigen::MatrixXd first_wins = comparisons.wins_as_first();
  const Eigen::MatrixXd second_wins = (comparisons.wins() - first_wins).transpose();
  double cells = 0.0;
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = 0; j < n; ++j) {
      const auto r = static_cast<Eigen::Index>(i);
      const auto c = static_cast<Eigen::Index>(j);
      const double total = first_wins(r, c) + second_wins(r, c);
      if (total == 0.0) continue;
      const double p = logistic(scale.value[i] - scale.value[j] + scale.order_effect);
      scale.misfit += cell_deviance(first_wins(r, c), total * p) + cell_deviance(second_wins(r, c), total * (1.0 - p));
      cells += 1.0;
    }
  }
  scale.degrees_of_freedom = std::max(0.0, cells - static_cast<double>(n));
  if (scale.degrees_of_freedom > 0.0) scale.misfit_p = stats::chi_squared_tail(scale.misfit, scale.degrees_of_freedom);
  if (fit.firth) scale.remark = "some conditions always won or lost: Firth's reduction of bias keeps the values finite";
  return scale;
}

double expected_preference(const PsychologicalScale& scale, double difference) {
  if (scale.model == ScaleModel::thurstone_case_v) return stats::normal_cdf(difference);
  return 0.5 * (logistic(difference + scale.order_effect) + logistic(difference - scale.order_effect));
}

double expected_fraction(const PsychologicalScale& scale, double v) {
  double sum = 0.0;
  for (const double other : scale.value) sum += expected_preference(scale, v - other);
  return sum / static_cast<double>(scale.value.size());
}

double expected_fraction_of(const PsychologicalScale& scale, std::size_t condition) {
  double sum = 0.0;
  for (std::size_t j = 0; j < scale.value.size(); ++j) {
    if (j != condition) sum += expected_preference(scale, scale.value[condition] - scale.value[j]);
  }
  return sum / static_cast<double>(scale.value.size() - 1);
}

}  // namespace touchstone::perception
