// What the hand of a blind case wants to do: presses, holds and strokes of varied speed, load and place, with free air
// between, and a tool that turns slowly meanwhile. Minimum-jerk movements (Flash and Hogan 1985) between key frames.
#pragma once

#include <vector>

#include "harness/base/random.h"
#include "hidden_physics/true_surface.h"

namespace touchstone::hidden_physics {

enum class ScriptStyle {
  varied,           // everything that tells effects apart
  upright,          // the same, the tool never turned
  one_speed,        // circles at one load and one speed, the tool turned
  one_depth_press,  // presses of one depth at one speed on one place
};

struct ScriptSettings {
  ScriptStyle style = ScriptStyle::varied;
  double half_side_m = 0.05;
  double depth_m = 5e-3;  // of the hardest press
  double duration_s = 20.0;
  double pace = 1.0;  // above 1: quicker
  double load = 1.0;  // of depth_m
  double circle_m_per_s = 0.05;
};

class HandScript {
 public:
  HandScript(const ScriptSettings& settings, Random random);

  struct Aim {
    Vec2 xy_m = Vec2::Zero();
    double height_m = 0.0;  // above the surface along its normal; negative: pressed
  };
  [[nodiscard]] Aim at(double t_s) const;
  [[nodiscard]] Quat turn(double t_s) const;

 private:
  void add(double duration_s, const Vec2& xy_m, double height_m);
  void vary(Random& random);
  void circle(Random& random);
  void press_one_place(Random& random);

  struct Key {
    double t_s = 0.0;
    Aim aim;
  };
  ScriptSettings settings_;
  std::vector<Key> keys_;
  double circle_radius_m_ = 0.0;
  std::vector<Vec3> turn_rad_;  // amplitudes of two slow waves
  std::vector<Vec3> turn_rate_;
  std::vector<Vec3> turn_phase_;
};

}  // namespace touchstone::hidden_physics
