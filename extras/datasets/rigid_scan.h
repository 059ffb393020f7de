// The physics of a ball-tipped probe that a hand drags over an object: the truth that instruments then measure. A
// function of time without memory, so that any sampling sees the same scan.
//
// In contact the ball's centre is at q + (r - N/k) n: r the ball's radius, N the hand's normal force, k the object's
// stiffness (infinite: rigid). The force on the probe is N n - mu N v/|v| (Coulomb), v the tangential velocity of the
// ball's centre: the probe slides, it does not roll. At rest (a tap) no tangential force acts. Off the surface the
// force is zero.
#pragma once

#include <limits>
#include <memory>

#include "guide.h"
#include "script.h"

namespace touchstone::datasets {

struct Contact {
  double tip_radius_m = 0.0;
  double stiffness_N_per_m = std::numeric_limits<double>::infinity();
  double mu = 0.0;  // Coulomb's coefficient
};

struct ScanTruth {
  double t_s = 0.0;
  Vec3 p_W_m;                   // the ball's centre
  Quat q_WS;                    // the sensor's frame, z along the probe from tip to hand
  Vec3 contact_W_m;             // the surface point under the ball
  Vec3 n_W;                     // outward normal there
  double gap_m = 0.0;           // between ball and surface, 0 in contact
  double normal_force_N = 0.0;  // 0 off the surface
  Vec3 v_t_W_m_per_s;           // tangential velocity of the centre
  Vec3 f_W_N;                   // on the probe
};

class RigidScan {
 public:
  RigidScan(std::shared_ptr<const Guide> guide, ScanScript script, Contact contact)
      : guide_(std::move(guide)), script_(std::move(script)), contact_(contact) {}

  [[nodiscard]] ScanTruth at(double t_s) const;
  [[nodiscard]] double duration_s() const noexcept { return script_.duration_s(); }
  [[nodiscard]] const ScanScript& script() const noexcept { return script_; }
  [[nodiscard]] const Contact& contact() const noexcept { return contact_; }

  // Where a virtual probe of stiffness k must be so that its proxy is the scan's contact: equation 2 of Ruffaldi et al.
  // 2006 with the exact normal force; the true position off the surface.
  [[nodiscard]] static Vec3 in_trajectory_W_m(const ScanTruth& truth, double tip_radius_m, double stiffness_N_per_m);

 private:
  // The centre of a ball that just touches.
  [[nodiscard]] Vec3 touching_centre_W_m(double t_s) const;

  std::shared_ptr<const Guide> guide_;
  ScanScript script_;
  Contact contact_;
};

}  // namespace touchstone::datasets
