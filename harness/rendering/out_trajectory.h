// From a measured path to the out-trajectory: the path of the tip on or above the surface, never inside.
// Source: Ruffaldi et al. 2006, "Standardized evaluation of haptic rendering systems", section 3.1.
//
// What the paper leaves open is decided here. The tip is a ball of radius r (r may be 0); s(x) is the signed distance
// from the surface to its centre x.
//  1. A sample is in contact when f . n0 > contact_threshold_N, where n0 is the outward unit normal at the surface
//  point
//     closest to the measured centre. Only pushing counts: a pull, or sideways drag, is no contact.
//  2. A sample in contact is put on the surface: p_out is the closest point to the measured one on {s >= r}, s(p_out) =
//  r.
//     For r > 0 that is the offset surface. Where the ball touches in several places (a valley) each of them is kept
//     clear, as planes through the contacts.
//  3. A sample not in contact stays where it was measured when s >= r. When it lies deeper (noise of the tracker, an
//  error
//     of registration) it is put on the surface too, but without force.
//  4. The outward normal n at p_out is the direction from the surface to the ball's centre where r > 0: the only
//  direction
//     in which a frictionless ball can push. For r = 0 it is the surface's at that point: the triangle's; at an edge
//     or a vertex the angle-weighted pseudo-normal. With several contacts it is the mean of their normals.
//  5. The normal force is F_n = max(0, f . n) in contact, 0 elsewhere.
//  6. p_out is moved outwards by the few units of rounding that make s(p_out) >= r hold in floating point as well.
#pragma once

#include "harness/recording/trajectory.h"
#include "harness/surface/surface.h"

namespace touchstone::rendering {

// 16 steps of the coarsest axis of the force sensor of the 2006 paper (1/320 N): above its noise, below any touch.
inline constexpr double default_contact_threshold_N = 0.05;

struct OutTrajectoryRule {
  double tip_radius_m = 0.0;
  double contact_threshold_N = default_contact_threshold_N;
};

struct OutSample {
  Vec3 p_W_m = Vec3::Zero();    // the tip (the ball's centre), s(p) >= r
  Vec3 n_W = Vec3::Zero();      // outward unit normal, rule 4
  double gap_m = 0.0;           // s(p) - r, >= 0; 0 where it was put on the surface
  double normal_force_N = 0.0;  // rule 5
  double moved_m = 0.0;         // from the measured position
  bool contact = false;         // rule 1
  bool clear = false;           // s(p) >= r was reached; false in a slot too narrow for the ball
};

// One sample after the other, so that a recording of any length can stream. Const and thread-safe; allocates nothing
// beyond what the surface's queries do.
class OutTrajectoryMaker {
 public:
  // Throws UsageError for a radius or threshold that is negative or not finite. The surface must outlive the maker.
  OutTrajectoryMaker(const surface::Surface& surface, const OutTrajectoryRule& rule);

  // `f_W_N` is the force on the probe by the object. Throws BadData for numbers that are not finite.
  [[nodiscard]] OutSample operator()(const Vec3& p_W_m, const Vec3& f_W_N) const;
  [[nodiscard]] const OutTrajectoryRule& rule() const noexcept { return rule_; }

 private:
  const surface::Surface& surface_;
  OutTrajectoryRule rule_;
  double step_m_;  // one unit of rounding of the surface's coordinates
};

// What happened on the way, for the report and for warnings.
struct OutTrajectorySummary {
  std::size_t samples = 0;
  std::size_t in_contact = 0;
  std::size_t not_clear = 0;        // see OutSample::clear
  std::size_t free_but_inside = 0;  // rule 3, second sentence
  double largest_move_in_contact_m = 0;
  double largest_move_free_m = 0;

  void add(const OutSample& sample);
};

// The whole recording. Throws BadData naming the source and the sample.
recording::OutTrajectory make_out_trajectory(const recording::Recording& recording, const surface::Surface& surface,
                                             const OutTrajectoryRule& rule, OutTrajectorySummary* summary = nullptr);

}  // namespace touchstone::rendering
