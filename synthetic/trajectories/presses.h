// Motions against the surface: taps, a deep push, jumps; and a spiral at constant depth.
#pragma once

#include <cstdint>

#include "synthetic/trajectories/path.h"

namespace touchstone::synthetic {

// z goes as height and depth of a cosine: free at the start, deepest in the middle of every period.
class TapPath final : public Path {
 public:
  TapPath(double height_m, double depth_m, double period_s, double taps)
      : height_m_(height_m), depth_m_(depth_m), period_s_(period_s), taps_(taps) {}
  [[nodiscard]] Vec3 position_W_m(double t_s) const override;
  [[nodiscard]] double duration_s() const override { return period_s_ * taps_; }

 private:
  double height_m_;
  double depth_m_;
  double period_s_;
  double taps_;
};

// Straight down from a height to a depth that may lie beyond a shell's other side, aside while there, and up again at
// the shifted place: a renderer that popped through shows it on the way back. Constant speed.
class PushPath final : public Path {
 public:
  PushPath(double height_m, double depth_m, double shift_m, double speed_m_per_s)
      : height_m_(height_m), depth_m_(depth_m), shift_m_(shift_m), speed_m_per_s_(speed_m_per_s) {}
  [[nodiscard]] Vec3 position_W_m(double t_s) const override;
  [[nodiscard]] double duration_s() const override {
    return (2.0 * (height_m_ + depth_m_) + shift_m_) / speed_m_per_s_;
  }

 private:
  double height_m_;
  double depth_m_;
  double shift_m_;
  double speed_m_per_s_;
};

// Rests, then is elsewhere from one sample to the next: seeded places in a square, between a height and a depth.
class JumpPath final : public Path {
 public:
  JumpPath(std::uint64_t seed, double side_m, double height_m, double depth_m, double rest_s, double jumps)
      : seed_(seed), side_m_(side_m), height_m_(height_m), depth_m_(depth_m), rest_s_(rest_s), jumps_(jumps) {}
  [[nodiscard]] Vec3 position_W_m(double t_s) const override;
  [[nodiscard]] double duration_s() const override { return rest_s_ * jumps_; }

 private:
  std::uint64_t seed_;
  double side_m_;
  double height_m_;
  double depth_m_;
  double rest_s_;
  double jumps_;
};

// Archimedes' spiral from the middle outwards at constant path speed.
class SpiralPath final : public Path {
 public:
  SpiralPath(double radius_m, double turns, double speed_m_per_s, double depth_m)
      : radius_m_(radius_m), turns_(turns), speed_m_per_s_(speed_m_per_s), depth_m_(depth_m) {}
  [[nodiscard]] Vec3 position_W_m(double t_s) const override;
  [[nodiscard]] double duration_s() const override;

 private:
  double radius_m_;
  double turns_;
  double speed_m_per_s_;
  double depth_m_;
};

}  // namespace touchstone::synthetic
