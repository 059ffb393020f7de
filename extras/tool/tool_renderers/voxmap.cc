#include "tool_renderers/voxmap.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "harness/base/error.h"
#include "harness/base/in_parallel.h"

namespace touchstone::tool_renderers {

Voxmap::Voxmap(const surface::Surface& object, double voxel_m) : voxel_m_(voxel_m), per_m_(1.0 / voxel_m) {
  constexpr double most_voxels = 1e9;
  const Box3 bounds = object.bounds();
  const Vec3 cells = bounds.diagonal() / voxel_m;
  if (!(voxel_m > 0.0) || cells.array().ceil().max(1.0).prod() > most_voxels) {
    throw UsageError(
        fmt::format("voxel: {} m; a body of {:.3g} x {:.3g} x {:.3g} m needs one above 0 that makes less "
                    "than a thousand million voxels",
                    voxel_m, bounds.diagonal().x(), bounds.diagonal().y(), bounds.diagonal().z()));
  }
  // One voxel around, and half of one, so that flat sides of a body do not fall between two layers by rounding.
  low_W_m_ = bounds.min().array() - 1.5 * voxel_m;
  for (int k = 0; k < 3; ++k) count_[std::size_t(k)] = static_cast<int>(std::ceil(cells[k])) + 3;
  const auto nx = std::size_t(count_[0]);
  const auto ny = std::size_t(count_[1]);
  const auto nz = std::size_t(count_[2]);
  layers_.assign(nx * ny * nz, free_voxel);
  in_parallel(
      ny * nz,
      [&](std::size_t row) {
        double known_free = 0.0;  // along x: nothing changes within the distance to the surface
        std::uint8_t layer = free_voxel;
        for (std::size_t x = 0; x < nx; ++x) {
          if (known_free <= 0.0) {
            const Vec3 center =
                low_W_m_ + voxel_m_ * Vec3(double(x) + 0.5, double(row % ny) + 0.5, double(row / ny) + 0.5);
            const double distance = object.signed_distance(center);
            const double depth = std::floor(-distance / voxel_m_ + 0.5);  // in voxels, 0 at the surface
            layer = depth < 0.0 ? free_voxel : static_cast<std::uint8_t>(std::min(depth + 1.0, double(deepest_layer)));
            // How far the answer stays the same: outside until half a voxel, inside until the deepest layer begins.
            known_free = layer == free_voxel      ? distance - 0.5 * voxel_m_
                         : layer == deepest_layer ? -distance - (deepest_layer - 1.5) * voxel_m_
                                                  : 0.0;
          } else {
            known_free -= voxel_m_;
            if (known_free <= 0.0) {
              --x;  // ask again here
              continue;
            }
          }
          layers_[row * nx + x] = layer;
        }
      },
      1);
}

}  // namespace touchstone::tool_renderers
