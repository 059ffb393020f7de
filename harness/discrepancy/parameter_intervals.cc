#include "harness/discrepancy/parameter_intervals.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "harness/base/in_parallel.h"
#include "harness/discrepancy/nearby_fits.h"
#include "harness/stats/distributions.h"

namespace touchstone::discrepancy {
namespace {

constexpr double normal_quantile = 1.96;

// A scale on which an interval is symmetrical: the logarithm for scales and time constants.
struct Scale {
  bool logarithmic;
  [[nodiscard]] double to(double value) const { return logarithmic ? std::log(value) : value; }
  [[nodiscard]] double from(double value) const { return logarithmic ? std::exp(value) : value; }
};

// Variance by the fit's covariance, through the model: u may be an excess over another parameter.
double fitted_variance(const JointFit& fit, const std::vector<FreeParameter>& parameters, const std::string& effect,
                       const std::string& name, const Scale& scale) {
  constexpr double step = 1e-4;
  const auto n = static_cast<Eigen::Index>(parameters.size());
  if (fit.covariance.rows() != n) return 0.0;
  const double here = scale.to(find_entry(fit.model, effect)->parameters.at(name));
  Eigen::VectorXd gradient(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const FreeParameter& free = parameters[static_cast<std::size_t>(i)];
    const double h = fit.u[i] + step > free.upper ? -step : step;
    rendering::Model moved = fit.model;
    free.set(moved, fit.u[i] + h);
    gradient[i] = (scale.to(find_entry(moved, effect)->parameters.at(name)) - here) / h;
  }
  return gradient.dot(fit.covariance * gradient);
}

// How far the truth may lie from a fitted value on the side from which fits are drawn away. Noise in the positions
// weakens a coefficient by a share of itself, so that the truth is beyond by more than a world shows whose truth is the
// weakened value: a mass whose acceleration drowns in noise comes out at a fifth, and in its simulated recordings at a
// twenty-fifth.
double bias_of_truth(double here, double bias, const Scale& scale) {
  constexpr double weakest = 0.05;  // share left: beyond, nothing is known of the size
  const double size = std::abs(bias);
  const bool weakens = bias * here < 0.0;
  if (scale.logarithmic || !weakens || size >= std::abs(here)) return size;
  const double left = std::max(weakest, 1.0 - size / std::abs(here));
  return std::abs(here) * (1.0 / left - 1.0);
}

}  // namespace

std::vector<NullFit> bootstrap_fits(const Evidence& train, const FitData& data, const JointFit& fit,
                                    const std::vector<FreeParameter>& parameters, int iterations,
                                    const ReadValues& read) {
  const rendering::Prediction nominal = train.predictor->predict(fit.model);
  const NearbyFits nearby(data, fit.model, parameters);
  std::vector<std::optional<NullFit>> fits(NoiseModel::null_simulations);
  const auto in_world = [&](std::size_t world) {
    if (data.budget != nullptr && !data.budget->allows("simulated recordings for the intervals")) return;
    FitData again = data;
    again.measured_N = block_means(data.blocks, train.noise->null_forces(fit.model, nominal, world));
    rendering::Model from = fit.model;
    if (read) read(from, world);
    JointFit refitted = nearby.usable() ? nearby.fit(again.measured_N, from, iterations)
                                        : fit_jointly(again, from, parameters, iterations, false);
    // One that ended with the time has not come as far as it would.
    if (refitted.ok && !time_is_up(data)) fits[world] = NullFit{world, std::move(refitted.model), refitted.chi_squared};
  };
  in_parallel(fits.size(), in_world, 1);
  std::vector<NullFit> usable;
  for (auto& one : fits) {
    if (one) usable.push_back(std::move(*one));
  }
  return usable;
}

double excess_over(const std::vector<NullFit>& draws, const JointFit& fit) {
  double mean = 0.0;
  for (const NullFit& draw : draws) mean += draw.chi_squared / static_cast<double>(draws.size());
  return mean > 0.0 ? std::max(1.0, fit.chi_squared / mean) : 1.0;
}

Interval interval95(const JointFit& fit, const std::vector<FreeParameter>& parameters,
                    const std::vector<NullFit>& draws, const std::string& effect, const std::string& name,
                    double excess) {
  const auto free = std::find_if(parameters.begin(), parameters.end(),
                                 [&](const FreeParameter& p) { return p.owner == effect && p.name == name; });
  const double value = find_entry(fit.model, effect)->parameters.at(name);
  const auto positive = [&](const NullFit& draw) { return find_entry(draw.model, effect)->parameters.at(name) > 0.0; };
  // What nothing free moves was read (see ReadValues), or has no width.
  const bool read = free == parameters.end() && !(fitted_variance(fit, parameters, effect, name, {false}) > 0.0);
  const Scale scale{read ? value > 0.0 && std::all_of(draws.begin(), draws.end(), positive)
                         : free != parameters.end() && free->logarithmic};
  const double here = scale.to(value);
  double variance = fitted_variance(fit, parameters, effect, name, scale);
  double bias = 0.0;
  double quantile = normal_quantile;
  if (draws.size() >= fewest_draws) {
    const double n = static_cast<double>(draws.size());
    for (const NullFit& draw : draws)
      bias += (scale.to(find_entry(draw.model, effect)->parameters.at(name)) - here) / n;
    double squares = 0.0;
    for (const NullFit& draw : draws) {
      const double off = scale.to(find_entry(draw.model, effect)->parameters.at(name)) - here - bias;
      squares += off * off;
    }
    bias *= excess;
    quantile = stats::student_t_975(n - 1.0);
    // The mean of a few simulated recordings is itself uncertain.
    variance = std::max(variance, excess * squares / (n - 1.0)) * (1.0 + 1.0 / n);
  }
  const double half = quantile * std::sqrt(variance);
  const double back = bias_of_truth(here, bias, scale);
  const double below = bias > 0.0 ? back : std::abs(bias);
  const double above = bias < 0.0 ? back : std::abs(bias);
  return {scale.from(here - half - below), scale.from(here + half + above)};
}

double least_size95(const JointFit& fit, const std::vector<FreeParameter>& parameters,
                    const std::vector<NullFit>& draws, const std::string& effect, const std::string& name) {
  const Interval interval = interval95(fit, parameters, draws, effect, name);
  return interval.low * interval.high > 0.0 ? std::min(std::abs(interval.low), std::abs(interval.high)) : 0.0;
}

}  // namespace touchstone::discrepancy
