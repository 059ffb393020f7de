#include "renderers/effects/normal_laws.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "renderers/effects/in_frame.h"
#include "renderers/effects/rate_plan.h"

namespace touchstone::renderers {
using rendering::ContactState;
using rendering::Effect;
using rendering::EffectTraits;
using rendering::RecordingScales;

namespace {

class NormalDamping final : public Effect {
 public:
  explicit NormalDamping(double b) : b_(b) {}
  void reset() noexcept override {}
  void apply(ContactState& contact) noexcept override {
    if (contact.contact) contact.normal_force_N += b_ * contact.depth_rate_m_per_s;
  }

 private:
  double b_;
};

class HuntCrossley final : public Effect {
 public:
  explicit HuntCrossley(double b) : b_(b) {}
  void reset() noexcept override {}
  void apply(ContactState& contact) noexcept override {
    if (contact.contact) contact.normal_force_N += b_ * contact.depth_m * contact.depth_rate_m_per_s;
  }

 private:
  double b_;
};

class PowerLawStiffness final : public Effect {
 public:
  PowerLawStiffness(double exponent, double reference_depth) : power_(exponent - 1.0), reference_(reference_depth) {}
  void reset() noexcept override {}
  void apply(ContactState& contact) noexcept override {
    if (contact.contact && contact.depth_m > 0.0)
      contact.normal_force_N *= std::pow(contact.depth_m / reference_, power_);
  }

 private:
  double power_;
  double reference_;
};

class StiffnessMap final : public Effect {
 public:
  StiffnessMap(double amplitude, double x, double y, double width)
      : amplitude_(amplitude), x_(x), y_(y), scale_(-0.5 / (width * width)) {}
  void reset() noexcept override {}
  void apply(ContactState& contact) noexcept override {
    if (!contact.contact) return;
    const double dx = contact.proxy_W_m.x() - x_;
    const double dy = contact.proxy_W_m.y() - y_;
    contact.normal_force_N *= 1.0 + amplitude_ * std::exp(scale_ * (dx * dx + dy * dy));
  }

 private:
  double amplitude_;
  double x_;
  double y_;
  double scale_;
};

// Across the border the stiffness follows a logistic step (tanh) of the given half-width.
class TwoMaterials final : public Effect {
 public:
  TwoMaterials(double ratio, double direction, double border, double width)
      : log_ratio_(std::log(ratio)), x_(std::cos(direction)), y_(std::sin(direction)), border_(border), width_(width) {}
  void reset() noexcept override {}
  void apply(ContactState& contact) noexcept override {
    if (!contact.contact) return;
    const double beyond = x_ * contact.proxy_W_m.x() + y_ * contact.proxy_W_m.y() - border_;
    contact.normal_force_N *= std::exp(0.5 * log_ratio_ * (1.0 + std::tanh(beyond / width_)));
  }

 private:
  double log_ratio_;
  double x_;
  double y_;
  double border_;
  double width_;
};

class StressRelaxation final : public Effect {
 public:
  StressRelaxation(double ratio, double time_constant) : ratio_(ratio), time_constant_(time_constant) {}
  void reset() noexcept override {
    arm_N_ = 0.0;
    surface_m_ = 0.0;
  }
  void apply(ContactState& contact) noexcept override {
    const double k = contact.stiffness_N_per_m;
    const double tip_m = contact.contact ? contact.depth_m : 0.0;
    if (contact.dt_s > 0.0) {
      // s1 = kept + arm_k (u1 - u0) along a u that changes steadily.
      const double x = contact.dt_s / time_constant_;
      const double arm_k = -std::expm1(-x) / x * ratio_ * k;
      const double kept = arm_N_ * std::exp(-x) - arm_k * surface_m_;
      // Left alone the surface is where k u1 + s1 = 0; a tip that is deeper presses it.
      surface_m_ = k > 0.0 ? std::max(tip_m, -kept / (k + arm_k)) : tip_m;
      arm_N_ = kept + arm_k * surface_m_;
    } else {
      // A run that starts in contact: the arm has not had time to relax.
      surface_m_ = tip_m;
      arm_N_ = ratio_ * k * tip_m;
    }
    // Over a tip that does not reach it the surface has s = -k u: with the tip's k d the sum is a pull, which no
    // contact has.
    if (contact.contact) contact.normal_force_N += arm_N_;
  }

 private:
  double ratio_;
  double time_constant_;
  double arm_N_ = 0.0;
  double surface_m_ = 0.0;
};

}  // namespace

std::unique_ptr<Effect> make_normal_damping(std::span<const double> values) {
  return std::make_unique<NormalDamping>(values[0]);
}
std::unique_ptr<Effect> make_hunt_crossley(std::span<const double> values) {
  return std::make_unique<HuntCrossley>(values[0]);
}
std::unique_ptr<Effect> make_power_law_stiffness(std::span<const double> values) {
  return std::make_unique<PowerLawStiffness>(values[0], values[1]);
}
std::unique_ptr<Effect> make_stiffness_map(std::span<const double> values) {
  return in_frame(values, std::make_unique<StiffnessMap>(values[0], values[1], values[2], values[3]));
}
std::unique_ptr<Effect> make_two_materials(std::span<const double> values) {
  return in_frame(values, std::make_unique<TwoMaterials>(values[0], values[1], values[2], values[3]));
}
std::unique_ptr<Effect> make_stress_relaxation(std::span<const double> values) {
  return std::make_unique<StressRelaxation>(values[0], values[1]);
}

EffectTraits normal_damping_traits() {
  EffectTraits traits;
  traits.follows_speed = true;
  traits.one_sided = {
      {{"coefficient_N_s_per_m", 0.1}},
      0.1,
      "the contact gives energy, as a damping of {:.3g} N s/m would: does the force come before the position?"};
  traits.plan = [](const RecordingScales& scales) {
    return plan_of_rate("coefficient_N_s_per_m", scales.force_N, scales.depth_rate_m_per_s);
  };
  return traits;
}

EffectTraits hunt_crossley_traits() {
  EffectTraits traits;
  traits.follows_speed = true;
  traits.plan = [](const RecordingScales& scales) {
    return plan_of_rate("coefficient_N_s_per_m2", scales.force_N, scales.depth_rate_m_per_s * scales.depth_m);
  };
  return traits;
}

EffectTraits power_law_stiffness_traits() {
  EffectTraits traits;
  traits.plan = [](const RecordingScales& scales) {
    return rendering::SearchPlan{{{"exponent"}}, {{{"exponent", 1.2}, {"reference_depth_m", 0.5 * scales.depth_m}}}};
  };
  return traits;
}

EffectTraits stiffness_map_traits() {
  EffectTraits traits;
  traits.along_surface = true;
  traits.peaks = EffectTraits::Peaks::stiffness;
  return traits;
}

// From a wide border, which any start sees, to a narrow one, over which derivatives are taken in steps that it cannot
// fall between.
EffectTraits two_materials_traits() {
  EffectTraits traits;
  traits.along_surface = true;
  traits.plan = [](const RecordingScales& scales) {
    constexpr double pi = std::numbers::pi;
    constexpr double step = 0.1;  // of the scale
    const double extent_m = scales.extent_m();
    rendering::SearchedParameter ratio{"ratio"};
    ratio.lower = 0.02, ratio.upper = 50.0, ratio.logarithmic = true;
    rendering::SearchedParameter direction{"direction_rad", 0.3, -2.0 * pi, 2.0 * pi};
    rendering::SearchedParameter border{"border_m", 0.1 * extent_m};
    direction.step = border.step = step;
    // Within what was touched, on both sides of which something must be.
    const Vec3 middle_m = 0.5 * (scales.low_m + scales.high_m);
    border.upper = middle_m.head<2>().norm() + 0.3 * extent_m;
    border.lower = -border.upper;
    rendering::SearchedParameter width{"width_m"};
    width.lower = 5e-3 * extent_m, width.upper = 0.2 * extent_m, width.logarithmic = true;
    rendering::SearchPlan plan{{ratio, direction, border, width}, {}};
    constexpr int directions = 4;
    for (int k = 0; k < directions; ++k) {
      const double towards = pi * k / directions;
      const double here_m = std::cos(towards) * middle_m.x() + std::sin(towards) * middle_m.y();
      for (const double share : {-0.15, 0.0, 0.15})
        plan.starts.push_back({{"ratio", 1.2},
                               {"direction_rad", towards},
                               {"border_m", here_m + share * extent_m},
                               {"width_m", 0.08 * extent_m}});
    }
    return plan;
  };
  return traits;
}

EffectTraits stress_relaxation_traits() {
  EffectTraits traits;
  traits.contains = {"normal-damping"};  // a time constant far below the tracker's
  traits.plan = [](const RecordingScales& scales) {
    rendering::SearchedParameter time{"time_constant_s"};
    time.lower = 0.02;
    time.upper = 2.0 * std::max(scales.duration_s, 0.1);
    time.logarithmic = true;
    rendering::SearchPlan plan{{{"ratio"}, time}, {}};
    for (const double tau : {0.08, 0.4, 2.0}) plan.starts.push_back({{"ratio", 0.3}, {"time_constant_s", tau}});
    return plan;
  };
  return traits;
}

}  // namespace touchstone::renderers
