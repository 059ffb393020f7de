// Does a recording lie where the mesh is? A mesh in millimetres read as metres is the most common mistake there is.
#pragma once

#include <optional>
#include <string>

#include "harness/base/vec.h"

namespace touchstone::recording {

struct ExtentMismatch {
  bool apart;           // they do not even come near each other: nothing can be evaluated
  std::string message;  // says what was found, and the unit that would fit where one does
};

// Nothing where they fit. `recording` is the box around the tip positions, `mesh` the mesh's, both in metres as read;
// `mesh_unit` is the unit that the mesh was read in.
std::optional<ExtentMismatch> check_extents(const Box3& recording, const Box3& mesh, const std::string& mesh_unit);

}  // namespace touchstone::recording
