// The catalogues as tables: what `touchstone synth --list` prints and docs/reference/synthetic.md holds.
#pragma once

#include <string>

namespace touchstone::datasets {

// Markdown: data sets, surfaces and trajectories with their parameters, units, ranges and defaults.
std::string catalogue_markdown();
// The same for programs.
std::string catalogue_json();

}  // namespace touchstone::datasets
