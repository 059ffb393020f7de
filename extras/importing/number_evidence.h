// What the numbers of a recording say of its columns: whether a unit that no name states can be right, and whether the
// forces can be those ON a probe BY an object that only takes energy. Each finding confirms what the names say,
// or contradicts it and is to be decided by who recorded the file.
//
// Lengths: a desktop device reaches less than 0.5 m, an arm less than 2 m (ISO 7250-1 gives forward reach below 0.9 m),
// and a hand approaches at up to 2 m/s (ISO 13855). Torques: beyond a lever of 1 m the sensor is not on the probe.
// Passivity: over a recording that begins and ends without load a passive object gives no energy, sum F . dp <= 0
// (Colgate and Schenkel 1997), and where depth alone changes the load, the force falls along its own direction.
#pragma once

#include <set>
#include <string>
#include <vector>

#include "import_file.h"

namespace touchstone::importing {

struct NumberFinding {
  std::string about;                   // "x_m, y_m, z_m"
  std::string what;                    // a sentence, with the figures
  bool contradicts = false;            // it is to be decided
  std::vector<std::string> withdrawn;  // columns that must not be written as they are
  bool of_signs = false;               // it tells whether the signs of positions and forces go together
};

// `unit_assumed`: columns of `read` whose unit no name or head states. `static_poses`: `read` is no motion, so that its
// forces are left to `acquire tool`.
std::vector<NumberFinding> number_evidence(const Imported& read, const std::set<std::string>& unit_assumed,
                                           bool static_poses = false);

}  // namespace touchstone::importing
