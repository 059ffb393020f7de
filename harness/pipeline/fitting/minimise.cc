#include "harness/pipeline/fitting/minimise.h"

#include <algorithm>
#include <array>
#include <nlopt.hpp>

#include "harness/base/error.h"

namespace touchstone::pipeline {
namespace {

constexpr double tolerance = 1e-7;  // of the unit cube
constexpr int most_evaluations = 400;
constexpr std::size_t searches = 3;

double halton(std::size_t index, unsigned base) {
  double out = 0.0;
  double digit = 1.0 / base;
  for (std::size_t i = index; i > 0; i /= base, digit /= base) out += digit * static_cast<double>(i % base);
  return out;
}

struct Counted {
  const UnitFunction* function = nullptr;
  int evaluations = 0;
};

double call(const std::vector<double>& u, std::vector<double>&, void* data) {
  auto* const counted = static_cast<Counted*>(data);
  ++counted->evaluations;
  return (*counted->function)(u);
}

}  // namespace

Minimum minimise_near(const UnitFunction& function, const std::vector<double>& start, double step) {
  Counted counted{&function};
  nlopt::opt search(start.size() == 1 ? nlopt::LN_COBYLA : nlopt::LN_BOBYQA, static_cast<unsigned>(start.size()));
  search.set_min_objective(call, &counted);
  search.set_lower_bounds(0.0);
  search.set_upper_bounds(1.0);
  search.set_initial_step(step);
  search.set_xtol_abs(tolerance);
  search.set_maxeval(most_evaluations);
  Minimum out{start, 0.0, 0};
  for (double& u : out.u) u = std::clamp(u, 0.0, 1.0);
  try {
    search.optimize(out.u, out.value);
  } catch (const nlopt::roundoff_limited&) {
    // The best point so far is as good as rounding lets it be.
    out.value = function(out.u);
  }
  out.evaluations = counted.evaluations;
  return out;
}

Minimum minimise(const UnitFunction& function, const std::vector<double>& first) {
  const std::size_t n = first.size();
  constexpr std::array bases{2u, 3u, 5u, 7u, 11u, 13u};
  if (n == 0 || n > bases.size()) throw UsageError("a fit takes between one and six parameters");
  std::vector<Minimum> looks{{first, function(first), 1}};
  const std::size_t count = n == 1 ? 24 : 24 * n;
  for (std::size_t i = 0; i < count; ++i) {
    std::vector<double> u(n);
    // One parameter: an even grid with both ends.
    for (std::size_t k = 0; k < n; ++k)
      u[k] = n == 1 ? static_cast<double>(i) / static_cast<double>(count - 1) : halton(i + 1, bases[k]);
    looks.push_back({u, function(u), 1});
  }
  std::ranges::stable_sort(looks, {}, &Minimum::value);
  Minimum best = looks.front();
  int evaluations = static_cast<int>(looks.size());
  for (std::size_t i = 0; i < std::min(searches, looks.size()); ++i) {
    const Minimum found = minimise_near(function, looks[i].u, n == 1 ? 0.02 : 0.1);
    evaluations += found.evaluations;
    if (found.value < best.value) best = found;
  }
  // Once more from the best, in small steps: a local search may have stopped short.
  const Minimum polished = minimise_near(function, best.u, 1e-3);
  evaluations += polished.evaluations;
  if (polished.value < best.value) best = polished;
  best.evaluations = evaluations;
  return best;
}

}  // namespace touchstone::pipeline
