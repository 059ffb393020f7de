// Stands in for the CGAL files in a build without them.
#include "harness/base/error.h"
#include "harness/surface/cgal/exact_surface.h"
#include "harness/surface/cgal/self_intersection.h"

namespace touchstone::surface {

bool exact_surface_available() noexcept { return false; }

std::shared_ptr<Surface> make_exact_surface(const TriangleMesh&) {
  throw UsageError("the exact surface needs CGAL, which this build was configured without (TOUCHSTONE_WITH_CGAL=OFF)");
}

std::optional<std::vector<std::array<std::int32_t, 2>>> self_intersections(const TriangleMesh&) { return std::nullopt; }

}  // namespace touchstone::surface
