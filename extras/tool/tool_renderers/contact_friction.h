// Coulomb friction of the points of a tool that a spring pushes out of an object, and where the tool comes to in a
// step.
//
// Each point that touches hangs on a spring of the contact's stiffness k from where it stuck, in the tangent plane;
// where it would pull more than mu times the normal force it is dragged along, so that no contact force leaves
// Coulomb's cone: the elastic-plastic friction of Hayward and Armstrong (A New Computational Model of Friction Applied
// to Haptic Rendering, 2000), which does not creep at rest. A point that is lost forgets where it stuck. Before it
// slips a point gives way by mu times its depth. These springs are far stiffer than a step of a millisecond can follow,
// so that their forces are those of the step's end: y solves
//   A y = b + sum J_i^T f_i(y),   f_i = k (depth_i - n_i . J_i y)+ n_i + the radial return of s_i + J_i y,
// J_i y the point's way, s_i how far its spring is stretched at the step's begin. Newton's method with the slopes of
// the radial return (Simo and Laursen, An Augmented Lagrangian Treatment of Contact Problems Involving Friction,
// Computers and Structures 42, 1992), which are unsymmetric where a point slips. Passive: an anchor that is dragged or
// forgotten only loses what its spring held.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "tool_renderers/least_constraint.h"

namespace touchstone::tool_renderers {

using Mat6 = Eigen::Matrix<double, 6, 6>;

class ContactFriction {
 public:
  // `points`: how many there are that can touch.
  ContactFriction(std::size_t points, double mu, double stiffness_N_per_m);

  void reset() noexcept;
  void begin_step() noexcept;
  // Point number `i` is inside by depth_m > 0 at p, which is r from the tool's origin; n points out. Once a step.
  // Returns the force on the tool by it: the normal one and friction.
  Vec3 touch(std::int32_t i, const Vec3& p_W_m, const Vec3& r_W_m, const Vec3& n_W, double depth_m) noexcept;
  // y above, of the points that touch in this step; A is positive definite. Allocates nothing.
  [[nodiscard]] Vec6 displacement(const Mat6& a, const Vec6& b) const noexcept;
  [[nodiscard]] std::size_t memory_bytes() const noexcept;

 private:
  struct Anchor {
    Vec3 at_W_m = Vec3::Zero();
    std::uint64_t step = 0;  // that it touched last; 0: never
  };
  struct Touching {
    Vec3 r, n, stretch;  // stretch: of the spring, in the tangent plane
    double depth;
  };
  // Where the tool has moved by y: A y - b - sum J^T f, and its slope if it is asked for.
  Vec6 residual(const Mat6& a, const Vec6& b, const Vec6& y, Mat6* slope) const noexcept;

  double mu_;
  double stiffness_N_per_m_;
  std::vector<Anchor> anchors_;
  std::vector<Touching> touching_;
  std::uint64_t step_ = 0;
};

}  // namespace touchstone::tool_renderers
