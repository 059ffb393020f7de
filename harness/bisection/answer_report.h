// A bisection's answer for people, for programs, and as a picture.
#pragma once

#include <string>

#include "harness/bisection/bisection.h"
#include "harness/report/gnuplot.h"

namespace touchstone::bisection {

std::string answer_to_text(const BisectionAnswer& answer);
// touchstone-bisection-answer/1
std::string answer_to_json(const BisectionAnswer& answer);
// The metric over the commits of the line, as measured.
report::Plot answer_to_plot(const BisectionAnswer& answer);

}  // namespace touchstone::bisection
