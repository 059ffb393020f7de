// The constraint-based god-object for rigid bodies.
// Source: M. Ortega, S. Redon and S. Coquillart, A Six Degree-of-Freedom God-Object Method for Haptic Display of Rigid
// Bodies with Surface Properties, IEEE TVCG 13(3), 2007.
//
// The proxy moves towards the handle as Gauss' principle of least constraint lets it (section 4): of all displacements
// that respect the contacts it takes the one nearest to the free one, in the metric of the mass matrix. The force is
// proportional to the mass matrix times the difference of the two (section 5), so that mass and gain together are the
// coupling's stiffnesses: k_t on the translation, k_r on the rotation (coupling.h). At rest the proxy is the pose
// without penetration that has the least coupling energy.
//
// Differences from the paper: contacts are all pairs of features within a margin (feature_contacts.h) with their gaps
// kept in the constraints, and a displacement is cut to the margin (conservative advancement), where the paper finds
// the first contact by continuous collision detection; no friction.
// Guarantees: at rest the proxy is free of the object to rounding. While the hand is fast (0.5 m/s in a hole with 0.2
// mm of clearance) a corner of the tool can cut an edge of the object by less than 0.1 mm for some steps; overlaps up
// to 0.2 mm are pushed out again, so that walls must be thicker than that. The proxy moves at most 1.6 mm in a step
// beside the object, 4 mm elsewhere, and then lags behind the hand.
#pragma once

#include <array>

#include "harness/tool/tool_renderer.h"
#include "harness/tool/tool_renderer_entry.h"
#include "tool_renderers/feature_contacts.h"
#include "tool_renderers/least_constraint.h"
#include "tool_renderers/sphere_tree.h"

namespace touchstone::tool_renderers {

tool::ToolRendererEntry god_object_tool_entry();

class GodObjectTool : public tool::ToolRenderer {
 public:
  // `unit_m`: how long one unit of meshes and poses is. The coupling and the answer are then in newtons, that unit and
  // radians.
  GodObjectTool(const tool::Tool& tool, const surface::TriangleMesh& object_W, const tool::Coupling& coupling,
                double unit_m = 1.0);
  [[nodiscard]] std::optional<std::size_t> memory_bytes() const noexcept override {
    return tool_.memory_bytes() + object_.memory_bytes() + near_.memory_bytes() + sizeof(*this);
  }

 protected:
  void do_reset() override { placed_ = false; }
  tool::ToolResult do_step(const tool::ToolState& state, double dt_s) noexcept override;

 private:
  static constexpr std::size_t most_pairs = 256;

  FeatureMesh tool_;
  FeatureMesh object_;
  NearPairFinder near_;
  tool::Coupling coupling_;
  double unit_m_;
  bool placed_ = false;
  tool::Pose proxy_;
  double margin_m_ = 0.0;
  std::array<NearPair, most_pairs> pairs_;
  std::array<HalfSpace6, most_pairs> half_spaces_;
  std::array<tool::ToolContact, 6> contacts_;
};

}  // namespace touchstone::tool_renderers
