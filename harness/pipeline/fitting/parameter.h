// A parameter of a model that a fit may change: the renderer's by its name, that of an effect or instrument entry as
// ENTRY.NAME ("coulomb-friction.mu_dynamic"), or by NAME alone where only one entry has it.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "harness/rendering/catalogue.h"
#include "harness/rendering/model.h"

namespace touchstone::pipeline {

struct FitParameter {
  std::string name;   // as given, without bounds
  std::string entry;  // "" for the renderer's own
  std::string key;    // the name in the model file
  std::string unit;
  double low = 0.0;  // bounds of the search
  double high = 0.0;
  double initial = 0.0;
  bool logarithmic = false;  // searched by its logarithm: bounds positive and more than a factor 20 apart

  // To and from [0, 1], the scale that the search runs on.
  [[nodiscard]] double to_unit(double value) const;
  [[nodiscard]] double from_unit(double u) const;
};

// "stiffness_N_per_m" or "stiffness_N_per_m=100:2000". Without bounds those of the declaration hold; where they are too
// wide to search (not finite, or a declared maximum that only says "any"), a factor of 100 around the model's value.
// Throws UsageError that lists what the model declares.
FitParameter parse_fit_parameter(const rendering::Catalogue& catalogue, std::string_view text,
                                 const rendering::Model& model);

// The model with these values. Where sliding friction would exceed break-away, which no friction does, mu_static is
// raised to mu_dynamic, so that either can be searched alone.
rendering::Model with_values(const rendering::Model& model, const std::vector<FitParameter>& parameters,
                             const std::vector<double>& values);

}  // namespace touchstone::pipeline
