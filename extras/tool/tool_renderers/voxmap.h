// An object as voxels: free, surface, and layers below it.
// Source: McNeely, Puterbaugh and Troy, Six Degree-of-Freedom Haptic Rendering Using Voxel Sampling, SIGGRAPH 1999,
// section 4 (values free, interior, surface, proximity; proximity, for slowing before contact, is not made here).
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "harness/surface/surface.h"
#include "tool_renderers/sphere_tree.h"

namespace touchstone::tool_renderers {

class Voxmap {
 public:
  // Throws UsageError where the voxel would make more than a thousand million voxels, or none.
  Voxmap(const surface::Surface& object, double voxel_m);

  static constexpr std::uint8_t free_voxel = 0;
  static constexpr std::uint8_t surface_voxel = 1;  // the centre lies within half a voxel of the surface
  static constexpr std::uint8_t deepest_layer = 6;  // 2 to 6: layers below; 6 is also all that is deeper

  struct Place {
    std::uint8_t layer = free_voxel;
    Vec3 center_W_m;  // of the voxel
  };
  // Free outside the map.
  [[nodiscard]] Place at_point(const Vec3& p_W_m) const noexcept {
    const Vec3 cell = (p_W_m - low_W_m_) * per_m_;
    if (!(cell.minCoeff() >= 0.0) || cell.x() >= count_[0] || cell.y() >= count_[1] || cell.z() >= count_[2]) return {};
    const auto x = static_cast<std::size_t>(cell.x());
    const auto y = static_cast<std::size_t>(cell.y());
    const auto z = static_cast<std::size_t>(cell.z());
    const std::uint8_t layer = layers_[(z * std::size_t(count_[1]) + y) * std::size_t(count_[0]) + x];
    if (layer == free_voxel) return {};
    return {layer, low_W_m_ + voxel_m_ * Vec3(double(x) + 0.5, double(y) + 0.5, double(z) + 0.5)};
  }
  [[nodiscard]] double voxel_m() const noexcept { return voxel_m_; }
  [[nodiscard]] std::size_t memory_bytes() const noexcept { return layers_.capacity(); }

 private:
  double voxel_m_;
  double per_m_;
  Vec3 low_W_m_;
  std::array<int, 3> count_{};
  std::vector<std::uint8_t> layers_;
};

}  // namespace touchstone::tool_renderers
