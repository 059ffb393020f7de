#include "harness/perception/filters/dead_band.h"

#include <fmt/format.h>

#include <cmath>

#include "harness/base/error.h"

namespace touchstone::perception {
namespace {

template <class Fraction>
SparseSeries filter(std::span<const double> x, double threshold, Fraction fraction) {
  SparseSeries result;
  result.held.reserve(x.size());
  const auto felt = [threshold](double value) { return std::abs(value) < threshold ? 0.0 : value; };
  double held = 0.0;
  for (std::size_t t = 0; t < x.size(); ++t) {
    const double value = felt(x[t]);
    const bool noticed = held == 0.0 ? value != 0.0 : std::abs(x[t] - held) > fraction(t, held) * std::abs(held);
    if (t == 0 || (noticed && value != held)) {
      held = value;
      result.kept.push_back(t);
    }
    result.held.push_back(held);
  }
  return result;
}

}  // namespace

SparseSeries dead_band(std::span<const double> stimulus, const WeberLaw& law) {
  return filter(stimulus, law.absolute_threshold, [&law](std::size_t, double held) { return law.fraction(held); });
}

SparseSeries displacement_dead_band(std::span<const double> displacement_m, std::span<const double> force_N,
                                    const WeberLaw& force_law, double absolute_threshold_m) {
  if (displacement_m.size() != force_N.size()) {
    throw BadData(
        fmt::format("{} displacements for {} forces: the dead band of displacement needs both of every moment",
                    displacement_m.size(), force_N.size()));
  }
  return filter(displacement_m, absolute_threshold_m,
                [&](std::size_t t, double) { return force_law.fraction(force_N[t]); });
}

}  // namespace touchstone::perception
