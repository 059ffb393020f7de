#include "harness/report/page.h"

#include <fmt/format.h>

#include <cmath>
#include <utility>

namespace touchstone::report {

Table::Cell text_cell(std::string value) { return {std::move(value), false, Tone::neutral}; }

Table::Cell number_cell(std::string value) { return {std::move(value), true, Tone::neutral}; }

Table::Cell number_cell(double value, int digits) {
  return number_cell(std::isfinite(value) ? fmt::format("{:.{}g}", value, digits) : std::string("none"));
}

}  // namespace touchstone::report
