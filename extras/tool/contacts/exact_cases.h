// Contacts of a rigid tool whose answer is known: meshes for the renderer, smooth gaps for the truth (quasi_static.h).
// Curved shapes have their vertices on the exact surface, so that a mesh errs by its sagitta: about
// edge^2 / (8 radius), some micrometres here; flat ones are exact.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "contacts/quasi_static.h"
#include "contacts/tool_meshes.h"
#include "tool_errors.h"

namespace touchstone::contacts {

struct ExactCase {
  std::string name;
  std::string what;
  surface::TriangleMesh tool_T;
  surface::TriangleMesh object_W;
  std::vector<GapOfPose> gaps;
  tool::Pose free;                  // without contact: where a renderer starts
  std::vector<tool::Pose> handles;  // that it goes to, each from `free` along a straight way
  bool goes_on_along_x = false;     // the object is the same all along x, as far as the tool slides
};

std::vector<std::string> exact_case_names();
// Of `shape`; peg, which is none of the names, is the peg in a hole with the clearance that `shape` says. Throws
// UsageError for a name that is not known, a scale or clearance that is not above 0, a clearance of what is no peg.
inline constexpr std::string_view peg = "peg";
ExactCase make_exact_case(std::string_view name, const tool::ContactShape& shape = {});

}  // namespace touchstone::contacts
