// The effects that a blind case hides, with magnitudes that a person would notice.
#pragma once

#include <optional>
#include <string>

#include "harness/base/random.h"
#include "hidden_physics/blind_case.h"

namespace touchstone::hidden_physics {

// What is usual in a case: every hidden effect takes its magnitude from these.
struct CaseSizes {
  double depth_m = 0.0;           // deepest press
  double half_side_m = 0.0;       // of the object
  double force_N = 0.0;           // at the deepest press, of the spring alone
  double sliding_m_per_s = 0.0;   // along the surface
  double pressing_m_per_s = 0.0;  // into it
};

// Hides one effect by its name in model files: in the plan's physics or instrument, and among its answers. A bump that
// the mesh will not have is returned, to be added to the true surface once the mesh is made. Takes its numbers from
// `random` in a fixed order. Throws std::logic_error for a name of which no physics is written.
std::optional<TrueSurface::Bump> hide_effect(BlindCase& plan, const CaseSizes& sizes, Random& random,
                                             const std::string& name);

}  // namespace touchstone::hidden_physics
