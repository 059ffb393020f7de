// The minimum of a function on the unit cube, without derivatives: first a coarse look everywhere (metrics of replays
// may have several minima), then a local search from the best places. Sources: BOBYQA (Powell 2009) for two parameters
// and more, COBYLA (Powell 1994) for one, both as NLopt has them; the starts are a Halton sequence (Halton 1960), the
// same on every machine.
#pragma once

#include <functional>
#include <vector>

namespace touchstone::pipeline {

using UnitFunction = std::function<double(const std::vector<double>&)>;

struct Minimum {
  std::vector<double> u;
  double value = 0.0;
  int evaluations = 0;
};

// `first`: a point to look at too, e.g. where the model stands. Throws UsageError for more than six parameters or none.
Minimum minimise(const UnitFunction& function, const std::vector<double>& first);
// The local search alone, from `start`, with a first step of `step`.
Minimum minimise_near(const UnitFunction& function, const std::vector<double>& start, double step);

}  // namespace touchstone::pipeline
