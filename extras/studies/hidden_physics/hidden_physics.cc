#include "hidden_physics/hidden_physics.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace touchstone::hidden_physics {

Vec3 OutsidePhysics::zero_N(double t_s) const {
  const double warm = std::max(0.0, t_s) / warming_s;
  return (1.0 - 0.6 * std::exp(-warm) - 0.4 * std::exp(-0.25 * warm)) * warming_N;
}

HiddenContact::HiddenContact(const TrueSurface& surface, const HiddenPhysics& physics)
    : surface_(surface), physics_(physics), dents_m_(std::size_t{dent_cells} * dent_cells, 0.0) {}

double& HiddenContact::dent(const Vec2& xy) {
  const auto cell = [this](double x) {
    const double share = 0.5 * (x / surface_.half_side_m + 1.0);
    return static_cast<std::size_t>(std::clamp(static_cast<int>(share * dent_cells), 0, dent_cells - 1));
  };
  return dents_m_[cell(xy.y()) * dent_cells + cell(xy.x())];
}

// The Maxwell arm s' = K u' - s / tau beside the spring k, u the depth of the surface. Over a step, with the mean of
// both ends for s (trapezium rule) and half = dt / (2 tau):  s_1 - s_0 = K (u_1 - u_0) - half (s_0 + s_1), solved for
// s_1. The tip can only press: where its depth would leave less than no force, the surface is free, k u_1 + s_1 = 0.
double HiddenContact::arm(double tip_depth_m, double dt_s) {
  const double k = physics_.stiffness_N_per_m;
  const double K = physics_.relaxation_ratio * k;
  const double half = 0.5 * dt_s / physics_.relaxation_time_s;
  const double at_rest = (1.0 - half) * arm_N_ - K * surface_m_;
  surface_m_ = tip_depth_m;
  arm_N_ = (at_rest + K * surface_m_) / (1.0 + half);
  if (k * surface_m_ + arm_N_ < 0.0) {
    surface_m_ = -at_rest / (k * (1.0 + half) + K);
    arm_N_ = -k * surface_m_;
  }
  return arm_N_;
}

double HiddenContact::normal_force(double depth_m, double rate_m_per_s, const Vec2& xy, double t_s, double dt_s) {
  const HiddenPhysics& h = physics_;
  double k = h.stiffness_N_per_m;
  if (h.map_amplitude != 0.0) {
    k *= 1.0 + h.map_amplitude * std::exp(-0.5 * (xy - h.map_place_m).squaredNorm() / (h.map_width_m * h.map_width_m));
  }
  if (h.softening_share != 0.0) k *= 1.0 - h.softening_share * (1.0 - std::exp(-t_s / h.softening_time_s));
  double N =
      h.exponent == 1.0 ? k * depth_m : k * h.reference_depth_m * std::pow(depth_m / h.reference_depth_m, h.exponent);
  if (h.bottom_stiffness_N_per_m > 0.0) {
    N += h.bottom_stiffness_N_per_m * std::max(0.0, depth_m - h.bottom_depth_m);
  }
  if (h.outside.tissue_N > 0.0) {
    N += h.outside.tissue_N * std::pow(std::max(0.0, depth_m / h.outside.tissue_from_m - 1.0), 1.5);
  }
  N += h.damping_N_s_per_m * rate_m_per_s + h.hunt_crossley_N_s_per_m2 * depth_m * rate_m_per_s;
  if (h.relaxation_ratio > 0.0) N += arm(depth_m, dt_s);
  return std::max(0.0, N);
}

Vec3 HiddenContact::friction(double normal_N, const Vec3& n, const Vec3& v_t, double dt_s) {
  const HiddenPhysics& h = physics_;
  Vec3 f = -h.viscous_N_s_per_m * v_t;
  const double speed = v_t.norm();
  if (h.tool_spring_N_per_m > 0.0) {
    // The tip sticks until the spring pulls harder than static friction, then slips to where dynamic friction holds it.
    spring_m_ += v_t * dt_s;
    spring_m_ -= n.dot(spring_m_) * n;
    const double pull = h.tool_spring_N_per_m * spring_m_.norm();
    if (pull > h.mu_static.x() * normal_N) spring_m_ *= h.mu_dynamic.x() * normal_N / pull;
    return f - h.tool_spring_N_per_m * spring_m_;
  }
  if (h.mu_dynamic.isZero() && h.mu_static.isZero() && !(h.shear_strength_Pa > 0.0)) return f;
  // Dahl: s z' = v - |v| z, by the implicit Euler rule, since a fast tip crosses s in less than a step:
  // z_1 = z_0 + (v - |v| z_1) dt / s, solved for z_1. Its steady value is v / |v| at any step.
  bristle_ = (bristle_ + v_t * dt_s / h.presliding_m) / (1.0 + speed * dt_s / h.presliding_m);
  bristle_ -= n.dot(bristle_) * n;
  if (h.shear_strength_Pa > 0.0) {
    const double radius_m = std::cbrt(0.75 * h.ball_radius_m * normal_N / h.elastic_modulus_Pa);
    return f - h.shear_strength_Pa * std::numbers::pi * radius_m * radius_m * bristle_;
  }
  Vec2 mu = h.mu_dynamic;
  if (h.stribeck_velocity_m_per_s > 0.0) {
    const double ratio = speed / h.stribeck_velocity_m_per_s;
    mu += (h.mu_static - h.mu_dynamic) * std::exp(-ratio * ratio);
  }
  Vec3 dry(mu.x() * bristle_.x(), mu.y() * bristle_.y(), std::sqrt(mu.x() * mu.y()) * bristle_.z());
  dry -= n.dot(dry) * n;
  return f - normal_N * dry;
}

Vec3 HiddenContact::tip_of(const Vec3& tool_W_m, double dt_s) {
  const OutsidePhysics& h = physics_.outside;
  if (h.play_m > 0.0) {
    if (has_tool_) behind_m_ -= tool_W_m - last_tool_W_m_;
    behind_m_ = behind_m_.cwiseMin(h.play_m).cwiseMax(-h.play_m);
    last_tool_W_m_ = tool_W_m;
  }
  if (h.bending_N_per_m > 0.0) {
    // The beam follows the force of the last step within a millisecond, which is quick for a hand and stable.
    constexpr double follows_s = 1e-3;
    const Vec3 to(last_f_W_N_.x() / h.bending_N_per_m, last_f_W_N_.y() / h.bending_N_per_m, 0.0);
    bent_m_ += (to - bent_m_) * (dt_s / (dt_s + follows_s));
  }
  return tool_W_m + behind_m_ + bent_m_;
}

Vec3 HiddenContact::hysteresis(const Vec3& n, const Vec3& v_t, double dt_s) {
  const OutsidePhysics& h = physics_.outside;
  const Vec3 along = v_t.cwiseProduct(yield_m_);
  const double pull = (along.cwiseAbs() + along).sum() / (2.0 * h.hysteresis_m * h.hysteresis_m);
  yield_m_ += dt_s * (v_t - pull * yield_m_);
  yield_m_ -= n.dot(yield_m_) * n;
  return -h.hysteresis_N / h.hysteresis_m * yield_m_;
}

Vec3 HiddenContact::on_the_tool(const Vec3& p) const {
  const OutsidePhysics& h = physics_.outside;
  Vec3 f = Vec3::Zero();
  if (h.cogging_N != 0.0) {
    const double turn = 2.0 * std::numbers::pi * h.cogging_along_W.dot(p) / h.cogging_length_m + h.cogging_phase_rad;
    f += h.cogging_N * (std::sin(turn) + 0.2 * std::sin(2.0 * turn)) * h.cogging_along_W;
  }
  if (h.leash_N_per_m > 0.0) {
    const Vec3 from = p - h.leash_end_W_m;
    const double length = from.norm();
    if (length > h.leash_m) f -= h.leash_N_per_m * (length - h.leash_m) / length * from;
  }
  return f;
}

HiddenContact::Forces HiddenContact::step(double t_s, double dt_s, const Vec3& tool, const Vec3& tool_m_per_s) {
  const HiddenPhysics& h = physics_;
  const Vec3 p = tip_of(tool, dt_s);
  const bool apart = h.outside.play_m > 0.0 || h.outside.bending_N_per_m > 0.0;
  const Vec3 v = apart && has_tool_ && dt_s > 0.0 ? Vec3((p - last_tip_W_m_) / dt_s) : tool_m_per_s;
  last_tip_W_m_ = p;
  has_tool_ = true;
  const TrueSurface::Foot foot = surface_.foot(p, guess_m_);
  guess_m_ = foot.q_W_m.head<2>();
  const Vec3& n = foot.n_W;
  Forces forces;
  forces.n_W = n;

  double depth = h.tip_radius_m - foot.distance_m;
  double rate = -n.dot(v);
  if (h.texture_amplitude_m != 0.0) {
    const double wave = 2.0 * std::numbers::pi / h.texture_wavelength_m;
    const Vec2 direction(std::cos(h.texture_direction_rad), std::sin(h.texture_direction_rad));
    // The texture is the surface's: it is felt at the foot, which runs slower or faster than the tip on a curved
    // object.
    const double height =
        h.texture_amplitude_m * std::sin(wave * direction.dot(foot.q_W_m.head<2>()) + h.texture_phase_rad);
    depth += height;
    if (dt_s > 0.0 && has_texture_height_) rate += (height - texture_height_m_) / dt_s;
    texture_height_m_ = height;
    has_texture_height_ = true;
  }
  if (h.dent_share > 0.0) {
    double& here = dent(foot.q_W_m.head<2>());
    here = std::max(here, h.dent_share * depth);
    depth -= here;
  }
  if (depth > 0.0) {
    bonded_ = true;
    forces.contact = true;
    const double N = normal_force(depth, rate, foot.q_W_m.head<2>(), t_s, dt_s);
    const Vec3 v_t = v - n.dot(v) * n;
    forces.f_W_N = N * n + friction(N, n, v_t, dt_s);
    if (h.outside.hysteresis_N > 0.0) forces.f_W_N += hysteresis(n, v_t, dt_s);
    last_f_W_N_ = forces.f_W_N;
  } else {
    bristle_.setZero();
    spring_m_.setZero();
    if (h.relaxation_ratio > 0.0) arm(0.0, dt_s);
    yield_m_.setZero();
    last_f_W_N_.setZero();
  }
  const double gap = std::max(0.0, -depth);
  if (gap > 5.0 * h.adhesion_range_m) bonded_ = false;
  if (bonded_) forces.f_W_N -= h.adhesion_N * std::exp(-gap / h.adhesion_range_m) * n;
  if (h.magnet_N > 0.0) forces.f_W_N -= h.magnet_N * std::exp(-gap / h.magnet_range_m) * n;
  forces.f_W_N -= h.drag_N_s_per_m * v;
  if (h.cable_N_per_m > 0.0) forces.f_W_N -= h.cable_N_per_m * (p - h.cable_end_W_m);
  forces.f_W_N += on_the_tool(tool);
  forces.f_W_N.x() += h.vibration_N * std::sin(2.0 * std::numbers::pi * h.vibration_Hz * t_s);
  return forces;
}

}  // namespace touchstone::hidden_physics
