// One body at many resolutions, each decimated from the same fine mesh, so that the family differs in density alone.
#pragma once

#include <cstddef>
#include <vector>

#include "harness/surface/triangle_mesh.h"

namespace touchstone::experiments {

// OpenMesh's decimation by quadric error metrics (Garland and Heckbert 1997). `targets`: numbers of triangles, each at
// most that of `fine`; the answers keep the order and have at most one more triangle than asked for. Throws BadData
// where the mesh cannot be decimated that far.
std::vector<surface::TriangleMesh> decimated_family(const surface::TriangleMesh& fine,
                                                    const std::vector<std::size_t>& targets);

}  // namespace touchstone::experiments
