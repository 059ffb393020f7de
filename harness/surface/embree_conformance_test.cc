#include "harness/surface/embree_surface.h"
#include "harness/testing/surface_conformance.h"
#include "harness/testing/tiny_meshes.h"

namespace {

using touchstone::surface::make_embree_surface;
using touchstone::surface::moved;
using touchstone::surface::TriangleMesh;

// Of a body that each case makes for itself: its parameters are copied in every process that runs one of them.
auto of(TriangleMesh (*mesh)()) {
  return [mesh](double scale, const touchstone::Quat& rotation, const touchstone::Vec3& shift_m) {
    return make_embree_surface(moved(mesh(), rotation, shift_m, scale));
  };
}

}  // namespace

TOUCHSTONE_SURFACE_CONFORMANCE(Embree, {"cube", of([] { return touchstone::testing::cube(0.5); }), {}},
                               {"ball", of([] { return touchstone::testing::ball(0.5, 4); }), {}},
                               {"torus", of([] { return touchstone::testing::torus(0.4, 0.15, 40, 24); }), {}},
                               {"sheet", of([] { return touchstone::testing::grid(0.5, 20); }), {.closed = false}});
