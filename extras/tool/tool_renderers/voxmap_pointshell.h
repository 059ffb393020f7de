// The Voxmap PointShell.
// Sources: McNeely, Puterbaugh and Troy, Six Degree-of-Freedom Haptic Rendering Using Voxel Sampling, SIGGRAPH 1999;
// McNeely, Puterbaugh and Troy, Advances in Voxel-Based 6-DOF Haptic Rendering, SIGGRAPH course 2005 (layers of
// distance); Wan and McNeely, Quasi-Static Approximation for 6 Degrees-of-Freedom Haptic Rendering, 2003 (the proxy).
//
// The tangent-plane force (1999, section 4.2): through the centre of the voxel that a point of the shell is in goes a
// plane whose normal is the point's inward normal n. If the point lies below it by d > 0, it is pushed by k d n. In a
// layer below the surface the depth of the layer is added to d (2005). If more than ten points touch, the sum is
// divided by a tenth of their number (1999, section 5).
// The proxy follows by the static coupling (coupling.h): each tick one Newton step towards the pose where coupling and
// contacts balance, of at most half a voxel.
#pragma once

#include <array>

#include "harness/tool/tool_renderer.h"
#include "harness/tool/tool_renderer_entry.h"
#include "tool_renderers/sphere_tree.h"
#include "tool_renderers/voxmap.h"

namespace touchstone::tool_renderers {

tool::ToolRendererEntry voxmap_pointshell_entry();

class VoxmapPointshell : public tool::ToolRenderer {
 public:
  VoxmapPointshell(const tool::PointShell& shell, const surface::Surface& object, double voxel_m,
                   const tool::Coupling& coupling, double contact_stiffness_N_per_m);
  [[nodiscard]] std::optional<std::size_t> memory_bytes() const noexcept override {
    return map_.memory_bytes() + 2 * shell_.p_T_m.capacity() * sizeof(Vec3) + sizeof(*this);
  }

 protected:
  void do_reset() override { placed_ = false; }
  tool::ToolResult do_step(const tool::ToolState& state, double dt_s) noexcept override;

 private:
  static constexpr std::size_t most_contacts = 512;  // that a result lists; all count for the force

  tool::PointShell shell_;
  Voxmap map_;
  tool::Coupling coupling_;
  double stiffness_N_per_m_;
  double reach_m_ = 0.0;
  bool placed_ = false;
  tool::Pose proxy_;
  std::array<tool::ToolContact, most_contacts> contacts_;
};

}  // namespace touchstone::tool_renderers
