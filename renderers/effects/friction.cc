#include "renderers/effects/friction.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "harness/base/error.h"

namespace touchstone::renderers {
using rendering::ContactState;
using rendering::Effect;
using rendering::EffectTraits;
using rendering::RecordingScales;
using rendering::SearchedParameter;
using rendering::SearchPlan;

namespace {

// The bristle: where it is deflected to, and whether the tip slides.
class Bristle {
 public:
  explicit Bristle(double length_m) : length_m_(length_m) {}

  void reset() noexcept {
    z_W_m_.setZero();
    sliding_ = false;
  }

  // `sliding_share`: force while sliding over force at break-away, so that sticking again starts from the same force.
  void move(const ContactState& contact, double sliding_share) noexcept {
    z_W_m_ -= contact.n_W.dot(z_W_m_) * contact.n_W;
    const Vec3 step = contact.tip_step_W_m - contact.n_W.dot(contact.tip_step_W_m) * contact.n_W;
    if (sliding_ && step.dot(z_W_m_) < 0.0) {
      sliding_ = false;
      z_W_m_ *= sliding_share;
    }
    z_W_m_ += step;
    const double deflection_m = z_W_m_.norm();
    if (deflection_m >= length_m_) {
      z_W_m_ *= length_m_ / deflection_m;
      sliding_ = true;
    }
  }

  [[nodiscard]] bool sliding() const noexcept { return sliding_; }
  // Of length 1 while sliding, shorter while stuck.
  [[nodiscard]] Vec3 deflection() const noexcept { return z_W_m_ / length_m_; }

 private:
  double length_m_;
  Vec3 z_W_m_ = Vec3::Zero();
  bool sliding_ = false;
};

double speed(const ContactState& contact) noexcept {
  if (contact.dt_s <= 0.0) return 0.0;
  const Vec3& step = contact.tip_step_W_m;
  return (step - contact.n_W.dot(step) * contact.n_W).norm() / contact.dt_s;
}

class IsotropicFriction final : public Effect {
 public:
  // stribeck_velocity 0: plain Coulomb.
  IsotropicFriction(double mu_static, double mu_dynamic, double stribeck_velocity, double presliding)
      : mu_static_(mu_static), mu_dynamic_(mu_dynamic), stribeck_velocity_(stribeck_velocity), bristle_(presliding) {}

  void reset() noexcept override { bristle_.reset(); }

  void apply(ContactState& contact) noexcept override {
    if (!contact.contact) {
      bristle_.reset();
      return;
    }
    const double mu_sliding = sliding_coefficient(speed(contact));
    bristle_.move(contact, mu_static_ > 0.0 ? mu_sliding / mu_static_ : 0.0);
    const double mu = bristle_.sliding() ? mu_sliding : mu_static_;
    contact.tangential_W_N -= mu * contact.normal_force_N * bristle_.deflection();
  }

 private:
  [[nodiscard]] double sliding_coefficient(double v) const noexcept {
    if (stribeck_velocity_ <= 0.0) return mu_dynamic_;
    const double ratio = v / stribeck_velocity_;
    return mu_dynamic_ + (mu_static_ - mu_dynamic_) * std::exp(-ratio * ratio);
  }

  double mu_static_;
  double mu_dynamic_;
  double stribeck_velocity_;
  Bristle bristle_;
};

class AnisotropicFriction final : public Effect {
 public:
  AnisotropicFriction(double mu_x, double mu_y, double presliding)
      : mu_(mu_x, mu_y, std::sqrt(mu_x * mu_y)), bristle_(presliding) {}

  void reset() noexcept override { bristle_.reset(); }

  void apply(ContactState& contact) noexcept override {
    if (!contact.contact) {
      bristle_.reset();
      return;
    }
    bristle_.move(contact, 1.0);
    Vec3 force = -contact.normal_force_N * mu_.cwiseProduct(bristle_.deflection());
    force -= contact.n_W.dot(force) * contact.n_W;
    contact.tangential_W_N += force;
  }

 private:
  Vec3 mu_;
  Bristle bristle_;
};

class AgeingFriction final : public Effect {
 public:
  AgeingFriction(double mu_fresh, double growth, double critical_slip, double reference_time, double presliding)
      : mu_fresh_(mu_fresh),
        growth_(growth),
        critical_slip_m_(critical_slip),
        reference_time_s_(reference_time),
        presliding_m_(presliding) {}

  void reset() noexcept override {
    z_W_m_.setZero();
    age_s_ = 0.0;
  }

  void apply(ContactState& contact) noexcept override {
    if (!contact.contact) {
      reset();
      return;
    }
    const Vec3 step = contact.tip_step_W_m - contact.n_W.dot(contact.tip_step_W_m) * contact.n_W;
    const double slips = step.norm() / critical_slip_m_;
    const double renewed = -std::expm1(-slips);
    age_s_ += (slips > 0.0 ? contact.dt_s * renewed / slips : contact.dt_s) - age_s_ * renewed;
    const double mu = mu_fresh_ + growth_ * std::log1p(age_s_ / reference_time_s_);
    z_W_m_ += step;
    z_W_m_ -= contact.n_W.dot(z_W_m_) * contact.n_W;
    const double farthest_m = mu_fresh_ > 0.0 ? presliding_m_ * mu / mu_fresh_ : presliding_m_;
    const double deflection_m = z_W_m_.norm();
    if (deflection_m > farthest_m) z_W_m_ *= farthest_m / deflection_m;
    contact.tangential_W_N -= mu * contact.normal_force_N / farthest_m * z_W_m_;
  }

 private:
  double mu_fresh_;
  double growth_;
  double critical_slip_m_;
  double reference_time_s_;
  double presliding_m_;
  Vec3 z_W_m_ = Vec3::Zero();
  double age_s_ = 0.0;
};

class SublinearFriction final : public Effect {
 public:
  SublinearFriction(double mu, double exponent, double reference_force_N, double presliding)
      : force_N_(mu * reference_force_N), exponent_(exponent), reference_N_(reference_force_N), bristle_(presliding) {}

  void reset() noexcept override { bristle_.reset(); }

  void apply(ContactState& contact) noexcept override {
    if (!contact.contact) {
      bristle_.reset();
      return;
    }
    bristle_.move(contact, 1.0);
    if (!(contact.normal_force_N > 0.0)) return;
    contact.tangential_W_N -=
        force_N_ * std::pow(contact.normal_force_N / reference_N_, exponent_) * bristle_.deflection();
  }

 private:
  double force_N_;
  double exponent_;
  double reference_N_;
  Bristle bristle_;
};

}  // namespace

void check_coefficients(double mu_static, double mu_dynamic, const std::string& place) {
  if (mu_static < mu_dynamic) {
    throw BadData(
        fmt::format("{}: mu_static {} is below mu_dynamic {}: sliding cannot resist more than break-away; "
                    "set mu_static to at least mu_dynamic, or leave it out",
                    place, mu_static, mu_dynamic));
  }
}

std::unique_ptr<Effect> make_coulomb_friction(std::span<const double> values) {
  return std::make_unique<IsotropicFriction>(values[0], values[1], 0.0, values[2]);
}

std::unique_ptr<Effect> make_stribeck_friction(std::span<const double> values) {
  return std::make_unique<IsotropicFriction>(values[0], values[1], values[2], values[3]);
}

std::unique_ptr<Effect> make_anisotropic_friction(std::span<const double> values) {
  return std::make_unique<AnisotropicFriction>(values[0], values[1], values[2]);
}

std::unique_ptr<Effect> make_sublinear_friction(std::span<const double> values) {
  return std::make_unique<SublinearFriction>(values[0], values[1], values[2], values[3]);
}

std::unique_ptr<Effect> make_ageing_friction(std::span<const double> values) {
  return std::make_unique<AgeingFriction>(values[0], values[1], values[2], values[3], values[4]);
}

namespace {

// Pre-sliding is fitted along: the path over which friction turns must exceed what the tracker's noise makes of a tip
// that stands still, and below that the recording cannot show it.
double hidden_presliding_m(const RecordingScales& scales) {
  return 12.0 * scales.position_noise_m + 0.02 * scales.depth_m;
}

// A soft object gives way sideways before the tip slides: by 1 to 1.5 times the coefficient times the depth (Mindlin
// 1949: the tangential stiffness of a contact is 2/3 to 1 of the normal one). The coefficient is hardly above one.
double longest_sideways_m(const RecordingScales& scales) { return hidden_presliding_m(scales) + 1.5 * scales.depth_m; }

SearchedParameter presliding(const RecordingScales& scales) {
  SearchedParameter path{"presliding_m"};
  path.lower = 0.02 * hidden_presliding_m(scales);
  path.upper = longest_sideways_m(scales);
  path.logarithmic = true;
  return path;
}

std::array<double, 3> presliding_starts_m(const RecordingScales& scales) {
  return {0.1 * hidden_presliding_m(scales), 0.4 * hidden_presliding_m(scales), 0.1 * longest_sideways_m(scales)};
}

// mu_static = mu_dynamic + excess, excess >= 0; plain Coulomb friction has one coefficient.
SearchedParameter sliding_coefficient() {
  SearchedParameter mu{"mu_dynamic"};
  mu.carries = "mu_static";
  return mu;
}

SearchPlan plan_coulomb(const RecordingScales& scales) {
  SearchPlan plan{{sliding_coefficient(), presliding(scales)}, {}};
  for (const double s : presliding_starts_m(scales))
    plan.starts.push_back({{"mu_static", 0.2}, {"mu_dynamic", 0.2}, {"presliding_m", s}});
  return plan;
}

SearchPlan plan_stribeck(const RecordingScales& scales) {
  SearchedParameter excess{"mu_static"};
  excess.above = "mu_dynamic";
  SearchedParameter velocity{"stribeck_velocity_m_per_s"};
  const double v = std::max(scales.speed_m_per_s, 1e-4);
  velocity.lower = 0.02 * v;
  velocity.upper = 20.0 * v;
  velocity.logarithmic = true;
  SearchPlan plan{{sliding_coefficient(), excess, velocity, presliding(scales)}, {}};
  for (const double share : {0.3, 1.0}) {
    for (const double s : presliding_starts_m(scales)) {
      plan.starts.push_back(
          {{"mu_static", 0.4}, {"mu_dynamic", 0.2}, {"stribeck_velocity_m_per_s", share * v}, {"presliding_m", s}});
    }
  }
  return plan;
}

SearchPlan plan_anisotropic(const RecordingScales& scales) {
  SearchPlan plan{{{"mu_x"}, {"mu_y"}, presliding(scales)}, {}};
  for (const double s : presliding_starts_m(scales))
    plan.starts.push_back({{"mu_x", 0.2}, {"mu_y", 0.2}, {"presliding_m", s}});
  return plan;
}

}  // namespace

EffectTraits coulomb_friction_traits() {
  EffectTraits traits;
  traits.plan = &plan_coulomb;
  traits.one_sided = {{{"mu_static", 0.05}, {"mu_dynamic", 0.05}},
                      0.05,
                      "the force along the surface pulls with the motion instead of against it, as friction of "
                      "coefficient {:.2f} would: is the sign of the force, or an axis, turned round?"};
  return traits;
}

EffectTraits stribeck_friction_traits() {
  EffectTraits traits;
  traits.contains = {"coulomb-friction"};
  traits.velocity_weakening = true;
  traits.plan = &plan_stribeck;
  return traits;
}

EffectTraits anisotropic_friction_traits() {
  EffectTraits traits;
  traits.contains = {"coulomb-friction"};
  traits.along_axes = {"mu_x", "mu_y"};
  traits.plan = &plan_anisotropic;
  return traits;
}

EffectTraits sublinear_friction_traits() {
  EffectTraits traits;
  traits.contains = {"coulomb-friction"};
  traits.plan = [](const RecordingScales& scales) {
    SearchedParameter exponent{"exponent"};
    exponent.lower = 1.0 / 3.0;  // the area of a contact grows at least as its radius does with the force
    exponent.upper = 1.0;
    SearchPlan plan{{{"mu_reference"}, exponent, presliding(scales)}, {}};
    for (const double s : presliding_starts_m(scales)) {
      plan.starts.push_back({{"mu_reference", 0.2},
                             {"exponent", 2.0 / 3.0},
                             {"reference_force_N", 0.5 * scales.force_N},
                             {"presliding_m", s}});
    }
    return plan;
  };
  return traits;
}

// From a slip that a pause of a second outlasts to one of the whole scan. What a fresh contact is, and its coefficient,
// trade against each other: the age that counts as fresh is held.
EffectTraits ageing_friction_traits() {
  EffectTraits traits;
  traits.contains = {"coulomb-friction"};
  traits.plan = [](const RecordingScales& scales) {
    SearchedParameter slip{"critical_slip_m"};
    slip.lower = 2e-3 * scales.extent_m();
    slip.upper = scales.extent_m();
    slip.logarithmic = true;
    SearchPlan plan{{{"mu_fresh"}, {"growth", 0.1}, slip, presliding(scales)}, {}};
    for (const double share : {0.02, 0.1}) {
      for (const double s : presliding_starts_m(scales)) {
        plan.starts.push_back({{"mu_fresh", 0.2},
                               {"growth", 0.03},
                               {"critical_slip_m", share * scales.extent_m()},
                               {"reference_time_s", 1e-3 * scales.duration_s},
                               {"presliding_m", s}});
      }
    }
    return plan;
  };
  return traits;
}

}  // namespace touchstone::renderers
