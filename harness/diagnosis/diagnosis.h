// Faults of haptic renderers by name, each with the smallest case that shows it. A detector makes the renderer on small
// meshes whose right answer is known exactly, moves the tip, and looks for one fault alone:
//
//   untouchable-triangles   triangles below a size are not felt, at some unit of length
//   sticks-at-flat-edges    a sideways force where two nearly coplanar faces meet
//   sticks-at-joints        the same where two bodies touch or overlap with flush tops
//   pops-through-shell      a tip pushed slowly through a plate comes out below
//   friction-lost           no tangential force, or less than half of what is declared, at some unit of length
//   standoff                the surface contact point floats above the surface
//   gap-at-contact          contact begins later or earlier than at the surface, or with a jump of force
//   delay                   the force is that of an earlier tip
//   noise                   the force changes while the tip rests, or saws while it slides over a plane
//   allocation              a step allocates memory
//   state-after-reset       a run after reset() is not the run of a new renderer
//   wrong-frame             the force turns with the tip, or does not turn with the world
//   energy-gained           a closed path gives energy to the hand
//   jump-between-triangles  the force jumps from one triangle to its neighbour; where `continuous_force` is declared,
//                           between triangles of one plane
//   shared-state            two renderers on one surface disturb one another
//   growing-cost            a step costs more the longer the run
//   late-spike              a step after many costs a multiple of the others
//
// Lengths are those of the world at unit 1 (a block 40 mm wide). Detectors allocate and take milliseconds to seconds.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "harness/base/rooms.h"
#include "harness/diagnosis/engine.h"

namespace touchstone::diagnosis {

struct Finding {
  std::string name;           // of the detector
  std::string what;           // one sentence with the figures
  std::string smallest_case;  // how to see it: mesh, place, depth
  double value = 0.0;         // the figure that stands for it
  std::string unit;           // of the value
};

struct Detector {
  std::string name;
  std::string summary;
  // What a renderer may declare that it cannot: then the fault is no news.
  std::vector<Ability> needs;
  // Nothing where the fault is not there. Throws what making the renderer throws.
  std::function<std::optional<Finding>(const Engine&)> find;
};

// In the order in which the faults are worth fixing.
const std::vector<Detector>& detectors();
// Throws UsageError that lists the known names.
const Detector& find_detector(const std::string& name);

struct Diagnosis {
  std::vector<Finding> findings;
  std::vector<std::string> clean;                             // looked for and not found
  std::vector<std::pair<std::string, std::string>> declared;  // not looked for: the detector, the declared reason
  std::vector<std::pair<std::string, std::string>> failed;    // could not be looked for: the detector, why
};

// Every detector on the engine. What the engine declares that it cannot is not looked for.
Diagnosis diagnose(const Engine& engine);

}  // namespace touchstone::diagnosis
