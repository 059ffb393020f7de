// The friction, density and shading experiments as text for the console, as reports and as JSON.
#pragma once

#include <string>

#include "experiments/density_experiment.h"
#include "experiments/friction_experiment.h"
#include "harness/report/page.h"
#include "harness/report/provenance.h"

namespace touchstone::experiments {

std::string friction_table(const FrictionExperiment& experiment);
report::Page friction_page(const FrictionExperiment& experiment, const report::Provenance& provenance);
std::string friction_to_json(const FrictionExperiment& experiment);
// What friction_to_json() wrote; the findings follow from the rest. Throws BadData for other text.
FrictionExperiment friction_from_json(const std::string& text);

// `shading`: experiment 4, else 3; the same run serves both.
std::string density_table(const DensityExperiment& experiment, bool shading);
report::Page density_page(const DensityExperiment& experiment, bool shading, const report::Provenance& provenance);
std::string density_to_json(const DensityExperiment& experiment);
// What density_to_json() wrote. Throws BadData for other text.
DensityExperiment density_from_json(const std::string& text);

}  // namespace touchstone::experiments
