// Where a rigid tool that hangs on a static coupling comes to rest against a rigid object, or slides over it, and the
// wrench there: the exact answer that renderers of tools are held against.
//
// The contact is a finite set of smooth gaps g_j(X) >= 0 of the tool's pose X = (p, R), each with the contact's place
// x_j and unit normal n_j. At rest the coupling's energy is least among the poses without penetration
// (Karush, Kuhn and Tucker):
//   k_t (p - p_H) = sum l_j n_j,   k_r log(R R_H^T) = sum l_j (x_j - p) x n_j,   l_j >= 0, g_j >= 0, l_j g_j = 0.
// Solved for every set of up to four touching gaps by Newton's method, whose residual is in closed form (the derivative
// is numeric, so that it decides the speed alone, not the answer); among the solutions that keep every sign, the one
// with the least energy. Four gaps hold any wrench of the cases here (Caratheodory's theorem on a cone of three
// dimensions, and one more).
#pragma once

#include <array>
#include <functional>
#include <vector>

#include "harness/tool/coupling.h"

namespace touchstone::contacts {

struct Gap {
  double gap_m = 0.0;               // negative: they overlap
  Vec3 n_W = Vec3::Zero();          // unit, from the object to the tool
  Vec3 contact_W_m = Vec3::Zero();  // on the tool
};
using GapOfPose = std::function<Gap(const tool::Pose&)>;

struct Equilibrium {
  bool found = false;
  tool::Pose proxy;
  Wrench wrench_W;                       // on the tool by the object, about the tool's origin
  std::vector<double> contact_forces_N;  // one per gap, 0 where it does not touch. Not unique for a flat contact
  double residual_N = 0.0;               // residual of the balance, torques divided by 1 m
};

Equilibrium quasi_static_equilibrium(const std::vector<GapOfPose>& gaps, const tool::Pose& handle,
                                     const tool::Coupling& coupling);

// The same with Coulomb friction while hand and tool move on and on at one velocity, without turning: each contact
// slides against the object at that velocity v, so that its force has the known direction n - mu t, t the unit of v in
// the contact's plane, and n above is replaced by it in the balance. Holds where gaps do not change along v. What
// slides so has no energy that is least; two different answers are none (found is false).
Equilibrium sliding_equilibrium(const std::vector<GapOfPose>& gaps, const tool::Pose& handle,
                                const tool::Coupling& coupling, double mu, const Vec3& velocity_W);

// Gaps of convex parts of a tool (coordinates in T) against a plane n . x = d or a ball.
GapOfPose ball_on_plane(const Vec3& center_T_m, double radius_m, const Vec3& n_W, double d_m);  // radius 0: a corner
GapOfPose ball_on_ball(const Vec3& center_T_m, double radius_m, const Vec3& center_W_m, double object_radius_m);
// Axes along those of T.
GapOfPose ellipsoid_on_plane(const Vec3& center_T_m, const Vec3& semi_axes_m, const Vec3& n_W, double d_m);
GapOfPose ellipsoid_on_ball(const Vec3& center_T_m, const Vec3& semi_axes_m, const Vec3& center_W_m,
                            double object_radius_m);
// The rim of a disc whose axis is `axis_T`: one end of a cylinder.
GapOfPose disc_on_plane(const Vec3& center_T_m, const Vec3& axis_T, double radius_m, const Vec3& n_W, double d_m);
// A square peg along T's z with half width `half_width_m` and its end at z = end_T_m, in a square hole along W's z that
// opens at z = 0, moved in the plane y = 0: both end edges against the walls, both rims against the peg's sides.
std::array<GapOfPose, 4> square_peg_in_hole(double half_width_m, double end_T_m, double hole_half_width_m);

}  // namespace touchstone::contacts
