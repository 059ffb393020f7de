// Renderers of a tool against contacts whose wrench at rest is known: how far off each is.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "harness/surface/triangle_mesh.h"
#include "harness/tool/pose.h"
#include "harness/tool/tool.h"
#include "harness/tool/tool_renderer.h"

namespace touchstone::tool {

// Places of the handle and the wrench that is right at each, once the tool has come to rest: on the tool by the object,
// about the tool's origin (the handle), in the axes of the object, in N and N m. contacts/ makes some.
struct KnownContacts {
  std::string name;
  Tool tool;
  surface::TriangleMesh object_W;
  Pose free;                       // without contact: where a renderer starts
  std::vector<Pose> handles;       // that it goes to, each from `free`
  std::vector<Pose> slid_from;     // one per handle: where it is pressed in first, to slide on to it. Empty: straight
  std::vector<Wrench> wrenches_W;  // one per handle
};

// What of a contact is not as usual.
struct ContactShape {
  double scale = 1.0;                 // of the tool and the object, above 0; how far the hand presses stays
  std::optional<double> clearance_m;  // on each side of a peg in a hole, which does not scale
};

struct ToolErrors {
  std::string contacts, renderer;                                     // names
  double mean_force_N = 0.0, max_force_N = 0.0;                       // lengths of the difference
  double mean_torque_Nm = 0.0, max_torque_Nm = 0.0;                   // the same
  double max_force_jnd = 0.0;                                         // force_error_in_jnd()
  double max_torque_jnd = 0.0;                                        // torque_error_in_jnd()
  double largest_right_force_N = 0.0, largest_right_torque_Nm = 0.0;  // for comparison
};

// Lets the renderer settle at each handle in turn (tool_path.h).
ToolErrors errors_of(ToolRenderer& renderer, const std::string& name, const KnownContacts& known);

// A table in Markdown, a row for each.
std::string tool_error_table(std::span<const ToolErrors> rows);

}  // namespace touchstone::tool
