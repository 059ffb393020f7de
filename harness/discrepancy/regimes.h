// Where model and measurement disagree: the samples of a recording by what the tip was doing, and the error in each.
#pragma once

#include <string>
#include <vector>

#include "harness/discrepancy/effect_search.h"

namespace touchstone::discrepancy {

// What a regime splits the samples by, in the order in which they are shown.
enum class RegimeKind { phase, direction, sliding_speed, load, place, sensor_axis, time, frequency };
// "phase", "sliding speed", ...: as findings.json and the report have it.
const char* to_string(RegimeKind kind);

struct Regime {
  std::string name;  // "free air", "sliding, 20-50 mm/s", ...
  RegimeKind kind = RegimeKind::phase;
  std::size_t samples = 0;
  double before_N = 0.0;  // RMS of the 3-D force error (of one axis, or of a band of frequencies, where it says so)
  double after_N = 0.0;
  double share_before = 0.0;  // of the squared error of its kind
  double error95_N = 0.0;     // half width of before_N's 95 % interval, by runs of half a second
};

// `evidence`: the samples to sort; predictions of the starting model and of the final one over the whole recording.
// Contact is by the final model, or by a measured force that differs by more than the floor from what the sensor
// shows in free air: a tool's weight that no model has yet is no contact.
std::vector<Regime> sort_by_regime(const Evidence& evidence, const rendering::Prediction& before,
                                   const rendering::Prediction& after, double force_floor_N);

// The phase that got worse than noise can make it, by more than `share` of what got better in all; empty: none. (A
// short one whose error is all noise, such as the first contact, may go up by chance.)
std::string worsened_phase(const std::vector<Regime>& regimes, double share);

}  // namespace touchstone::discrepancy
