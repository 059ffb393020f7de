// The plate, and faults planted in recordings, that the tests of the gate and of its rates share.
#pragma once

#include <memory>

#include "harness/base/random.h"
#include "harness/recording/trajectory.h"
#include "harness/surface/embree_surface.h"

namespace touchstone::recording_checks::planted_faults {

// 0.2 m wide at z = 0, every length times `unit`.
inline std::shared_ptr<const surface::Surface> plate(double unit = 1.0) {
  surface::TriangleMesh mesh;
  const double h = 0.1 * unit;
  mesh.vertices_W_m = {Vec3(-h, -h, 0), Vec3(h, -h, 0), Vec3(h, h, 0), Vec3(-h, h, 0)};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  mesh.source = "plate";
  return make_embree_surface(mesh);
}

// 150 samples of the first quarter stand once more in the third.
inline void repeat_a_stretch(recording::Recording& r, Random& random) {
  const std::size_t from = random.below(r.size() / 4), to = r.size() / 2 + random.below(r.size() / 4);
  for (std::size_t i = 0; i < 150; ++i) {
    r.motion.p_W_m[to + i] = r.motion.p_W_m[from + i];
    r.f_W_N[to + i] = r.f_W_N[from + i];
  }
}

}  // namespace touchstone::recording_checks::planted_faults
