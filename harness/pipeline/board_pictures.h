// The pictures of a board as SVG: no script draws them, so that they show offline, in print and on a phone.
#pragma once

#include <string>

#include "harness/pipeline/board.h"

namespace touchstone::pipeline {

// The error of every renderer with its interval, best first; the measured force and the floor as lines; bars beside
// renderers that the data cannot tell apart. "" where nothing ran.
std::string error_picture(const Task& task);
std::string error_picture(const Overall& overall);

// Error against operations of a step, both logarithmic; the Pareto front as a line. "" where nothing was counted.
std::string pareto_picture(const Overall& overall);

}  // namespace touchstone::pipeline
