// The shapes on which the conformance suite of renderers runs: about 40 mm in size, in metres, z up.
#pragma once

#include <functional>
#include <limits>
#include <ostream>
#include <string>
#include <vector>

#include "harness/surface/triangle_mesh.h"

namespace touchstone::testing {

struct ConformanceBody {
  surface::TriangleMesh mesh;  // about 40 mm in size
  bool closed;
  bool flat;  // touched from above only: its other sides are too near or not there
  double thickness_m = std::numeric_limits<double>::infinity();
  bool level = false;  // a tip that went straight down through it stays on its top
};

// A parameter of the suite is copied for each of its cases in every process that runs one of them, so it has no mesh.
struct ConformanceShape {
  std::string name;
  std::function<ConformanceBody()> make;
};

inline void PrintTo(const ConformanceShape& shape, std::ostream* out) { *out << shape.name; }

// cube, ball, torus, plate (0.2 mm) and sheet (open).
std::vector<ConformanceShape> conformance_shapes();

}  // namespace touchstone::testing
