// Contacts of a rigid tool whose answer is known: meshes for the renderer, smooth gaps for the truth (quasi_static.h).
// Curved shapes have their vertices on the exact surface, so that a mesh errs by its sagitta: about
// edge^2 / (8 radius), some micrometres here; flat ones are exact.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "synthetic/tool/quasi_static.h"
#include "synthetic/tool/tool_meshes.h"

namespace touchstone::synthetic {

struct ExactCase {
  std::string name;
  std::string what;
  TriangleMesh tool_T;
  TriangleMesh object_W;
  std::vector<GapOfPose> gaps;
  Pose free;                     // without contact: where a renderer starts
  std::vector<Pose> handles;     // that it goes to, each from `free` along a straight way
  bool goes_on_along_x = false;  // the object is the same all along x, as far as the tool slides
};

std::vector<std::string> exact_case_names();
// Throws UsageError for a name that is not known.
ExactCase make_exact_case(std::string_view name);

}  // namespace touchstone::synthetic
