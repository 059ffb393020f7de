// For tests: whole sessions as files, undisturbed or with one disturbance, with the truth beside them. Nothing in it is
// taken from the acquisition: kinematics of a probe that follows a given path over an analytic surface, Newton's law
// for what its tool pulls, a spring and Coulomb friction for the contact.
//   Surface: z(x, y) of two bumps; the ball's centre lies radius + h along its normal from it, h >= 0 in the air, and
// h = -N / k in contact. Sensor: f = R' (F_contact + m (g - a)) + bias + noise, torque about its origin, 1 kHz on a
// clock with offset and skew. Tracker: the probe's body at 60 Hz with noise in place and attitude. Accelerations by
// second differences of the exact path over 1 ms.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <numbers>
#include <string>
#include <string_view>
#include <vector>

#include "harness/base/atomic_file.h"
#include "harness/base/random.h"
#include "harness/base/vec.h"

namespace touchstone::acquisition {

enum class Disturbance {
  none,
  knock_at_start,
  knock_half_way,
  bias_drift,
  held_poses,
  swapped_markers,
  moved_object,
  wrong_tip,
  wrong_lever,
  turned_sensor,
  reversed_statics,
  lost_packets,
  cable,
  gain,
  later_gain
};
inline constexpr std::array all_disturbances{
    Disturbance::knock_at_start,  Disturbance::knock_half_way,   Disturbance::bias_drift,  Disturbance::held_poses,
    Disturbance::swapped_markers, Disturbance::moved_object,     Disturbance::wrong_tip,   Disturbance::wrong_lever,
    Disturbance::turned_sensor,   Disturbance::reversed_statics, Disturbance::lost_packets};
inline std::string_view name_of(Disturbance d) {
  constexpr std::array<std::string_view, 15> names{"none",
                                                   "knock at the start",
                                                   "knock half-way",
                                                   "bias drift",
                                                   "held poses",
                                                   "swapped markers",
                                                   "moved object",
                                                   "wrong tip",
                                                   "wrong lever",
                                                   "turned sensor",
                                                   "reversed statics",
                                                   "lost packets",
                                                   "cable",
                                                   "gain"};
  return names.at(static_cast<std::size_t>(d));
}

class SimulatedSession {
 public:
  // `scan_error_m`: 1-sigma, of the mesh that is written, along the surface as waves of 8 to 80 mm.
  SimulatedSession(std::uint64_t seed, Disturbance disturbance, double scan_error_m = 0.0)
      : random_(seed), disturbance_(disturbance) {
    Random scan(seed ^ 0x5ca1ab1e);
    for (Vec3& wave : scan_waves_) {
      const double angle = scan.uniform(0.0, 6.28), number = 6.28 / scan.log_uniform(8e-3, 80e-3);
      wave = Vec3(number * std::cos(angle), number * std::sin(angle), scan.uniform(0.0, 6.28));
    }
    scan_amplitude_m_ = scan_error_m * std::sqrt(2.0 / static_cast<double>(scan_waves_.size()));
    const auto any = [&](double low, double high) { return random_.uniform(low, high); };
    mass_ = any(0.06, 0.25);
    center_S_ = Vec3(any(-2e-3, 2e-3), any(-2e-3, 2e-3), any(0.02, 0.04));
    tip_S_ = Vec3(any(-2e-3, 2e-3), any(-2e-3, 2e-3), any(0.05, 0.09));
    tip_P_ = Vec3(any(-0.03, 0.03), any(-0.03, 0.03), any(0.09, 0.14));
    q_PS_ = random_.rotation();
    q_TW_ = random_.rotation();
    object_T_ = Vec3(any(-0.4, 0.4), any(-0.4, 0.4), any(-0.4, 0.4));
    radius_ = any(1e-3, 3e-3);
    stiffness_ = any(4e3, 2e4);
    friction_ = any(0.1, 0.4);
    bias_ = 2.0 * random_.direction();
    torque_bias_ = 0.02 * random_.direction();
    for (double& p : phase_) p = any(0.0, 6.28);
    offset_s_ = any(-2.0, 2.0);
    skew_ = any(-80e-6, 80e-6);
    step_N_ = any(0.15, 0.8) * random_.direction();
    swap_m_ = random_.log_uniform(4e-3, 30e-3) * random_.direction();
    swap_rad_ = any(0.0, 0.2) * random_.direction();
    swap_frames_ = 3 + random_.below(10);
    held_frames_ = 3 + random_.below(25);
    move_m_ = random_.log_uniform(1.5e-3, 8e-3) * random_.direction();
    move_rad_ = any(0.0, 0.05) * random_.direction();
    tip_off_m_ = random_.log_uniform(2e-3, 8e-3) * random_.direction();
    sensor_turn_rad_ = any(0.08, 0.25) * random_.direction();
    double t = any(1.2, 2.0);
    for (int i = 0; i < 4; ++i) taps_.push_back(t), t += any(0.6, 1.1);
    scan_from_ = t + any(0.8, 1.5);
    scan_to_ = scan_from_ + 20.0;
    t = scan_to_ + any(1.2, 1.8);
    for (int i = 0; i < 4; ++i) taps_.push_back(t), t += any(0.6, 1.1);
    length_s_ = t + 1.0;
  }

  // The files; returns the description's path.
  std::filesystem::path write(const std::filesystem::path& folder) {
    write_force(folder / "force.csv");
    write_motion(folder / "motion.csv");
    write_rest(folder);
    return folder / "acquisition.json";
  }

  // Truth, in the object's frame, which an object that is moved carries with it: where the tip is, what the surface
  // does to it, and whether the smoothed force can follow that (scanning, away from taps).
  [[nodiscard]] Vec3 tip(double t) const {
    const Vec3 p = foot_and_height(t);
    return Vec3(p.x(), p.y(), bumps(p.x(), p.y())) + (radius_ + p.z()) * normal_at(p.x(), p.y());
  }
  [[nodiscard]] Vec3 contact(double t) const {
    const Vec3 p = foot_and_height(t);
    if (p.z() >= 0.0) return Vec3::Zero();
    const Vec3 n = normal_at(p.x(), p.y());
    const double push = -stiffness_ * p.z();
    Vec3 v = (tip(t + 5e-4) - tip(t - 5e-4)) / 1e-3;
    v -= n * n.dot(v);
    return push * n - friction_ * push * v / std::max(v.norm(), 2e-3);
  }
  // Of the ball, where it touches.
  [[nodiscard]] Vec3 foot(double t) const {
    const Vec3 p = foot_and_height(t);
    return -radius_ * normal_at(p.x(), p.y());
  }
  [[nodiscard]] bool steady(double t) const { return t > scan_from_ + 1.0 && t < scan_to_ - 1.0; }

 private:
  static constexpr double cable_N_per_m = 5.0, wrong_gain = 1.12;

  static double bumps(double x, double y) {
    return 0.012 * std::exp(-((x - 0.012) * (x - 0.012) + (y + 0.02) * (y + 0.02)) / (2 * 0.04 * 0.04)) +
           0.004 * std::sin(x / 0.025) * std::cos(y / 0.03);
  }
  [[nodiscard]] double scan_error(double x, double y) const {
    double sum = 0.0;
    for (const Vec3& wave : scan_waves_) sum += std::cos(wave.x() * x + wave.y() * y + wave.z());
    return scan_amplitude_m_ * sum;
  }
  static Vec3 normal_at(double x, double y) {
    constexpr double step = 1e-5;
    return Vec3(-(bumps(x + step, y) - bumps(x - step, y)) / (2 * step),
                -(bumps(x, y + step) - bumps(x, y - step)) / (2 * step), 1.0)
        .normalized();
  }
  static double smooth_step(double u) {
    u = std::clamp(u, 0.0, 1.0);
    return u * u * u * (10 - 15 * u + 6 * u * u);
  }
  [[nodiscard]] Vec3 foot_and_height(double t) const {
    const double scanning = smooth_step((t - scan_from_) / 0.6) * smooth_step((scan_to_ - t) / 0.6);
    const double u = t - scan_from_;
    const Vec3 rest(0.012, -0.02, 0.0);  // the top of the large bump: level there
    const Vec3 path(0.05 * std::sin(0.9 * u + phase_[0]), 0.045 * std::sin(0.61 * u + phase_[1]), 0.0);
    Vec3 place =
        rest + smooth_step((t - scan_from_ + 0.7) / 0.7) * smooth_step((scan_to_ + 0.7 - t) / 0.7) * (path - rest);
    const double load = 1.3 + 0.5 * std::sin(1.7 * u + phase_[2]);
    const double air = 0.014 + 0.002 * std::sin(1.3 * t + phase_[3]);
    double h = air + scanning * (-load / stiffness_ - air);
    for (const double tap : taps_) {
      // Down and up within 0.25 s each, aimed below the surface; the depth saturates as the hand gives.
      const double down = smooth_step(1.0 - std::abs(t - tap) / 0.25);
      const double aim = air - down * (air + 2.5e-3), give = 1.5 / stiffness_;
      if (std::abs(t - tap) < 0.25) h = aim > 0.0 ? aim : -give * (1.0 - std::exp(aim / give));
    }
    return {place.x(), place.y(), h};
  }
  [[nodiscard]] Quat attitude(double t) const {  // sensor to object
    return Quat(Eigen::AngleAxisd(std::numbers::pi + 0.3 * std::sin(0.43 * t + phase_[4]), Vec3::UnitX()) *
                Eigen::AngleAxisd(0.3 * std::sin(0.37 * t + phase_[5]), Vec3::UnitY()) *
                Eigen::AngleAxisd(0.5 * std::sin(0.21 * t), Vec3::UnitZ()));
  }
  // Half-way through the scan the object is pushed aside, within a second.
  [[nodiscard]] Vec3 on_moved_object(const Vec3& p, double t) const {
    if (disturbance_ != Disturbance::moved_object) return p;
    const double share = smooth_step(t - 0.5 * (scan_from_ + scan_to_));
    return turn(share * move_rad_) * p + share * move_m_;
  }
  static Quat turn(const Vec3& rotation_vector) {
    return Quat(Eigen::AngleAxisd(rotation_vector.norm(), rotation_vector.normalized()));
  }
  [[nodiscard]] Vec3 noise(double size) { return size * Vec3(random_.normal(), random_.normal(), random_.normal()); }

  Vec3 bias_at(double t) const {
    if (disturbance_ == Disturbance::knock_at_start && t > 0.5) return bias_ + step_N_;
    if (disturbance_ == Disturbance::knock_half_way && t > 0.5 * length_s_) return bias_ + step_N_;
    if (disturbance_ == Disturbance::bias_drift) return bias_ + t / length_s_ * step_N_;
    return bias_;
  }
  // `later`: than the static poses.
  [[nodiscard]] Vec3 measured(const Vec3& f, bool later) const {
    const bool wrong = disturbance_ == Disturbance::gain || (later && disturbance_ == Disturbance::later_gain);
    return wrong ? Vec3(f.x(), f.y(), wrong_gain * f.z()) : f;
  }
  // What the tool pulls at rest or moving, in the sensor's frame, with bias.
  // `foot_W`: where the surface pushes, from the ball's centre.
  std::array<Vec3, 2> sensor(const Quat& q, const Vec3& push, const Vec3& foot_W, const Vec3& acceleration,
                             const Vec3& bias) const {
    const Vec3 g_W = q_TW_.conjugate() * Vec3(0, 0, -9.81);
    const Vec3 own = q.conjugate() * (mass_ * (g_W - acceleration)), felt = q.conjugate() * push;
    return {own + felt + bias, center_S_.cross(own) + (tip_S_ + q.conjugate() * foot_W).cross(felt) + torque_bias_};
  }

  void write_force(const std::filesystem::path& file) {
    std::string text = "t_s,fx_N,fy_N,fz_N,tx_Nm,ty_Nm,tz_Nm\n";
    const auto center = [&](double t) -> Vec3 { return tip(t) + attitude(t) * (center_S_ - tip_S_); };
    const auto count = static_cast<std::size_t>(length_s_ / 1e-3);
    for (std::size_t i = 0; i < count; ++i) {
      const double t = 1e-3 * static_cast<double>(i);
      if (disturbance_ == Disturbance::lost_packets && i % 97 < 9) continue;
      Vec3 a = (center(t + 1e-3) - 2 * center(t) + center(t - 1e-3)) / 1e-6;
      if (disturbance_ == Disturbance::cable) a += cable_N_per_m * (center(t) - center(0.0)) / mass_;
      auto w = sensor(attitude(t), contact(t), foot(t), a, bias_at(t));
      w[0] = measured(w[0], true) + noise(0.01), w[1] += noise(2e-4);
      text += fmt::format("{:.7f},{:.6f},{:.6f},{:.6f},{:.7f},{:.7f},{:.7f}\n", t * (1 + skew_) + offset_s_, w[0].x(),
                          w[0].y(), w[0].z(), w[1].x(), w[1].y(), w[1].z());
    }
    write_file(file, text);
  }

  void write_motion(const std::filesystem::path& file) {
    std::string text = "t_s,x_m,y_m,z_m,qw,qx,qy,qz\n", last;
    const auto count = static_cast<std::size_t>(length_s_ * 60.0);
    for (std::size_t i = 0; i < count; ++i) {
      const double t = static_cast<double>(i) / 60.0;
      const Quat q_TP = q_TW_ * attitude(t) * q_PS_.conjugate();
      Quat q = (turn(noise(1e-3)) * q_TP).normalized();
      Vec3 p = q_TW_ * on_moved_object(tip(t), t) + object_T_ - q_TP * tip_P_ + noise(8e-5);
      const std::size_t phase = i % 240;  // every four seconds
      if (disturbance_ == Disturbance::swapped_markers && phase >= 200 && phase < 200 + swap_frames_) {
        p += q_TW_ * swap_m_;
        q = q * turn(swap_rad_);
      }
      std::string pose = fmt::format("{:.8f},{:.8f},{:.8f},{:.9f},{:.9f},{:.9f},{:.9f}", p.x(), p.y(), p.z(), q.w(),
                                     q.x(), q.y(), q.z());
      if (disturbance_ == Disturbance::held_poses && phase >= 200 && phase < 200 + held_frames_) pose = last;
      text += fmt::format("{:.8f},{}\n", t, pose);
      last = pose;
    }
    write_file(file, text);
  }

  void write_rest(const std::filesystem::path& folder) {
    std::string statics = "fx_N,fy_N,fz_N,tx_Nm,ty_Nm,tz_Nm,qw,qx,qy,qz\n";
    const double sign = disturbance_ == Disturbance::reversed_statics ? -1.0 : 1.0;
    for (int i = 0; i < 12; ++i) {
      const Quat q = random_.rotation();  // sensor to tracker
      auto w = sensor(q_TW_.conjugate() * q, Vec3::Zero(), Vec3::Zero(), Vec3::Zero(), bias_);
      w[0] = sign * (measured(w[0], false) + noise(2e-3)), w[1] = sign * (w[1] + noise(4e-5));
      statics += fmt::format("{:.7f},{:.7f},{:.7f},{:.8f},{:.8f},{:.8f},{:.9f},{:.9f},{:.9f},{:.9f}\n", w[0].x(),
                             w[0].y(), w[0].z(), w[1].x(), w[1].y(), w[1].z(), q.w(), q.x(), q.y(), q.z());
    }
    write_file(folder / "statics.csv", statics);
    std::string markers = "x_m,y_m,z_m,mx_m,my_m,mz_m\n";
    for (const Vec3& m : {Vec3(0.08, -0.07, 0.01), Vec3(-0.08, 0.05, 0.02), Vec3(0.01, -0.08, 0.0),
                          Vec3(0.03, 0.08, -0.01), Vec3(-0.07, -0.06, 0.005)}) {
      const Vec3 s = q_TW_ * m + object_T_ + noise(1.5e-4);
      markers += fmt::format("{:.7f},{:.7f},{:.7f},{},{},{}\n", s.x(), s.y(), s.z(), m.x(), m.y(), m.z());
    }
    write_file(folder / "markers.csv", markers);
    std::string mesh;
    constexpr int cells = 100;
    for (int j = 0; j <= cells; ++j) {
      for (int i = 0; i <= cells; ++i) {
        const double x = 0.0018 * i - 0.09, y = 0.0018 * j - 0.09;
        mesh += fmt::format("v {:.6f} {:.6f} {:.7f}\n", x, y, bumps(x, y) + scan_error(x, y));
      }
    }
    for (int j = 0; j < cells; ++j) {
      for (int i = 0; i < cells; ++i) {
        const int a = j * (cells + 1) + i + 1, b = a + 1, c = a + cells + 1, d = c + 1;
        mesh += fmt::format("f {} {} {}\nf {} {} {}\n", a, b, d, a, d, c);
      }
    }
    write_file(folder / "object.obj", mesh);
    Vec3 tip_P = tip_P_;
    if (disturbance_ == Disturbance::wrong_tip) tip_P += tip_off_m_;
    Vec3 tip_S = tip_S_;
    if (disturbance_ == Disturbance::wrong_lever) tip_S += 2.0 * tip_off_m_;
    Quat q_PS = q_PS_;
    if (disturbance_ == Disturbance::turned_sensor) q_PS = q_PS * turn(sensor_turn_rad_);
    write_file(folder / "acquisition.json",
               fmt::format(R"({{"schema": "touchstone-acquisition/1", "force": {{"file": "force.csv", "cutoff_Hz": 20}},
 "motion": {{"file": "motion.csv"}},
 "probe": {{"tip_P_m": [{:.9f}, {:.9f}, {:.9f}], "tip_S_m": [{:.9f}, {:.9f}, {:.9f}],
           "q_PS": [{:.12f}, {:.12f}, {:.12f}, {:.12f}], "tip_radius_m": {:.9f}}},
 "tool": {{"file": "statics.csv", "gravity_T_m_per_s2": [0, 0, -9.81]}}, "clocks": {{"tap_normal_W": [0, 0, 1]}},
 "registration": {{"markers": "markers.csv", "mesh": "object.obj", "contact_force_N": 0.4}}}})",
                           tip_P.x(), tip_P.y(), tip_P.z(), tip_S.x(), tip_S.y(), tip_S.z(), q_PS.w(), q_PS.x(),
                           q_PS.y(), q_PS.z(), radius_));
  }

  Random random_;
  Disturbance disturbance_;
  double mass_ = 0, radius_ = 0, stiffness_ = 0, friction_ = 0, offset_s_ = 0, skew_ = 0, scan_from_ = 0, scan_to_ = 0,
         length_s_ = 0;
  Vec3 center_S_, tip_S_, tip_P_, object_T_, bias_, torque_bias_;
  Quat q_PS_, q_TW_;
  Vec3 step_N_, swap_m_, swap_rad_, move_m_, move_rad_, tip_off_m_, sensor_turn_rad_;  // of the disturbances
  std::size_t swap_frames_ = 0, held_frames_ = 0;
  std::array<double, 6> phase_{};
  std::array<Vec3, 12> scan_waves_;  // of the scan's error: wave numbers along x and y, phase
  double scan_amplitude_m_ = 0.0;
  std::vector<double> taps_;
};

}  // namespace touchstone::acquisition
