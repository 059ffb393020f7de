// For tests: a session with a hand-held probe, by rigid-body mechanics. Nothing in it is taken from the alignment.
//   One rigid body (handle, sensor, tool and the hand's apparent mass at the grip) moves in six degrees of freedom. The
// hand is an impedance: springs and dampers to the place and the attitude that it means to be at, as measured by Hogan
// (J. Neurosci. 5, 1985) and used for hand-held tools by Kuchenbecker et al. (Trans. ASME J. Dyn. Syst. 126, 2004); it
// moves by minimum-jerk strokes (Flash and Hogan, J. Neurosci. 5, 1985) with a tremor of 8 to 12 Hz. The surface pushes
// with Hunt and Crossley's law (J. Appl. Mech. 42, 1975) and Coulomb friction. The sensor between handle and tool reads
// what the tool pulls: contact force + m_tool (g - a), with bias, drift and noise, at 5 kHz on a clock of its own; the
// tracker sees place and attitude of the handle at 60 Hz with noise in both, and now and then a frame is missing.
//   What the experimenter knows of the tool (mass, centre, bias) is as wrong as a calibration leaves it.
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "harness/base/random.h"
#include "tap_alignment.h"

namespace touchstone::acquisition {

struct ProbeSession {
  ClockStreams streams;
  double offset_s = 0.0, skew = 0.0, length_s = 0.0;
  double tool_mass_kg = 0.0, stiffness_N_per_m = 0.0;
  std::vector<double> touches_s;  // first contacts, on the tracker's clock
  [[nodiscard]] double true_force_time(double t_motion_s) const { return t_motion_s * (1.0 + skew) + offset_s; }
};

struct ProbePlan {
  double tool_mass_low_kg = 0.05, tool_mass_high_kg = 0.3;
  int taps_before = 4, taps_after = 4;
  double rhythm_s = 0.0;  // 0: uneven
  bool scan = true;
  bool tool_known = true;
};

class HandHeldProbe {
 public:
  HandHeldProbe(std::uint64_t seed, const ProbePlan& plan) : random_(seed), plan_(plan) {
    draw_bodies();
    draw_motion();
  }

  ProbeSession run() {
    ProbeSession s;
    s.offset_s = random_.uniform(-5, 5);
    s.skew = random_.uniform(-100e-6, 100e-6);
    s.length_s = length_s_;
    s.tool_mass_kg = tool_kg_;
    s.stiffness_N_per_m = stiffness_;
    const Quat q_TW = random_.rotation();
    ClockStreams& out = s.streams;
    out.gravity_T_m_per_s2 = q_TW * Vec3(0, 0, -9.81);
    out.normal_T = q_TW * Vec3::UnitZ();
    out.tip_S_m = tip_S_;
    if (plan_.tool_known) {
      out.tool.mass_kg = tool_kg_ * (1.0 + 0.005 * random_.normal());
      out.tool.center_S_m = tool_center_S_ + 3e-4 * random_.normal() * Vec3::UnitZ();
      out.tool.bias.f_N = bias_N_ + 0.01 * Vec3(random_.normal(), random_.normal(), random_.normal());
    }
    const double force_noise = random_.uniform(0.005, 0.02), place_noise = random_.uniform(5e-5, 1.5e-4),
                 turn_noise = random_.uniform(3e-4, 1.5e-3);
    const Vec3 drift = 0.02 / length_s_ * Vec3(random_.normal(), random_.normal(), random_.normal());

    Vec3 x = target_tip(0.0) - target_turn(0.0) * (tip_S_ - center_S_), v = Vec3::Zero();
    Quat q = target_turn(0.0);
    Vec3 w_B = Vec3::Zero();
    bool touching = false;
    double next_frame = 0.0;
    const auto steps = static_cast<std::size_t>(length_s_ / step_s);
    for (std::size_t i = 0; i < steps; ++i) {
      const double t = static_cast<double>(i) * step_s;
      const Vec3 w = q * w_B;
      // Contact at the tip.
      const Vec3 tip_arm = q * (tip_S_ - center_S_), tip = x + tip_arm, tip_v = v + w.cross(tip_arm);
      Vec3 contact = Vec3::Zero();
      if (tip.z() < 0.0) {
        const double depth = -tip.z();
        const double push =
            stiffness_ * std::pow(depth / 1e-3, exponent_) * 1e-3 * (1.0 - damping_s_per_m_ * tip_v.z());
        if (push > 0.0) {
          const Vec3 slide(tip_v.x(), tip_v.y(), 0.0);
          contact = Vec3(0, 0, push) - friction_ * push * slide / std::max(slide.norm(), 0.005);
        }
      }
      if (contact.z() > 0.0 && !touching) s.touches_s.push_back(t);
      touching = contact.z() > 0.0;
      // The hand at the grip.
      const Vec3 grip_arm = q * (grip_S_ - center_S_);
      const Target target = target_at(t);
      const Vec3 hand = hand_N_per_m_ * (target.grip - x - grip_arm) +
                        hand_Ns_per_m_ * (target.grip_v - v - w.cross(grip_arm)) + Vec3(0, 0, 9.81 * held_kg_);
      const Eigen::AngleAxisd turn(target.q * q.conjugate());
      const double angle = turn.angle() > std::numbers::pi ? turn.angle() - 2 * std::numbers::pi : turn.angle();
      const Vec3 twist = hand_Nm_per_rad_ * angle * turn.axis() - hand_Nms_per_rad_ * w;
      // Newton and Euler.
      const Vec3 a = (contact + hand) / total_kg_ + Vec3(0, 0, -9.81 * held_kg_ / total_kg_);
      const Vec3 torque_B = q.conjugate() * (tip_arm.cross(contact) + grip_arm.cross(hand) + twist);
      const Vec3 spin_B = (torque_B - w_B.cross(Vec3(inertia_.cwiseProduct(w_B)))).cwiseQuotient(inertia_);
      if (i % force_every == 0) {
        const Vec3 arm = tool_center_S_ - center_S_;
        const Vec3 tool_a = a + q * (spin_B.cross(arm) + w_B.cross(w_B.cross(arm)));
        const Vec3 pull = contact + tool_kg_ * (Vec3(0, 0, -9.81) - tool_a);
        out.t_force_s.push_back(s.true_force_time(t));
        out.force_S_N.push_back(q.conjugate() * pull + bias_N_ + drift * t +
                                force_noise * Vec3(random_.normal(), random_.normal(), random_.normal()));
      }
      if (t >= next_frame) {
        next_frame += 1.0 / 60;
        if (random_.uniform() > 0.002) {
          // The body that the tracker sees is the handle's; the tip is half a metre of noise away per radian.
          const Vec3 origin =
              x - q * center_S_ + place_noise * Vec3(random_.normal(), random_.normal(), random_.normal());
          const Vec3 tilt = turn_noise * Vec3(random_.normal(), random_.normal(), random_.normal());
          const Quat seen = (Quat(Eigen::AngleAxisd(tilt.norm(), tilt.normalized())) * q).normalized();
          out.t_motion_s.push_back(t);
          out.tip_T_m.push_back(q_TW * (origin + seen * tip_S_));
          out.q_TS.push_back((q_TW * seen).normalized());
        }
      }
      v += step_s * a;
      x += step_s * v;
      w_B += step_s * spin_B;
      const Vec3 step = step_s * w_B;
      if (step.norm() > 0.0) q = (q * Quat(Eigen::AngleAxisd(step.norm(), step.normalized()))).normalized();
    }
    return s;
  }

 private:
  static constexpr double step_s = 1e-4;         // stiffest contact on the lightest body: 250 rad/s
  static constexpr std::size_t force_every = 2;  // 5 kHz
  static constexpr double target_step_s = 1e-3;  // the hand's aim is slow: between its values, straight lines

  struct Target {
    Vec3 grip, grip_v;
    Quat q;
  };
  struct Knot {
    double t_s, height_m;
  };

  void draw_bodies() {
    tool_kg_ = random_.log_uniform(plan_.tool_mass_low_kg, plan_.tool_mass_high_kg);
    tool_center_S_ = Vec3(random_.uniform(-1e-3, 1e-3), random_.uniform(-1e-3, 1e-3), random_.uniform(0.01, 0.04));
    tip_S_ = Vec3(random_.uniform(-1e-3, 1e-3), 0, random_.uniform(0.04, 0.09));
    const double handle = random_.uniform(0.1, 0.25), hand = random_.uniform(0.05, 0.15);
    const double handle_z = -0.05, grip_z = random_.uniform(-0.07, -0.04);
    grip_S_ = Vec3(0, 0, grip_z);
    held_kg_ = tool_kg_ + handle;
    total_kg_ = held_kg_ + hand;
    center_S_ = (tool_kg_ * tool_center_S_ + handle * Vec3(0, 0, handle_z) + hand * grip_S_) / total_kg_;
    const auto about = [&](double mass, const Vec3& place, double gyration_m) {
      const Vec3 d = place - center_S_;
      return mass * (gyration_m * gyration_m + d.z() * d.z());
    };
    const double across =
        about(tool_kg_, tool_center_S_, 0.02) + about(handle, Vec3(0, 0, handle_z), 0.04) + about(hand, grip_S_, 0.03);
    inertia_ = Vec3(across, across, 0.4 * across);
    // Stiffness and damping ratio of a fingertip (Hajian and Howe, J. Biomech. Eng. 119, 1997: 200 to 800 N/m, about
    // 1).
    hand_N_per_m_ = random_.uniform(200, 800);
    hand_Ns_per_m_ = random_.uniform(0.6, 1.2) * 2.0 * std::sqrt(hand_N_per_m_ * total_kg_);
    hand_Nm_per_rad_ = random_.uniform(2, 6);
    hand_Nms_per_rad_ = random_.uniform(0.04, 0.12);
    stiffness_ = random_.log_uniform(2e3, 4e4);
    exponent_ = random_.uniform() < 0.5 ? 1.0 : 1.5;  // a spring, or Hertz' sphere
    damping_s_per_m_ = random_.uniform(2.0, 6.0);     // restitution 0.8 to 0.4 at 0.1 m/s
    friction_ = random_.uniform(0.1, 0.4);
    bias_N_ = Vec3(random_.uniform(-1, 1), random_.uniform(-1, 1), random_.uniform(-1, 1));
  }

  void draw_motion() {
    rest_m_ = random_.uniform(0.015, 0.03);
    double t = 1.0;
    knots_.push_back({0.0, rest_m_});
    knots_.push_back({t, rest_m_});
    const auto taps = [&](int count) {
      for (int i = 0; i < count; ++i) {
        const double down = random_.uniform(0.18, 0.35), up = random_.uniform(0.15, 0.3),
                     dwell = random_.uniform(0.0, 0.05), aim = -random_.uniform(2e-3, 6e-3);
        knots_.push_back({t + down, aim});
        knots_.push_back({t + down + dwell, aim});
        knots_.push_back({t + down + dwell + up, random_.uniform(0.6, 1.2) * rest_m_});
        t += std::max(down + dwell + up + 0.02, plan_.rhythm_s > 0.0 ? plan_.rhythm_s : random_.uniform(0.6, 1.1));
        knots_.push_back({t, knots_.back().height_m});
      }
    };
    taps(plan_.taps_before);
    t += random_.uniform(0.5, 4.0);
    if (plan_.scan) {
      knots_.push_back({t, rest_m_});
      for (int stroke = 0; stroke < 4; ++stroke) {
        const double press = -random_.uniform(1e-3, 4e-3);
        knots_.push_back({t += random_.uniform(0.4, 0.9), press});
        knots_.push_back({t += random_.uniform(3, 6), press});
        knots_.push_back({t += random_.uniform(0.3, 0.6), rest_m_});
        knots_.push_back({t += random_.uniform(0.3, 1.5), rest_m_});
      }
      t += random_.uniform(0.3, 3.0);
    }
    knots_.push_back({t, rest_m_});
    taps(plan_.taps_after);
    length_s_ = t + random_.uniform(0.8, 2.0);
    knots_.push_back({length_s_ + 1.0, rest_m_});
    for (Wave& wave : sway_) wave = {random_.uniform(0.005, 0.03), random_.uniform(0.1, 0.6), random_.uniform(0, 6.28)};
    for (Wave& wave : tilt_) wave = {random_.uniform(0.03, 0.25), random_.uniform(0.1, 0.5), random_.uniform(0, 6.28)};
    for (Wave& wave : tremor_) wave = {random_.uniform(2e-5, 1e-4), random_.uniform(8, 12), random_.uniform(0, 6.28)};
    for (double at = 0.0; at < length_s_ + 2 * target_step_s; at += target_step_s) {
      const Quat q = target_turn(at);
      aims_.push_back({target_tip(at) - q * (tip_S_ - grip_S_), Vec3::Zero(), q});
    }
    for (std::size_t i = 0; i + 1 < aims_.size(); ++i)
      aims_[i].grip_v = (aims_[i + 1].grip - aims_[i].grip) / target_step_s;
  }

  struct Wave {
    double size = 0.0, hertz = 0.0, phase = 0.0;
    [[nodiscard]] double at(double t) const { return size * std::sin(2 * std::numbers::pi * hertz * t + phase); }
  };

  [[nodiscard]] Vec3 target_tip(double t) const {
    std::size_t k = 0;
    while (k + 2 < knots_.size() && knots_[k + 1].t_s <= t) ++k;
    const double u = std::clamp((t - knots_[k].t_s) / std::max(1e-9, knots_[k + 1].t_s - knots_[k].t_s), 0.0, 1.0);
    const double jerk_free = u * u * u * (10 - 15 * u + 6 * u * u);
    const double z = knots_[k].height_m + jerk_free * (knots_[k + 1].height_m - knots_[k].height_m);
    return Vec3(sway_[0].at(t) + tremor_[0].at(t), sway_[1].at(t) + tremor_[1].at(t), z + tremor_[2].at(t));
  }
  [[nodiscard]] Quat target_turn(double t) const {
    return Quat(Eigen::AngleAxisd(std::numbers::pi + tilt_[0].at(t), Vec3::UnitX()) *
                Eigen::AngleAxisd(tilt_[1].at(t), Vec3::UnitY()));
  }
  [[nodiscard]] Target target_at(double t) const {
    const auto i = static_cast<std::size_t>(t / target_step_s);
    const double f = t / target_step_s - static_cast<double>(i);
    const Target &a = aims_[i], &b = aims_[i + 1];
    return {(1 - f) * a.grip + f * b.grip, a.grip_v, a.q.slerp(f, b.q)};
  }

  Random random_;
  ProbePlan plan_;
  double tool_kg_ = 0, held_kg_ = 0, total_kg_ = 0, hand_N_per_m_ = 0, hand_Ns_per_m_ = 0, hand_Nm_per_rad_ = 0,
         hand_Nms_per_rad_ = 0, stiffness_ = 0, exponent_ = 1, damping_s_per_m_ = 0, friction_ = 0, rest_m_ = 0,
         length_s_ = 0;
  Vec3 tool_center_S_, tip_S_, grip_S_, center_S_, inertia_, bias_N_;
  std::vector<Knot> knots_;
  std::vector<Target> aims_;
  Wave sway_[2], tilt_[2], tremor_[3];
};

}  // namespace touchstone::acquisition
