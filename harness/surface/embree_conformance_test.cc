#include "harness/surface/embree_surface.h"
#include "harness/testing/surface_conformance.h"
#include "harness/testing/tiny_meshes.h"

namespace {

using touchstone::surface::make_embree_surface;
using touchstone::surface::moved;
using touchstone::surface::TriangleMesh;

auto of(const TriangleMesh& mesh) {
  return [mesh](double scale, const touchstone::Quat& rotation, const touchstone::Vec3& shift_m) {
    return make_embree_surface(moved(mesh, rotation, shift_m, scale));
  };
}

}  // namespace

TOUCHSTONE_SURFACE_CONFORMANCE(Embree, {"cube", of(touchstone::testing::cube(0.5)), {}},
                               {"ball", of(touchstone::testing::ball(0.5, 4)), {}},
                               {"torus", of(touchstone::testing::torus(0.4, 0.15, 40, 24)), {}},
                               {"sheet", of(touchstone::testing::grid(0.5, 20)), {.closed = false}});
