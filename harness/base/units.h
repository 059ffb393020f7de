// Units in column names, options and dataset files, and their factors to SI.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace touchstone {

enum class Dimension { time, length, force, torque, none };

// The factor from `unit` to SI for that dimension ("ms" of time: 1e-3), or nothing when the unit is not known.
std::optional<double> si_factor(Dimension dimension, std::string_view unit);

// The units of a dimension, comma separated, for messages: "s, ms, us".
std::string known_units(Dimension dimension);

// "m", "mm", "cm", "km", "um", "in", "ft" to a factor; throws UsageError that lists what is known.
double length_unit_factor(std::string_view unit);
// Whether it has a factor: the unit of a mesh's coordinates.
bool is_mesh_unit(std::string_view unit);

// "3.15mm", "3.15 mm", "0.00315 m" to metres; a bare number is refused. Throws UsageError naming `what`.
double parse_length_m(std::string_view text, std::string_view what);

}  // namespace touchstone
