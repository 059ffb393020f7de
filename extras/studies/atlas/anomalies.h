// Where a renderer misrepresents the geometry, told from a run whose exact answer is known: Ruffaldi et al. 2006,
// section 5 and figure 8, ask for such cases to be isolated and quantified. Four detectors:
//
//   sticks        the surface contact point stays behind: for at least `stick_path_m` of the exact contact point's path
//                 it lies more than `stick_lag_m` + `slack_m` from it, against the direction in which that moves
//   pops through  the force pushes to the far side: f . n < -s |f|, n the outward normal at the exact contact point and
//                 at every exact one of the run up to `stick_lag_m` + `slack_m` of path before it: round a corner a
//                 contact point that friction rightly holds back has the normal and the friction of the other side
//   loses contact the tip is pressed more than `depth_m` deep and there is no contact
//   pulls inward  the force points into the object where the renderer has its own contact point, f . n' < -s |f|, n'
//                 the outward normal of the surface closest to it; or the tip is more than `depth_m` outside the object
//                 and there is a force
//
// with s = `sine`: a force further than a rounding from tangential.
#pragma once

#include <cstddef>
#include <vector>

#include "harness/base/vec.h"

namespace touchstone::atlas {

// One sample of a run.
struct TrackedContact {
  Vec3 contact_W_m = Vec3::Zero();  // surface contact point of the renderer
  Vec3 f_W_N = Vec3::Zero();
  Vec3 own_n_W = Vec3::Zero();  // outward normal of the surface closest to contact_W_m
  bool contact = false;
  Vec3 exact_W_m = Vec3::Zero();  // where the surface contact point should be
  Vec3 exact_n_W = Vec3::Zero();  // outward unit normal there
  double exact_depth_m = 0.0;     // how deep the tip is pressed there; <= 0: it should be free
  double tip_outside_m = 0.0;     // signed distance of the tip from the object's surface, positive outside
};

struct AnomalyLimits {
  double stick_lag_m = 1e-3;
  double stick_path_m = 1e-3;
  double slack_m = 0.0;  // lag that is right: with friction mu at depth d, mu d
  double depth_m = 1e-5;
  double sine = 1e-3;
};

struct Anomalies {
  std::size_t samples = 0;
  // Samples of each.
  std::size_t sticks = 0;
  std::size_t pops_through = 0;
  std::size_t loses_contact = 0;
  std::size_t pulls_inward = 0;
  double largest_lag_m = 0.0;  // of samples in contact that should be

  [[nodiscard]] bool none() const noexcept { return sticks + pops_through + loses_contact + pulls_inward == 0; }
};

Anomalies find_anomalies(const std::vector<TrackedContact>& run, const AnomalyLimits& limits = {});

}  // namespace touchstone::atlas
