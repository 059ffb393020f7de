#include "harness/discrepancy/parameter_intervals.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "harness/base/in_parallel.h"
#include "harness/discrepancy/nearby_fits.h"
#include "harness/stats/distributions.h"
#include "harness/stats/summary.h"

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

// What the value would be at positions without noise, from what it is and what it is with `more` of the noise's
// variance, of which the recording has `excess`.
double without_noise(double here, double noisier, double excess, const Scale& scale) {
  constexpr double weakest = 0.05;  // share left: beyond, nothing is known of the size
  const double change = excess * (noisier - here);
  if (scale.logarithmic || !(change * here < 0.0)) return here - change;
  if (!(noisier * here > 0.0)) return here / weakest;
  return here / std::clamp(1.0 - excess * (here / noisier - 1.0), weakest, 1.0);
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

std::vector<rendering::Model> noisier_fits(const Evidence& train, const FitData& data, const JointFit& fit,
                                           const std::vector<FreeParameter>& parameters, int iterations) {
  std::vector<std::optional<rendering::Model>> fits(NoiseModel::replica_count);
  const auto at_replica = [&](std::size_t replica) {
    if (data.budget != nullptr && !data.budget->allows("what noise in the positions does to the values")) return;
    FitData again = data;
    again.predictor = &train.noise->noisier_predictor(replica);
    const NearbyFits nearby(again, fit.model, parameters);
    JointFit refitted = nearby.usable() ? nearby.fit(again.measured_N, fit.model, iterations)
                                        : fit_jointly(again, fit.model, parameters, iterations, false);
    if (refitted.ok && !time_is_up(data)) fits[replica] = std::move(refitted.model);
  };
  in_parallel(fits.size(), at_replica, 1);
  std::vector<rendering::Model> usable;
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
                    double excess, const std::vector<rendering::Model>& noisier) {
  const auto free = std::find_if(parameters.begin(), parameters.end(),
                                 [&](const FreeParameter& p) { return p.owner == effect && p.name == name; });
  const auto value_in = [&](const rendering::Model& model) { return find_entry(model, effect)->parameters.at(name); };
  const double value = value_in(fit.model);
  // What nothing free moves was read (see ReadValues), or has no width.
  const bool read = free == parameters.end() && !(fitted_variance(fit, parameters, effect, name, {false}) > 0.0);
  const Scale scale{read ? value > 0.0 &&
                               std::ranges::all_of(draws, [&](const auto& d) { return value_in(d.model) > 0; })
                         : free != parameters.end() && free->logarithmic};
  const double here = scale.to(value);
  double variance = fitted_variance(fit, parameters, effect, name, scale);
  double quantile = normal_quantile;
  if (draws.size() >= fewest_draws) {
    const double n = static_cast<double>(draws.size());
    std::vector<double> fitted(draws.size());
    std::ranges::transform(draws, fitted.begin(), [&](const NullFit& draw) { return scale.to(value_in(draw.model)); });
    const double deviation = stats::standard_deviation(fitted);
    quantile = stats::student_t_975(n - 1.0);
    variance = std::max(variance, excess * deviation * deviation * n / (n - 1.0)) * (1.0 + 1.0 / n);
  }
  std::vector<double> at_noisier(noisier.size());
  std::ranges::transform(noisier, at_noisier.begin(), [&](const auto& model) { return scale.to(value_in(model)); });
  const double there = noisier.empty() ? here : without_noise(here, stats::mean(at_noisier), excess, scale);
  const double half = quantile * std::sqrt(variance);
  // What noise weakens by a share, it weakens the error of by the same.
  const double beyond = scale.logarithmic || here == 0.0 ? half : half * std::max(1.0, there / here);
  return {scale.from(std::min(here - half, there - beyond)), scale.from(std::max(here + half, there + beyond))};
}

double least_size95(const JointFit& fit, const std::vector<FreeParameter>& parameters,
                    const std::vector<NullFit>& draws, const std::string& effect, const std::string& name) {
  const Interval interval = interval95(fit, parameters, draws, effect, name);
  return interval.low * interval.high > 0.0 ? std::min(std::abs(interval.low), std::abs(interval.high)) : 0.0;
}

}  // namespace touchstone::discrepancy
