#include "servo/axis_motion.h"

#include <algorithm>
#include <cmath>

namespace touchstone::servo {
namespace {

constexpr int most_events = 64;  // within one call; beyond them the body rests

// z' = A z.
AxisMatrix dynamics(const AxisParameters& own, bool resting) {
  AxisMatrix a = AxisMatrix::Zero();
  a(deviation_index, intended_index) = -1.0;
  if (!resting) {
    a(deviation_index, velocity_index) = 1.0;
    a(velocity_index, deviation_index) = -own.hand_stiffness_N_per_m / own.mass_kg;
    a(velocity_index, velocity_index) = -(own.damping_N_s_per_m + own.hand_damping_N_s_per_m) / own.mass_kg;
    a(velocity_index, actuator_index) = 1.0 / own.mass_kg;
    a(velocity_index, intended_index) = own.hand_damping_N_s_per_m / own.mass_kg;
    a(velocity_index, friction_index) = 1.0 / own.mass_kg;
  }
  if (own.actuator_time_constant_s > 0.0) {
    a(actuator_index, actuator_index) = -1.0 / own.actuator_time_constant_s;
    a(actuator_index, command_index) = 1.0 / own.actuator_time_constant_s;
  }
  return a;
}

// The powers as z^T P z: f v, (-k_h y - b_h (v - q)) v, b v^2 and F_c |v|.
std::array<AxisMatrix, 4> powers(const AxisParameters& own, bool resting) {
  std::array<AxisMatrix, 4> out{AxisMatrix::Zero(), AxisMatrix::Zero(), AxisMatrix::Zero(), AxisMatrix::Zero()};
  if (resting) return out;
  const auto with_velocity = [&out](std::size_t port, int other, double factor) {
    out[port](other, velocity_index) += 0.5 * factor;
    out[port](velocity_index, other) += 0.5 * factor;
  };
  with_velocity(0, actuator_index, 1.0);
  with_velocity(1, deviation_index, -own.hand_stiffness_N_per_m);
  with_velocity(1, velocity_index, -own.hand_damping_N_s_per_m);
  with_velocity(1, intended_index, own.hand_damping_N_s_per_m);
  with_velocity(2, velocity_index, own.damping_N_s_per_m);
  with_velocity(3, friction_index, -1.0);
  return out;
}

// One quantum is so short that two terms of the series have all digits; the others by doubling.
std::vector<Transition> make_levels(const AxisParameters& own, bool resting, double quantum_s) {
  const AxisMatrix a = dynamics(own, resting);
  const auto power = powers(own, resting);
  std::vector<Transition> out(period_bits + 1);
  out[0].change = a * quantum_s + a * a * (0.5 * quantum_s * quantum_s);
  for (std::size_t p = 0; p < power.size(); ++p) {
    out[0].work[p] = power[p] * quantum_s + (a.transpose() * power[p] + power[p] * a) * (0.5 * quantum_s * quantum_s);
  }
  for (std::size_t level = 1; level < out.size(); ++level) out[level] = out[level - 1].then(out[level - 1]);
  return out;
}

}  // namespace

Transition Transition::then(const Transition& next) const {
  Transition out;
  out.change = change + next.change + next.change * change;
  for (std::size_t p = 0; p < work.size(); ++p) {
    const AxisMatrix half = next.work[p] * change;
    out.work[p] = work[p] + next.work[p] + half + half.transpose() + change.transpose() * half;
  }
  return out;
}

AxisTransitions::AxisTransitions(const AxisParameters& parameters, double period_s,
                                 const std::vector<std::int64_t>& frequent)
    : parameters_(parameters) {
  const double quantum_s = period_s / static_cast<double>(period_quanta);
  for (const bool resting : {false, true}) levels_[resting ? 1 : 0] = make_levels(parameters, resting, quantum_s);
  for (const std::int64_t quanta : frequent) {
    std::array<Transition, 2> both;
    for (const bool resting : {false, true}) {
      for (int n = period_bits; n >= 0; --n) {
        if (((quanta >> n) & 1) != 0) both[resting ? 1 : 0] = both[resting ? 1 : 0].then(level(n, resting));
      }
    }
    frequent_.emplace_back(quanta, both);
  }
}

const Transition* AxisTransitions::frequent(std::int64_t quanta, bool resting) const {
  if (quanta == period_quanta) return &level(period_bits, resting);
  for (const auto& [known, both] : frequent_) {
    if (known == quanta) return &both[resting ? 1 : 0];
  }
  return nullptr;
}

void AxisMotion::command(double force_N) {
  z_[command_index] = force_N;
  if (transitions_->parameters().actuator_time_constant_s <= 0.0) z_[actuator_index] = force_N;
}

void AxisMotion::start_at(double deviation_m, double velocity_m_per_s) {
  z_[deviation_index] = deviation_m;
  z_[velocity_index] = velocity_m_per_s;
  resting_ = false;
  const double friction_N = transitions_->parameters().friction_N;
  direction_ = friction_N > 0.0 && velocity_m_per_s != 0.0 ? std::copysign(1.0, velocity_m_per_s) : 0.0;
  z_[friction_index] = -direction_ * friction_N;
}

double AxisMotion::others_N(const AxisVector& z) const noexcept {
  const AxisParameters& own = transitions_->parameters();
  return z[actuator_index] - own.damping_N_s_per_m * z[velocity_index] -
         own.hand_stiffness_N_per_m * z[deviation_index] -
         own.hand_damping_N_s_per_m * (z[velocity_index] - z[intended_index]);
}

double AxisMotion::acceleration_m_per_s2() const noexcept {
  return resting_ ? 0.0 : (others_N(z_) + z_[friction_index]) / transitions_->parameters().mass_kg;
}

double AxisMotion::felt_N(double hand_mass_kg) const noexcept {
  const AxisParameters& own = transitions_->parameters();
  return hand_mass_kg * acceleration_m_per_s2() + own.hand_stiffness_N_per_m * z_[deviation_index] +
         own.hand_damping_N_s_per_m * (z_[velocity_index] - z_[intended_index]);
}

void AxisMotion::apply(const Transition& transition) {
  const auto done_J = [&](std::size_t port) { return z_.dot(transition.work[port] * z_); };
  if (!resting_) {
    work_.by_actuator_J += done_J(0);
    work_.by_hand_J += done_J(1);
    work_.viscous_J += done_J(2);
    if (direction_ != 0.0) work_.dry_J += done_J(3);
  }
  z_ += transition.change * z_;
}

void AxisMotion::go(std::int64_t quanta) {
  if (quanta <= 0) return;
  if (const Transition* const known = transitions_->frequent(quanta, resting_)) return apply(*known);
  for (int n = period_bits; n >= 0; --n) {
    if (((quanta >> n) & 1) != 0) apply(transitions_->level(n, resting_));
  }
}

AxisVector AxisMotion::after(std::int64_t quanta) const {
  if (const Transition* const known = transitions_->frequent(quanta, resting_)) return z_ + known->change * z_;
  AxisVector z = z_;
  for (int n = period_bits; n >= 0; --n) {
    if (((quanta >> n) & 1) != 0) z += transitions_->level(n, resting_).change * z;
  }
  return z;
}

template <class Stays>
std::int64_t AxisMotion::lasts(std::int64_t most, const Stays& stays) const {
  AxisVector z = z_;
  std::int64_t done = 0;
  for (int n = period_bits; n >= 0; --n) {
    const std::int64_t step = std::int64_t{1} << n;
    if (done + step > most) continue;
    const AxisVector next = z + transitions_->level(n, resting_).change * z;
    if (!stays(next)) continue;
    z = next;
    done += step;
  }
  return done;
}

std::int64_t AxisMotion::until_reversal(std::int64_t most) const {
  const auto forward = [this](const AxisVector& z) { return z[velocity_index] * direction_ > 0.0; };
  const auto slows = [this](const AxisVector& z) { return (others_N(z) + z[friction_index]) * direction_ < 0.0; };
  const AxisVector end = after(most);
  if (!forward(end)) return lasts(most, forward);
  // It may have turned and come back.
  if (!slows(z_) || slows(end)) return most;
  const std::int64_t slowest = lasts(most, slows);
  return forward(after(slowest)) ? most : lasts(slowest, forward);
}

std::int64_t AxisMotion::until_loose(std::int64_t most) const {
  const double friction_N = transitions_->parameters().friction_N;
  const auto held = [this, friction_N](const AxisVector& z) { return std::abs(others_N(z)) <= friction_N; };
  return held(after(most)) ? most : lasts(most, held);
}

void AxisMotion::stand() {
  z_[velocity_index] = 0.0;
  const double friction_N = transitions_->parameters().friction_N;
  const double pull_N = others_N(z_);
  resting_ = std::abs(pull_N) <= friction_N;
  direction_ = resting_ ? 0.0 : std::copysign(1.0, pull_N);
  z_[friction_index] = -direction_ * friction_N;
}

void AxisMotion::advance(std::int64_t quanta) {
  if (transitions_->parameters().friction_N <= 0.0) return go(quanta);
  if (direction_ == 0.0) stand();  // forces may have changed
  for (int events = 0; quanta > 0; ++events) {
    const bool stays = events >= most_events;
    if (stays) {
      z_[velocity_index] = z_[friction_index] = direction_ = 0.0;
      resting_ = true;
    }
    const std::int64_t undisturbed = stays ? quanta : resting_ ? until_loose(quanta) : until_reversal(quanta);
    go(undisturbed);
    quanta -= undisturbed;
    if (quanta == 0) return;
    go(1);
    --quanta;
    stand();
  }
}

}  // namespace touchstone::servo
