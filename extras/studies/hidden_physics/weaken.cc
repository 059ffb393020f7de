#include "hidden_physics/weaken.h"

#include <cmath>
#include <set>
#include <string>

namespace touchstone::hidden_physics {
namespace {

const std::set<std::string> sizes{"mu_static",
                                  "mu_dynamic",
                                  "mu_reference",
                                  "mu_x",
                                  "mu_y",
                                  "coefficient_N_s_per_m",
                                  "amplitude",
                                  "ratio",
                                  "radius_m",
                                  "force_N",
                                  "coefficient_N_s_per_m2",
                                  "mass_kg",
                                  "fx_N",
                                  "fy_N",
                                  "fz_N",
                                  "amplitude_m",
                                  "fx_N_per_s",
                                  "fy_N_per_s",
                                  "c_xz",
                                  "fz_N_per_s",
                                  "c_yz",
                                  "lag_s",
                                  "dx_m",
                                  "dy_m",
                                  "dz_m",
                                  "rx_rad",
                                  "ry_rad",
                                  "mu",
                                  "share",
                                  "stiffness_N_per_m"};

}  // namespace

void weaken(BlindCase& plan, double strength) {
  HiddenPhysics& h = plan.physics;
  h.mu_static *= strength;
  h.mu_dynamic *= strength;
  h.shear_strength_Pa *= strength;
  for (double* size : {&h.damping_N_s_per_m, &h.hunt_crossley_N_s_per_m2, &h.map_amplitude, &h.relaxation_ratio,
                       &h.tip_radius_m, &h.adhesion_N, &h.texture_amplitude_m, &h.viscous_N_s_per_m,
                       &h.tool_spring_N_per_m, &h.bottom_stiffness_N_per_m, &h.drag_N_s_per_m, &h.cable_N_per_m,
                       &h.vibration_N, &h.dent_share, &h.softening_share, &h.magnet_N}) {
    *size *= strength;
  }
  h.exponent = 1.0 + strength * (h.exponent - 1.0);
  HiddenInstrument& i = plan.instrument;
  for (double* size : {&i.weight_kg, &i.inertia_kg, &i.c_xz, &i.c_yz, &i.lag_s}) *size *= strength;
  for (Vec3* size : {&i.bias_S_N, &i.drift_S_N_per_s, &i.shift_W_m, &i.turn_rad}) *size *= strength;
  // What is cut off shrinks with the largest force's excess over the limit.
  const double largest_N = h.stiffness_N_per_m * plan.train.depth_m;
  if (std::isfinite(i.limit_N)) i.limit_N = largest_N + strength * (i.limit_N - largest_N);
  for (HiddenEffect& effect : plan.effects) {
    for (auto& [name, value] : effect.parameters) {
      if (sizes.contains(name)) value *= strength;
      if (name == "exponent") value = h.exponent;
      if (name == "limit_N") value = i.limit_N;
    }
    // The bump that the mesh lacks was the last to be put on the true surface.
    if (effect.name == "surface-geometry") plan.truth.bumps.back().amplitude_m *= strength;
  }
}

}  // namespace touchstone::hidden_physics
