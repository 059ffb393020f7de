// A device and a grip as one loop to be run: their published figures, what the user sets in place of them, and what is
// assumed where there is neither, each assumption as a sentence for the report.
//
// Without a figure: no damping and no friction (a device only has more, which only calms it), exact positions, no force
// limit, an immediate actuator, no latency and no jitter; the period is 1 ms. No mass can be assumed: several are
// tried, and a verdict is one only if all agree.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "servo/data_sheet.h"
#include "servo/servo_loop.h"
#include "servo/verdict.h"

namespace touchstone::servo {

struct LoopSetup {
  DataSheet device, grip;
  LoopParameters parameters;             // with the first of the masses
  std::vector<double> device_masses_kg;  // one if it is known
  std::vector<std::string> assumed;

  [[nodiscard]] LoopParameters with_mass(double device_mass_kg) const;
};

// The names that `set` may have: those of device_entries(), those of grip_entries() after "hand_", and
// virtual_damping_N_s_per_m.
std::vector<std::string> names_to_set();

// Throws UsageError for a name that is not known, and for a grip without figures that are not set either.
LoopSetup make_setup(const std::string& device, const std::string& grip,
                     const std::map<std::string, double, std::less<>>& set, std::uint64_t seed);

// One verdict of several masses: theirs if they agree, else "cannot tell".
Verdict agreed(const std::vector<Verdict>& verdicts);

}  // namespace touchstone::servo
