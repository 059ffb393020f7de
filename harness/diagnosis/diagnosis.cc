#include "harness/diagnosis/diagnosis.h"

#include <exception>

#include "harness/base/error.h"
#include "harness/diagnosis/detectors.h"

namespace touchstone::diagnosis {

const std::vector<Detector>& detectors() {
  using enum Ability;
  static const std::vector<Detector> list{
      {"wrong-frame", "the force turns with the tip, or does not turn with the world", {}, find_wrong_frame},
      {"sticks-at-joints",
       "a sideways force where two bodies touch or overlap with flush tops",
       {surface_contact, continuous_force},
       find_sticks_at_joints},
      {"sticks-at-flat-edges",
       "a sideways force where two nearly coplanar faces meet",
       {surface_contact},
       find_sticks_at_flat_edges},
      {"pops-through-shell",
       "a tip pushed slowly through a plate comes out below",
       {thin_shells},
       find_pops_through_shell},
      {"untouchable-triangles",
       "triangles below a size are not felt, at some unit of length",
       {unit_scale},
       find_untouchable_triangles},
      {"jump-between-triangles", "the force jumps from one triangle to its neighbour", {}, find_jump_between_triangles},
      {"friction-lost",
       "no tangential force, or less than half of what is declared, at some unit of length",
       {},
       find_friction_lost},
      {"energy-gained", "a closed path gives energy to the hand", {passive}, find_energy_gained},
      {"delay", "the force is that of an earlier tip", {}, find_delay},
      {"gap-at-contact",
       "contact does not begin at the surface and without a jump",
       {surface_contact},
       find_gap_at_contact},
      {"standoff", "the surface contact point floats above the surface", {surface_contact}, find_standoff},
      {"noise", "the force changes while the tip rests, or saws while it slides over a plane", {}, find_noise},
      {"state-after-reset", "a run after reset() is not the run of a new renderer", {}, find_state_after_reset},
      {"shared-state", "two renderers on one surface disturb one another", {}, find_shared_state},
      {"allocation", "a step allocates memory", {}, find_allocation},
      {"growing-cost", "a step costs more the longer the run", {}, find_growing_cost},
      {"late-spike", "a step after many costs a multiple of the others", {}, find_late_spike},
  };
  return list;
}

const Detector& find_detector(const std::string& name) {
  std::string known;
  for (const Detector& detector : detectors()) {
    if (detector.name == name) return detector;
    known += ' ' + detector.name;
  }
  throw UsageError("there is no detector '" + name + "'; there are:" + known);
}

Diagnosis diagnose(const Engine& engine) {
  Diagnosis diagnosis;
  for (const Detector& detector : detectors()) {
    const Limitation* declared = nullptr;
    for (const Ability ability : detector.needs) {
      if (declared == nullptr) declared = find_limitation(engine.cannot, ability);
    }
    if (declared != nullptr) {
      diagnosis.declared.emplace_back(detector.name, declared->reason);
      continue;
    }
    try {
      if (auto finding = detector.find(engine)) {
        diagnosis.findings.push_back(std::move(*finding));
      } else {
        diagnosis.clean.push_back(detector.name);
      }
    } catch (const std::exception& error) {
      diagnosis.failed.emplace_back(detector.name, error.what());
    }
  }
  return diagnosis;
}

}  // namespace touchstone::diagnosis
