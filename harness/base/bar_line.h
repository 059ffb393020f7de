// Numbers as a line of bars for a terminal: "▁▂▅█▅▂▁".
#pragma once

#include <span>
#include <string>

namespace touchstone {

// One character a value, from blank at `low` to full at `high`; what is no number is blank.
std::string bar_line(std::span<const double> values, double low, double high);

}  // namespace touchstone
