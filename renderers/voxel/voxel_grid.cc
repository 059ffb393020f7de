#include "renderers/voxel/voxel_grid.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "harness/base/error.h"
#include "harness/base/in_parallel.h"

namespace touchstone::renderers {
using surface::Surface;

namespace {

// Parts of a voxel by which the grid is shifted along x, y and z; half a voxel is kept for them.
const Vec3 shift(0.137, 0.271, 0.389);
constexpr double room_for_shift = 0.5;
const double half_diagonal = 0.5 * std::numbers::sqrt3;

VoxelLayout make_layout(const Surface& surface, const VoxelGridOptions& options) {
  const Box3 box = surface.bounds();
  const double room = options.resolution - 2.0 * options.margin_voxels - room_for_shift;
  if (!(room >= 1.0)) {
    throw BadData(
        fmt::format("a grid of {} voxels with a margin of {} on either side leaves no voxel for the body; "
                    "give more resolution or less margin",
                    options.resolution, options.margin_voxels));
  }
  VoxelLayout layout;
  layout.voxel_m = box.sizes().maxCoeff() / room;
  layout.per_m = 1.0 / layout.voxel_m;
  for (Eigen::Index i = 0; i < 3; ++i) {
    const double voxels = box.sizes()[i] * layout.per_m + 2.0 * options.margin_voxels + room_for_shift;
    // The longest side comes to `resolution` itself, but for rounding.
    const double count = std::abs(voxels - options.resolution) < 1e-6 ? options.resolution : std::ceil(voxels);
    layout.count[static_cast<std::size_t>(i)] = static_cast<std::int32_t>(count);
  }
  layout.origin_W_m = box.min() - layout.voxel_m * (Vec3::Constant(options.margin_voxels) + shift);
  return layout;
}

// The plane of a voxel; false in free space.
bool plane_at(const Surface& surface, const VoxelLayout& layout, const VoxelGridOptions& options, const VoxelIndex& at,
              VoxelPlane& plane) {
  const Vec3 center = layout.center_W_m(at);
  const surface::SurfacePoint nearest = surface.closest(center);
  const double height = nearest.signed_distance_m * layout.per_m;
  if (!(height <= half_diagonal && height >= -options.reach_voxels)) return false;
  plane.nx = static_cast<float>(nearest.n_W.x());
  plane.ny = static_cast<float>(nearest.n_W.y());
  plane.nz = static_cast<float>(nearest.n_W.z());
  // Through the nearest point for the normal as it is stored.
  const Vec3 n = unit(Vec3(plane.nx, plane.ny, plane.nz));
  plane.offset = static_cast<float>(dot(n, nearest.p_W_m - center) * layout.per_m);
  return squared_norm(n) > 0.0;
}

SparseVoxels::Brick make_brick(const Surface& surface, const VoxelLayout& layout, const VoxelGridOptions& options,
                               const VoxelIndex& first) {
  SparseVoxels::Brick brick;
  // The distance of a voxel's centre differs from that of the brick's middle by no more than lies between them.
  const Vec3 middle = layout.origin_W_m + layout.voxel_m * Vec3(first[0] + 2.0, first[1] + 2.0, first[2] + 2.0);
  const double band = std::max(half_diagonal, options.reach_voxels) + 3.0 * half_diagonal;
  if (surface.closest(middle).distance_m * layout.per_m > band * (1.0 + 1e-9)) return brick;
  for (int bit = 0; bit < 64; ++bit) {
    const VoxelIndex at{first[0] + (bit & 3), first[1] + (bit >> 2 & 3), first[2] + (bit >> 4)};
    if (at[0] >= layout.count[0] || at[1] >= layout.count[1] || at[2] >= layout.count[2]) continue;
    VoxelPlane plane;
    if (!plane_at(surface, layout, options, at, plane)) continue;
    brick.mask |= std::uint64_t{1} << bit;
    brick.planes.push_back(plane);
  }
  return brick;
}

std::vector<SparseVoxels::Brick> make_bricks(const Surface& surface, const VoxelLayout& layout,
                                             const VoxelGridOptions& options, const SparseVoxels& shape) {
  const VoxelIndex& bricks = shape.bricks();
  const std::size_t count = std::size_t(bricks[0]) * std::size_t(bricks[1]) * std::size_t(bricks[2]);
  std::vector<SparseVoxels::Brick> made(count);
  const auto make = [&](std::size_t i) {
    const auto x = static_cast<std::int32_t>(i % std::size_t(bricks[0]));
    const auto y = static_cast<std::int32_t>(i / std::size_t(bricks[0]) % std::size_t(bricks[1]));
    const auto z = static_cast<std::int32_t>(i / std::size_t(bricks[0]) / std::size_t(bricks[1]));
    made[i] = make_brick(surface, layout, options, {4 * x, 4 * y, 4 * z});
  };
  in_parallel(count, make, 1);
  return made;
}

}  // namespace

SparseVoxels::SparseVoxels(const VoxelIndex& count)
    : bricks_{(count[0] + 3) / 4, (count[1] + 3) / 4, (count[2] + 3) / 4} {}

void SparseVoxels::assign(const std::vector<Brick>& bricks) {
  std::size_t total = 0;
  for (const Brick& brick : bricks) total += brick.planes.size();
  masks_.reserve(bricks.size());
  first_.reserve(bricks.size());
  planes_.reserve(total);
  for (const Brick& brick : bricks) {
    masks_.push_back(brick.mask);
    first_.push_back(static_cast<std::uint32_t>(planes_.size()));
    planes_.insert(planes_.end(), brick.planes.begin(), brick.planes.end());
  }
}

SparseVoxelGrid make_sparse_grid(const Surface& surface, const VoxelGridOptions& options) {
  const VoxelLayout layout = make_layout(surface, options);
  SparseVoxelGrid grid{layout, SparseVoxels(layout.count)};
  grid.voxels.assign(make_bricks(surface, layout, options, grid.voxels));
  return grid;
}

DenseVoxelGrid make_dense_grid(const Surface& surface, const VoxelGridOptions& options) {
  const SparseVoxelGrid sparse = make_sparse_grid(surface, options);
  DenseVoxelGrid grid{sparse.layout, DenseVoxels(sparse.layout.count)};
  VoxelIndex at;
  for (at[2] = 0; at[2] < grid.layout.count[2]; ++at[2]) {
    for (at[1] = 0; at[1] < grid.layout.count[1]; ++at[1]) {
      for (at[0] = 0; at[0] < grid.layout.count[0]; ++at[0]) {
        if (const VoxelPlane* const plane = sparse.voxels.find(at)) grid.voxels.set(at, *plane);
      }
    }
  }
  return grid;
}

}  // namespace touchstone::renderers
