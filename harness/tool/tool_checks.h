// What every renderer of a tool must do, whatever its method: checks on small flat bodies whose answer follows from
// statics alone. A failed check names the fault: wrong lever arm, sign or frame of the torque, order of rotations,
// stale contacts, friction lost or doubled.
#pragma once

#include <array>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "harness/tool/coupling.h"
#include "harness/tool/tool.h"
#include "harness/tool/tool_renderer.h"

namespace touchstone::tool {

// Units of length [m] in which a scene is tried beside metres.
inline constexpr std::array other_units_m{1e-3, 10.0};

struct ToolSubject {
  std::string name;
  std::function<std::unique_ptr<ToolRenderer>(const Tool&, const surface::TriangleMesh& object_W, const Coupling&)>
      make;
  // The same with bodies and coupling in another unit of length, of `unit_m`; the method's parameters follow.
  std::function<std::unique_ptr<ToolRenderer>(const Tool&, const surface::TriangleMesh& object_W, const Coupling&,
                                              double unit_m)>
      make_in_unit;
  // How finely the method resolves where the surface is: the voxel, or how far a contact's spring gives way under a
  // newton. Limits follow from it: force within k_t times it, torque within that times the size of the tool.
  double resolution_m = 0.0;
  // False for a method whose normals are the tool's own (tangent planes at sampled points): at a sharp edge its force
  // is off by more than the resolution, so that the two checks of exact equality (moved-scene, swapped-bodies) do not
  // apply.
  bool exact_normals = true;
  // Coulomb friction of each contact; 0 without.
  double mu = 0.0;
  // Why no other unit can be tried; empty where it can.
  std::string only_in_metres;
};

struct ToolFinding {
  std::string check;  // "torque-about-handle"
  bool passed = false;
  bool applies = true;
  double measured = 0.0;  // of what `unit` says
  double limit = 0.0;
  std::string unit;
  std::string fault;    // the fault's name where one explains the answer: "torque-sign"
  std::string why_not;  // where it does not apply: the reason
};

// In a fixed order; takes some seconds.
std::vector<ToolFinding> check_tool_renderer(const ToolSubject& subject);

// Every check that applies passed.
bool passed(const std::vector<ToolFinding>& findings);
// For people: a line a check, and how many of those that apply passed.
std::string findings_to_text(const std::string& renderer, const std::vector<ToolFinding>& findings);

}  // namespace touchstone::tool
