// The contact of a blind case: what the object does to the probe, stepped at 10 kHz with exact velocities. Its formulas
// are written anew from their sources, not taken from the renderers' effects, which blind cases are there to test:
// friction is Dahl's differential equation (1968) where the renderers have a play operator, relaxation a Maxwell arm
// integrated by its differential equation, and so on. SI units, object's frame.
#pragma once

#include <vector>

#include "hidden_physics/true_surface.h"

namespace touchstone::hidden_physics {

// Effects for which a law is to be found: neither the effects of a library nor the terms of a law's have these forms.
// Zero switches each part off.
struct OutsidePhysics {
  // A motor's poles along an axis: a sine of the place with its second harmonic (Jahns and Soong 1996, IEEE Trans. Ind.
  // Electron. 43:321).
  double cogging_N = 0.0;
  double cogging_length_m = 1.0;
  double cogging_phase_rad = 0.0;
  Vec3 cogging_along_W = Vec3::UnitX();
  // Hysteresis along the surface, touching: the biaxial model of Park, Wen and Ang 1986 (Earthq. Eng. Struct. Dyn.
  // 14:543) with A = 1, beta = gamma = 1 / (2 z^2), so that each part of the state ends at z.
  double hysteresis_N = 0.0;
  double hysteresis_m = 1.0;
  // The tip hangs on the tracked tool by a beam (3 E I / l^3) across the object's z.
  double bending_N_per_m = 0.0;
  // The sensor's zero after it is switched on: six tenths at once and four tenths four times more slowly. Sensor's
  // frame.
  Vec3 warming_N = Vec3::Zero();
  double warming_s = 1.0;
  [[nodiscard]] Vec3 zero_N(double t_s) const;
  // A cable from a place, slack within its length.
  double leash_N_per_m = 0.0;
  double leash_m = 0.0;
  Vec3 leash_end_W_m = Vec3::Zero();
  // Tissue under a skin: beyond a depth a Hertzian contact, force with the power 3/2 of what is beyond.
  double tissue_N = 0.0;  // at tissue_from_m beyond tissue_from_m
  double tissue_from_m = 1.0;
  // Half of the play between the tracked tool and the tip, along each axis (Krasnosel'skii and Pokrovskii 1989).
  double play_m = 0.0;
};

// Zero (or one, for the exponent) switches each part off.
struct HiddenPhysics {
  double stiffness_N_per_m = 500.0;
  double damping_N_s_per_m = 0.0;         // k d + b d'
  double hunt_crossley_N_s_per_m2 = 0.0;  // k d + b d d'
  double exponent = 1.0;                  // k d0 (d/d0)^n
  double reference_depth_m = 1e-3;        // d0
  double map_amplitude = 0.0;             // k (1 + a exp(-r^2/2w^2))
  Vec2 map_place_m = Vec2::Zero();
  double map_width_m = 1.0;
  double relaxation_ratio = 0.0;
  double relaxation_time_s = 1.0;
  double tip_radius_m = 0.0;
  double adhesion_N = 0.0;
  double adhesion_range_m = 1e-3;
  double texture_amplitude_m = 0.0;
  double texture_wavelength_m = 1.0;
  double texture_direction_rad = 0.0;
  double texture_phase_rad = 0.0;

  Vec2 mu_static = Vec2::Zero();  // along the object's x and y
  Vec2 mu_dynamic = Vec2::Zero();
  double stribeck_velocity_m_per_s = 0.0;  // 0: mu_dynamic at once
  double presliding_m = 3e-5;
  double viscous_N_s_per_m = 0.0;
  // Friction as a shear strength of the area of contact, pi a^2 with a^3 = 3 R N / (4 E), of a ball of radius R on an
  // elastic half-space (Hertz 1882; Bowden and Tabor 1950).
  double shear_strength_Pa = 0.0;
  double ball_radius_m = 1e-3;
  double elastic_modulus_Pa = 1e6;

  // Effects that no library of ours has.
  double tool_spring_N_per_m = 0.0;  // the tip hangs on the tool by a spring along the surface: stick and slip
  double bottom_depth_m = 0.0;       // beyond this depth a stiffer layer
  double bottom_stiffness_N_per_m = 0.0;
  double drag_N_s_per_m = 0.0;  // in free air too
  double cable_N_per_m = 0.0;   // pulls towards a place, in free air too
  Vec3 cable_end_W_m = Vec3::Zero();
  double vibration_N = 0.0;  // along the object's x
  double vibration_Hz = 20.0;
  double dent_share = 0.0;       // of the depth that stays as a dent
  double softening_share = 0.0;  // of the stiffness that is lost in the long run
  double softening_time_s = 8.0;
  double magnet_N = 0.0;  // attracts without having touched
  double magnet_range_m = 1e-3;
  OutsidePhysics outside;
};

class HiddenContact {
 public:
  HiddenContact(const TrueSurface& surface, const HiddenPhysics& physics);

  struct Forces {
    Vec3 f_W_N = Vec3::Zero();  // on the probe
    Vec3 n_W = Vec3::UnitZ();
    bool contact = false;
  };
  Forces step(double t_s, double dt_s, const Vec3& p_W_m, const Vec3& v_W_m_per_s);

 private:
  double normal_force(double depth_m, double rate_m_per_s, const Vec2& xy, double t_s, double dt_s);
  double arm(double tip_depth_m, double dt_s);
  Vec3 friction(double normal_N, const Vec3& n, const Vec3& v_t, double dt_s);
  double& dent(const Vec2& xy);
  // Where the tip is when the tool is tracked at a place.
  Vec3 tip_of(const Vec3& tool_W_m, double dt_s);
  Vec3 hysteresis(const Vec3& n, const Vec3& v_t, double dt_s);
  [[nodiscard]] Vec3 on_the_tool(const Vec3& p_W_m) const;

  const TrueSurface& surface_;
  HiddenPhysics physics_;
  Vec2 guess_m_ = Vec2::Zero();
  Vec3 bristle_ = Vec3::Zero();  // of length 1 when sliding
  Vec3 spring_m_ = Vec3::Zero();
  double arm_N_ = 0.0;
  double surface_m_ = 0.0;  // how deep the arm's surface lies, pressed or coming back
  bool bonded_ = false;
  double texture_height_m_ = 0.0;  // at the last step
  bool has_texture_height_ = false;
  Vec3 bent_m_ = Vec3::Zero();
  Vec3 last_f_W_N_ = Vec3::Zero();
  Vec3 behind_m_ = Vec3::Zero();  // of the tip by play
  Vec3 last_tool_W_m_ = Vec3::Zero();
  Vec3 last_tip_W_m_ = Vec3::Zero();
  bool has_tool_ = false;
  Vec3 yield_m_ = Vec3::Zero();  // state of the hysteresis
  static constexpr int dent_cells = 40;
  std::vector<double> dents_m_;
};

}  // namespace touchstone::hidden_physics
