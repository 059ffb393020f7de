// Faults of haptic renderers by name, each with the smallest case that shows it. A detector makes the renderer on small
// meshes whose right answer is known exactly, moves the tip, and looks for one fault alone. Of the time of its answers
// (harness/renderer_faults/timing.h):
//
//   held-answer             an answer is given again until the next update
//   delay                   every answer is that of an earlier tip
//   alternate-lag           some samples of a period are late
//   jitter                  samples are late without a period
//   filter                  the force is low-pass filtered
//   clipped-rate            the force changes by no more than a figure from sample to sample
//
// of the force that came to rest:
//
//   mirrored-axis           the wrong sign along an axis
//   exchanged-axes          one axis in the place of another
//   lost-axis               nothing along an axis
//   saturation              no more than a figure, by axis or by magnitude
//   quantised               in steps
//   place-dependent         another stiffness elsewhere
//   rate-dependent          another force in a loop of another rate
//   hysteresis              another force when released than when pressed
//   one-bad-face            single faces answer otherwise than their neighbours
//   falls-through-block     lost deep in a thick block
//
// and of all the rest:
//
//   dropout                 single samples without force
//   untouchable-triangles   triangles below a size are not felt, at some unit of length
//   sticks-at-flat-edges    a sideways force where two nearly coplanar faces meet
//   sticks-at-joints        the same where two bodies touch or overlap with flush tops
//   pops-through-shell      a tip pushed slowly through a plate comes out below
//   ball-at-edge            a ball hangs behind where it slides over a sharp convex edge
//   friction-lost           no tangential force, or less than half of what is declared, at some unit of length
//   standoff                the surface contact point floats above the surface
//   gap-at-contact          contact begins later or earlier than at the surface, or with a jump of force
//   late-contact            it begins later, by no more than the engine declares: said, and no fault
//   tie-break               exactly in a wall's plane, or as deep behind two, another answer than beside it
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
// Findings are causes or follow from one. A finding of a moving tip that is gone once the tip rests follows from the
// timing, and is no fault if that is none (damping). One that is gone when the map of a cause is undone, or that a
// right renderer shows, too, once the map or the noise is laid upon it, follows from that cause; one that is gone when
// lost samples are asked again follows from the dropout, and one that is gone when the triangles are counted from
// another one, from the bad face. What a bad face, a hysteresis, a force that depends on its place and one that turns
// otherwise than the world must do is listed.
//
// Lengths are those of the world at unit 1 (a block 40 mm wide). Detectors allocate and take milliseconds to seconds.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "harness/renderer_faults/engine.h"

namespace touchstone::renderer_faults {

struct Finding {
  std::string name;               // of the detector
  std::string what;               // one sentence with the figures
  std::string smallest_case;      // how to see it: mesh, place, depth
  double value = 0.0;             // the figure that stands for it
  std::string unit;               // of the value
  std::string follows_from = {};  // the finding that explains it; empty: a cause
  // What else could have explained it, by name, and why it does not.
  std::vector<std::pair<std::string, std::string>> considered = {};
};

// How a fault is looked for, and what it can be.
enum class DetectorKind : std::uint8_t {
  timing,   // in the timing of the engine
  settled,  // in the answers of a tip that rests at every place
  events,   // single samples are lost
  moving,   // in the answers of a moving tip; gone once it rests, it follows from the timing
  running,  // in memory, state and cost; follows from nothing
  said      // no fault
};

struct Detector {
  std::string name;
  std::string summary;
  // What a renderer may declare that it cannot: then the fault is no news.
  std::vector<rendering::Ability> needs;
  // Nothing where the fault is not there. Throws what making the renderer throws.
  std::function<std::optional<Finding>(const Engine&)> find;
  DetectorKind kind = DetectorKind::moving;
};

// In the order in which the faults are worth fixing; causes come before what may follow from them.
const std::vector<Detector>& detectors();
// Throws UsageError that lists the known names.
const Detector& find_detector(const std::string& name);

struct Diagnosis {
  std::vector<Finding> findings;                              // causes first
  std::vector<Finding> said;                                  // what is no fault
  std::vector<std::string> clean;                             // looked for and not found
  std::vector<std::pair<std::string, std::string>> declared;  // not looked for: the detector, the declared reason
  std::vector<std::pair<std::string, std::string>> failed;    // could not be looked for: the detector, why
};

// Every detector on the engine. What the engine declares that it cannot is not looked for.
Diagnosis diagnose(const Engine& engine);
// Detectors of these names alone; findings have the cause that they follow from, though it may not be among them.
// Throws UsageError as find_detector() does.
Diagnosis diagnose(const Engine& engine, const std::vector<std::string>& names);

}  // namespace touchstone::renderer_faults
