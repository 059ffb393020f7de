// Is the clock of the force late or early against that of the positions? The load along the normal is regressed on the
// depth of the tip at shifted times; damping, which makes a force early too, is the rival of a lead.
#pragma once

#include <optional>
#include <span>

namespace touchstone::recording_checks {

struct LoadLag {
  double lag_s = 0.0;        // how late the force is; negative: early
  double correlation = 0.0;  // of load and depth as recorded
  double shifted = 0.0;      // and with the force shifted back
  double drift_s = 0.0;      // how much later the force is in the second half than in the first
};

// Nothing where the clocks agree or where the recording cannot tell: the shift must explain more than half of what a
// line through load and depth leaves, in both halves of the recording, exceed two samples, and for a force that is
// early do clearly better than damping of a positive coefficient does.
std::optional<LoadLag> find_load_lag(std::span<const double> t_s, std::span<const double> load_N,
                                     std::span<const double> depth_m, double most_left = 0.5);

}  // namespace touchstone::recording_checks
