// A fixed grid of voxels over a body: each voxel near the surface knows the plane of the surface point nearest to its
// centre.
//
// Sources: Ruffaldi et al. 2006, section 4.1 ("a fixed voxel grid ... the nearest triangle to each voxel center. The
// stored triangle positions and surface normals are used to render forces for each voxel through which the probe
// passes"); W. A. McNeely, K. D. Puterbaugh and J. J. Troy, "Six degree-of-freedom haptic rendering using voxel
// sampling", SIGGRAPH 1999, section 3 (tangent-plane force of a voxel).
//
// What is stored: of the position only its part along the normal acts, so a voxel holds the unit normal and the plane's
// distance from the voxel's centre, both in single precision and in voxels: 16 bytes, off by 1e-7 of a voxel whatever
// the unit. Where the nearest point is on an edge or at a vertex the normal is the angle-weighted pseudo-normal, which
// does not depend on which of the triangles came first.
//
// The band: voxels whose centre is at most half a voxel's diagonal above the surface (the surface may pass through
// them) and at most `reach` voxels below it hold a plane, others are free space: dense and sparse storage both.
// The grid lies along the axes. It is shifted against the middle of the body's box by unequal parts of a voxel: centres
// on a plane of symmetry would be equally near to two triangles, and rounding would choose.
#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <memory>
#include <vector>

#include "harness/base/vec.h"
#include "harness/surface/surface.h"

namespace touchstone::renderers {

struct VoxelPlane {
  float nx = 0.0F;  // unit outward normal; zero in a voxel of free space
  float ny = 0.0F;
  float nz = 0.0F;
  float offset = 0.0F;  // of the plane from the voxel's centre along the normal, in voxels
};
static_assert(sizeof(VoxelPlane) == 16);

using VoxelIndex = std::array<std::int32_t, 3>;

struct VoxelLayout {
  Vec3 origin_W_m = Vec3::Zero();  // lowest corner
  double voxel_m = 0.0;            // edge
  double per_m = 0.0;              // 1 / voxel_m
  VoxelIndex count{};

  [[nodiscard]] Vec3 center_W_m(const VoxelIndex& at) const {
    return origin_W_m + voxel_m * Vec3(at[0] + 0.5, at[1] + 0.5, at[2] + 0.5);
  }
};

struct VoxelGridOptions {
  int resolution = 64;         // voxels along the longest side, margin included
  double margin_voxels = 2.0;  // on every side of the body's box
  double reach_voxels = 4.0;   // below the surface
};

// Every voxel in place.
class DenseVoxels {
 public:
  explicit DenseVoxels(const VoxelIndex& count)
      : count_(count), planes_(std::size_t(count[0]) * std::size_t(count[1]) * std::size_t(count[2])) {}
  // nullptr in free space. The index must lie within the grid.
  [[nodiscard]] const VoxelPlane* find(const VoxelIndex& at) const noexcept {
    const VoxelPlane& plane = planes_[place(at)];
    return plane.nx == 0.0F && plane.ny == 0.0F && plane.nz == 0.0F ? nullptr : &plane;
  }
  void set(const VoxelIndex& at, const VoxelPlane& plane) noexcept { planes_[place(at)] = plane; }
  [[nodiscard]] std::size_t memory_bytes() const noexcept { return planes_.capacity() * sizeof(VoxelPlane); }

 private:
  [[nodiscard]] std::size_t place(const VoxelIndex& at) const noexcept {
    return (std::size_t(at[2]) * std::size_t(count_[1]) + std::size_t(at[1])) * std::size_t(count_[0]) +
           std::size_t(at[0]);
  }
  VoxelIndex count_;
  std::vector<VoxelPlane> planes_;
};

// Only the voxels of the band: bricks of 4 x 4 x 4 voxels, each with one bit per voxel and the place of its first
// plane.
class SparseVoxels {
 public:
  explicit SparseVoxels(const VoxelIndex& count);
  [[nodiscard]] const VoxelPlane* find(const VoxelIndex& at) const noexcept {
    const std::size_t brick = brick_of({at[0] >> 2, at[1] >> 2, at[2] >> 2});
    const std::uint64_t bit = std::uint64_t{1} << bit_of(at);
    const std::uint64_t mask = masks_[brick];
    if ((mask & bit) == 0) return nullptr;
    return &planes_[first_[brick] + static_cast<std::size_t>(std::popcount(mask & (bit - 1)))];
  }
  [[nodiscard]] std::size_t memory_bytes() const noexcept {
    return masks_.capacity() * sizeof(masks_[0]) + first_.capacity() * sizeof(first_[0]) +
           planes_.capacity() * sizeof(planes_[0]);
  }
  [[nodiscard]] std::size_t voxel_count() const noexcept { return planes_.size(); }

  // For building: bricks in any order, then finish() once.
  [[nodiscard]] const VoxelIndex& bricks() const noexcept { return bricks_; }
  [[nodiscard]] std::size_t brick_of(const VoxelIndex& brick) const noexcept {
    return (std::size_t(brick[2]) * std::size_t(bricks_[1]) + std::size_t(brick[1])) * std::size_t(bricks_[0]) +
           std::size_t(brick[0]);
  }
  static int bit_of(const VoxelIndex& at) noexcept { return ((at[2] & 3) << 4) | ((at[1] & 3) << 2) | (at[0] & 3); }
  struct Brick {
    std::uint64_t mask = 0;
    std::vector<VoxelPlane> planes;  // one per bit, lowest bit first
  };
  void assign(const std::vector<Brick>& bricks);

 private:
  VoxelIndex bricks_;
  std::vector<std::uint64_t> masks_;
  std::vector<std::uint32_t> first_;
  std::vector<VoxelPlane> planes_;
};

struct SparseVoxelGrid {
  VoxelLayout layout;
  SparseVoxels voxels;
};
struct DenseVoxelGrid {
  VoxelLayout layout;
  DenseVoxels voxels;
};

// Throws BadData for options that leave no room for the body within the margin. In parallel; the same grid to the bit
// whatever the number of threads.
SparseVoxelGrid make_sparse_grid(const surface::Surface& surface, const VoxelGridOptions& options);
DenseVoxelGrid make_dense_grid(const surface::Surface& surface, const VoxelGridOptions& options);

}  // namespace touchstone::renderers
