// Penalty forces on a tool with mass behind a virtual coupling: the simple one.
// Sources: Colgate, Stanley and Brown, Issues in the Haptic Display of Tool Use, IROS 1995 (virtual coupling); Otaduy
// and Lin, A Modular Haptic Rendering Algorithm for Stable and Transparent 6-DOF Manipulation, IEEE Transactions on
// Robotics 22(4), 2006 (implicit integration of the tool with linearised contact).
//
// Each point of the shell that is inside the object by d > 0 is pushed to the nearest point of the surface: k d n. The
// tool moves by Newton's law, integrated by one step of backward Euler that is linear in the displacement y in h:
//   (M / h^2 + B / h + K + sum k w w^T) y = M v / h + B v_handle + f_coupling + sum k d w,     w = (n, r x n),
// M the tool's inertia about its origin (gyroscopic terms left out: they are of second order in a tool's turning), K
// the coupling's stiffness, B its damping, critical for the tool's mass. The hand feels the coupling's spring.
// A point is asked for its distance where what it has moved since it was asked leaves in doubt whether it touches
// (distance_bounds.h).
// Friction at the points (parameter mu, 0 without): the two sources have none; contact_friction.h.
#pragma once

#include <array>
#include <memory>
#include <optional>

#include "harness/surface/surface.h"
#include "harness/tool/tool_renderer.h"
#include "harness/tool/tool_renderer_entry.h"
#include "tool_renderers/contact_friction.h"
#include "tool_renderers/distance_bounds.h"
#include "tool_renderers/least_constraint.h"
#include "tool_renderers/sphere_tree.h"

namespace touchstone::tool_renderers {

tool::ToolRendererEntry penalty_coupling_entry();

class PenaltyCoupling : public tool::ToolRenderer {
 public:
  PenaltyCoupling(const tool::Tool& tool, const tool::PointShell& shell, std::shared_ptr<const surface::Surface> object,
                  const tool::Coupling& coupling, double contact_stiffness_N_per_m, double mu = 0.0);
  [[nodiscard]] std::optional<std::size_t> memory_bytes() const noexcept override {
    return 2 * shell_.p_T_m.capacity() * sizeof(Vec3) + tree_.memory_bytes() + distances_.memory_bytes() +
           (friction_ ? friction_->memory_bytes() : 0) + sizeof(*this);
  }

 protected:
  void do_reset() override {
    placed_ = false;
    distances_.forget();
    if (friction_) friction_->reset();
  }
  tool::ToolResult do_step(const tool::ToolState& state, double dt_s) noexcept override;

 private:
  static constexpr std::size_t most_contacts = 512;  // that a result lists; all count for the force

  tool::MassFrame mass_;
  tool::PointShell shell_;
  SphereTree tree_;
  DistanceBounds distances_;  // of the tree's nodes
  tool::Coupling coupling_;
  double stiffness_N_per_m_;
  std::optional<ContactFriction> friction_;
  bool placed_ = false;
  tool::Pose handle_;
  tool::Pose proxy_;
  Vec6 velocity_ = Vec6::Zero();
  std::array<tool::ToolContact, most_contacts> contacts_;
};

}  // namespace touchstone::tool_renderers
