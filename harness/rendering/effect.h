// An effect changes what a renderer makes of a contact: friction, damping, a stiffness that varies, ... Effects act on
// the contact inside the step, live and in replay; EffectStack runs them over any renderer.
#pragma once

#include <cstdint>

#include "harness/base/vec.h"

namespace touchstone::rendering {

// The contact of one step as the base renderer found it, changed by the effects in the order of their phases.
// World frame, SI units. The force on the probe is normal_force_N * n_W + tangential_W_N.
struct ContactState {
  double t_s = 0.0;
  double dt_s = 0.0;  // since the last step; 0 at the first
  Vec3 tip_W_m = Vec3::Zero();
  Vec3 tip_step_W_m = Vec3::Zero();  // tip's displacement since the last step; zero at the first
  Vec3 proxy_W_m = Vec3::Zero();     // surface contact point of the base renderer; across a gap the closest one
  Vec3 n_W = Vec3::Zero();           // outward unit normal
  double depth_m = 0.0;              // penetration; negative: the gap, where the stack measures gaps
  double depth_rate_m_per_s = 0.0;   // backward difference of depth_m; at a contact's first sample, of the tip along -n
  double stiffness_N_per_m = 0.0;    // of the base renderer: normal force over depth
  double normal_force_N = 0.0;       // >= 0 but for adhesion
  double adhesion_N = 0.0;           // pull towards the surface, >= 0; no friction comes of it
  Vec3 tangential_W_N = Vec3::Zero();
  bool contact = false;
};

// Effects run in this order, and within a phase in the model file's order.
enum class EffectPhase : std::uint8_t {
  depth,         // changes depth_m; the stack then sets contact and normal_force_N = stiffness * depth
  stiffness,     // multiplies normal_force_N
  normal_force,  // adds to normal_force_N; the stack then keeps it from going below zero
  adhesion,
  friction,  // adds to tangential_W_N, from the final normal force
};

class Effect {
 public:
  virtual ~Effect() = default;
  // Forgets the past.
  virtual void reset() noexcept = 0;
  // Allocates nothing, never throws. Called at every step, in contact or not.
  virtual void apply(ContactState& contact) noexcept = 0;
};

}  // namespace touchstone::rendering
