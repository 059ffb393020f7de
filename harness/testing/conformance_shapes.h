// The shapes on which the conformance suite of renderers runs: about 40 mm in size, in metres, z up.
#pragma once

#include <functional>
#include <limits>
#include <ostream>
#include <string>
#include <vector>

#include "harness/testing/tiny_meshes.h"

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

inline std::vector<ConformanceShape> conformance_shapes() {
  constexpr double any_thickness = std::numeric_limits<double>::infinity();
  const auto plate = [] {
    surface::TriangleMesh mesh = cube(0.02);
    for (Vec3& v : mesh.vertices_W_m) v.z() *= 0.005;  // 0.2 mm thick
    return ConformanceBody{mesh, true, true, 2e-4, true};
  };
  return {{"cube",
           [] {
             return ConformanceBody{cube(0.02), true, false, any_thickness, true};
           }},
          {"ball",
           [] {
             return ConformanceBody{ball(0.02, 4), true, false};
           }},
          {"torus",
           [] {
             return ConformanceBody{torus(0.02, 0.008, 48, 24), true, false};
           }},
          {"plate", plate},
          {"sheet", [] {
             return ConformanceBody{grid(0.02, 12), false, true, any_thickness, true};
           }}};
}

}  // namespace touchstone::testing
