// How force answers to height where the tip presses, read off a prediction: load over depth.
#pragma once

#include <cstddef>
#include <vector>

#include "harness/rendering/predictor.h"

namespace touchstone::discrepancy {

// Every `stride`-th sample that presses: contact, with a depth and a load.
std::vector<std::size_t> pressing_samples(const rendering::Prediction& prediction, std::size_t stride);

// Load over depth at these samples [N/m], held within a factor of three of their median: what damps or relaxes presses
// where the depth is next to nothing, and next to nothing where it is deep, and neither is a stiffness.
std::vector<double> stiffness_at(const rendering::Prediction& prediction, const std::vector<std::size_t>& samples);

}  // namespace touchstone::discrepancy
