#include "harness/testing/conformance_shapes.h"

#include "harness/testing/tiny_meshes.h"

namespace touchstone::testing {

std::vector<ConformanceShape> conformance_shapes() {
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
