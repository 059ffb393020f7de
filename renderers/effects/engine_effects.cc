#include "renderers/effects/engine_effects.h"

#include <cmath>

namespace touchstone::renderers {
using rendering::ContactState;
using rendering::Effect;

namespace {

// A force of any direction, beside the law of the normal force: its part along the normal may pull.
void add(ContactState& contact, const Vec3& f_W_N) noexcept {
  const double along = contact.n_W.dot(f_W_N);
  contact.adhesion_N -= along;
  contact.tangential_W_N += f_W_N - along * contact.n_W;
}

class Magnet final : public Effect {
 public:
  Magnet(double force, double distance, bool inside) : force_(force), distance_(distance), inside_(inside) {}

  void reset() noexcept override {}

  void apply(ContactState& contact) noexcept override {
    // Far from the surface the normal is unknown, and nothing pulls.
    if (contact.n_W.isZero() || (contact.contact && !inside_)) return;
    const double away = std::abs(contact.depth_m);
    if (!(away < distance_) || !(contact.stiffness_N_per_m > 0.0)) return;
    // Beyond the turn `distance_` is larger than it: it is larger than `away`.
    const double turn = force_ / contact.stiffness_N_per_m;
    const double pull =
        away < turn ? contact.stiffness_N_per_m * away : force_ * (distance_ - away) / (distance_ - turn);
    contact.adhesion_N += contact.contact ? -pull : pull;
  }

 private:
  double force_;
  double distance_;
  bool inside_;
};

class StickSlip final : public Effect {
 public:
  StickSlip(double stiffness, double force) : stiffness_(stiffness), force_(force) {}

  void reset() noexcept override { sticks_ = false; }

  void apply(ContactState& contact) noexcept override {
    if (!contact.contact) {
      sticks_ = false;
      return;
    }
    if (!sticks_) place_ = contact.tip_W_m;
    sticks_ = true;
    const Vec3 back = stiffness_ * (place_ - contact.tip_W_m);
    if (back.norm() > force_) {
      place_ = contact.tip_W_m;
    } else {
      add(contact, back);
    }
  }

 private:
  double stiffness_;
  double force_;
  Vec3 place_ = Vec3::Zero();
  bool sticks_ = false;
};

class Viscosity final : public Effect {
 public:
  explicit Viscosity(double coefficient) : coefficient_(coefficient) {}

  void reset() noexcept override {}

  void apply(ContactState& contact) noexcept override {
    if (contact.contact && contact.dt_s > 0.0) add(contact, -coefficient_ / contact.dt_s * contact.tip_step_W_m);
  }

 private:
  double coefficient_;
};

}  // namespace

std::unique_ptr<Effect> make_magnet(std::span<const double> values) {
  return std::make_unique<Magnet>(values[0], values[1], values[2] >= 0.5);
}

std::unique_ptr<Effect> make_stick_slip(std::span<const double> values) {
  return std::make_unique<StickSlip>(values[0], values[1]);
}

std::unique_ptr<Effect> make_viscosity(std::span<const double> values) {
  return std::make_unique<Viscosity>(values[0]);
}

}  // namespace touchstone::renderers
