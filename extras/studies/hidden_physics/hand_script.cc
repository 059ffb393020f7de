#include "hidden_physics/hand_script.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace touchstone::hidden_physics {
namespace {

double smooth_step(double x) {
  const double s = std::clamp(x, 0.0, 1.0);
  return s * s * s * (10.0 + s * (-15.0 + 6.0 * s));
}

}  // namespace

HandScript::HandScript(const ScriptSettings& settings, Random random) : settings_(settings) {
  add(0.0, settings.half_side_m * Vec2(random.uniform(-0.3, 0.3), random.uniform(-0.3, 0.3)), settings.depth_m);
  switch (settings.style) {
    case ScriptStyle::varied:
    case ScriptStyle::upright:
      vary(random);
      break;
    case ScriptStyle::one_speed:
      circle(random);
      break;
    case ScriptStyle::one_depth_press:
      press_one_place(random);
      break;
  }
  if (settings.style == ScriptStyle::upright) return;
  for (int wave = 0; wave < 2; ++wave) {
    turn_rad_.emplace_back(random.uniform(0.08, 0.18), random.uniform(0.08, 0.18), random.uniform(0.05, 0.15));
    const double rate = 2.0 * std::numbers::pi * settings.pace;
    turn_rate_.emplace_back(rate * random.uniform(0.08, 0.35), rate * random.uniform(0.08, 0.35),
                            rate * random.uniform(0.05, 0.2));
    turn_phase_.emplace_back(random.uniform(0.0, 6.28), random.uniform(0.0, 6.28), random.uniform(0.0, 6.28));
  }
}

void HandScript::add(double duration_s, const Vec2& xy_m, double height_m) {
  const double before = keys_.empty() ? 0.0 : keys_.back().t_s;
  keys_.push_back({before + duration_s, {xy_m, height_m}});
}

void HandScript::vary(Random& random) {
  const double L = settings_.half_side_m;
  const double pace = settings_.pace;
  const auto place = [&] { return Vec2(L * random.uniform(-0.6, 0.6), L * random.uniform(-0.6, 0.6)); };
  const auto depth = [&] { return settings_.depth_m * settings_.load * random.uniform(0.3, 1.0); };
  const auto above = [&] { return settings_.depth_m * random.uniform(0.2, 0.8); };
  for (std::uint64_t turn = random.below(3); keys_.back().t_s < settings_.duration_s; ++turn) {
    const Vec2 here = place();
    add(random.uniform(0.5, 1.1) / pace, here, above());
    switch (turn % 3) {
      case 0: {
        const std::uint64_t presses = 2 + random.below(3);
        for (std::uint64_t i = 0; i < presses; ++i) {
          const double half_s = random.log_uniform(0.15, 0.8) / pace;
          add(half_s, here, -depth());
          add(half_s, here, above());
        }
        break;
      }
      case 1:
        add(random.log_uniform(0.12, 0.5) / pace, here, -depth());
        add(random.uniform(1.0, 2.2), here, keys_.back().aim.height_m);
        add(random.log_uniform(0.12, 0.5) / pace, here, above());
        break;
      default: {
        add(random.uniform(0.25, 0.5) / pace, here, -depth());
        const std::uint64_t strokes = 3 + random.below(4);
        for (std::uint64_t i = 0; i < strokes; ++i) {
          const double height = random.uniform() < 0.5 ? keys_.back().aim.height_m : -depth();
          add(random.log_uniform(0.3, 1.6) / pace, place(), height);
          if (random.uniform() < 0.3) add(random.uniform(0.2, 0.6), keys_.back().aim.xy_m, height);
        }
        add(random.uniform(0.25, 0.5) / pace, keys_.back().aim.xy_m, above());
        break;
      }
    }
  }
}

void HandScript::circle(Random& random) {
  circle_radius_m_ = 0.4 * settings_.half_side_m;
  const Vec2 centre = settings_.half_side_m * Vec2(random.uniform(-0.1, 0.1), random.uniform(-0.1, 0.1));
  // Down once, quickly: while the load changes, friction and viscosity part.
  add(0.5, centre, 0.2 * settings_.depth_m);
  add(0.1, centre, -0.6 * settings_.depth_m);
}

void HandScript::press_one_place(Random& random) {
  const Vec2 here = settings_.half_side_m * Vec2(random.uniform(-0.2, 0.2), random.uniform(-0.2, 0.2));
  while (keys_.back().t_s < settings_.duration_s) {
    add(0.5, here, 0.4 * settings_.depth_m);
    add(0.5, here, -0.7 * settings_.depth_m);
  }
}

HandScript::Aim HandScript::at(double t_s) const {
  const auto after =
      std::upper_bound(keys_.begin(), keys_.end(), t_s, [](double t, const Key& key) { return t < key.t_s; });
  Aim aim;
  if (after == keys_.begin()) {
    aim = keys_.front().aim;
  } else if (after == keys_.end()) {
    aim = keys_.back().aim;
  } else {
    const Key& before = *(after - 1);
    const double share = smooth_step((t_s - before.t_s) / (after->t_s - before.t_s));
    aim.xy_m = before.aim.xy_m + share * (after->aim.xy_m - before.aim.xy_m);
    aim.height_m = before.aim.height_m + share * (after->aim.height_m - before.aim.height_m);
  }
  if (circle_radius_m_ > 0.0) {
    const double angle = settings_.circle_m_per_s / circle_radius_m_ * t_s;
    aim.xy_m += circle_radius_m_ * Vec2(std::cos(angle), std::sin(angle));
  }
  return aim;
}

Quat HandScript::turn(double t_s) const {
  Vec3 angle = Vec3::Zero();
  for (std::size_t w = 0; w < turn_rad_.size(); ++w) {
    for (int axis = 0; axis < 3; ++axis) {
      angle[axis] += turn_rad_[w][axis] * std::sin(turn_rate_[w][axis] * t_s + turn_phase_[w][axis]);
    }
  }
  return Quat(Eigen::AngleAxisd(angle.x(), Vec3::UnitX()) * Eigen::AngleAxisd(angle.y(), Vec3::UnitY()) *
              Eigen::AngleAxisd(angle.z(), Vec3::UnitZ()));
}

}  // namespace touchstone::hidden_physics
