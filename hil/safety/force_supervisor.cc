#include "safety/force_supervisor.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace touchstone::hil {

std::string_view to_string(Trip trip) {
  constexpr std::array names{"none",
                             "value not finite",
                             "force",
                             "speed",
                             "workspace",
                             "stale data",
                             "dead-man released",
                             "device error",
                             "time ran back",
                             "asked for",
                             "power",
                             "energy",
                             "temperature",
                             "the program is gone",
                             "the driver does not answer",
                             "the driver is gone",
                             "the watchdog is gone",
                             "the guard is gone",
                             "zero not confirmed"};
  return names[static_cast<std::size_t>(trip)];
}

Trip ForceSupervisor::judge_state(const DeviceState& state, double now_s) const noexcept {
  if (!std::isfinite(state.t_s) || !state.p_W_m.allFinite() || !state.v_W_m_per_s.allFinite()) return Trip::not_finite;
  if (now_s - state.t_s > limits_.stale_s) return Trip::stale;
  if (!(state.v_W_m_per_s.norm() <= limits_.speed_m_per_s)) return Trip::speed;
  if (!limits_.workspace_W_m.contains(state.p_W_m)) return Trip::workspace;
  if (state.temperature_C > limits_.temperature_C) return Trip::temperature;
  return Trip::none;
}

Trip ForceSupervisor::judge(const Input& in) const noexcept {
  if (!std::isfinite(in.now_s) || !std::isfinite(in.state.t_s) || !in.state.p_W_m.allFinite() ||
      !in.state.v_W_m_per_s.allFinite() || !in.wanted_W_N.allFinite()) {
    return Trip::not_finite;
  }
  if (started_ && in.now_s < last_s_) return Trip::time_ran_back;
  if (in.device_error) return Trip::device_error;
  if (in.now_s - in.state.t_s > limits_.stale_s || (started_ && in.now_s - last_s_ > limits_.stale_s))
    return Trip::stale;
  if (!in.dead_man_held && last_N_.squaredNorm() > 0.0) return Trip::dead_man;
  if (const Trip trip = judge_state(in.state, in.now_s); trip != Trip::none) return trip;
  // last_N_ acted on the hand from the last step on.
  const double power_W = last_N_.dot(in.state.v_W_m_per_s);
  if (power_W > limits_.power_W) return Trip::power;
  if (carried_J_ + given_J_ + power_W * (started_ ? in.now_s - last_s_ : 0.0) > limits_.energy_J) return Trip::energy;
  if (in.wanted_W_N.norm() > 2.0 * limits_.force_N) return Trip::force;
  return Trip::none;
}

void ForceSupervisor::trip(Trip reason) noexcept {
  if (trip_ != Trip::none || reason == Trip::none) return;
  trip_ = reason;
  trip_pending_ = true;
  at_trip_N_ = last_N_;
}

bool ForceSupervisor::reset(Trip acknowledged) noexcept {
  if (trip_ == Trip::none || acknowledged != trip_) return false;
  trip_ = Trip::none;
  trip_pending_ = false;
  started_ = false;
  last_N_.setZero();
  given_J_ = carried_J_ = 0.0;
  return true;
}

void ForceSupervisor::end_contact() noexcept {
  carried_J_ = std::max(0.0, carried_J_ + given_J_);
  given_J_ = 0.0;
}

void ForceSupervisor::rest(double now_s) noexcept {
  end_contact();
  last_N_.setZero();
  started_ = false;
  if (std::isfinite(now_s)) last_s_ = now_s;
}

Vec3 ForceSupervisor::allow(const Input& in) noexcept {
  const bool time_usable = std::isfinite(in.now_s) && (!started_ || in.now_s >= last_s_);
  if (time_usable) {
    carried_J_ *= std::exp(std::min(0.0, (carried_s_ - in.now_s) / energy_window_s));
    carried_s_ = in.now_s;
  }
  if (in.calibrated || last_N_.squaredNorm() > 0.0) trip(judge(in));
  const double dt = started_ && time_usable ? in.now_s - last_s_ : 0.0;
  if (trip_ != Trip::none) {
    // Ramping needs a clock and a state that can be trusted; without them zero at once.
    const bool trusted = time_usable && trip_ != Trip::not_finite && trip_ != Trip::time_ran_back &&
                         trip_ != Trip::stale && trip_ != Trip::device_error;
    if (trip_pending_) trip_s_ = time_usable ? in.now_s : last_s_, trip_pending_ = false;
    const double left = trusted && limits_.ramp_down_s > 0.0 ? 1.0 - (in.now_s - trip_s_) / limits_.ramp_down_s : 0.0;
    last_N_ = left > 0.0 ? Vec3(std::min(1.0, left) * at_trip_N_) : Vec3::Zero();
    if (!trusted) at_trip_N_.setZero();  // what was dropped to zero does not come back
    if (time_usable) last_s_ = in.now_s, started_ = true;
    return last_N_;
  }
  Vec3 force = Vec3::Zero();
  if (in.calibrated && in.dead_man_held) {
    force = in.wanted_W_N;
    const double length = force.norm();
    if (length > limits_.force_N) {
      force *= limits_.force_N / length;
      ++saturated_;
    }
    // From the last force by no more than the slew allows; the first step has no time behind it and stays zero.
    const Vec3 change = force - last_N_;
    const double most = limits_.slew_N_per_s * dt;
    if (change.norm() > most) force = last_N_ + change * (most / change.norm());
  }
  if (last_N_.isZero()) {
    end_contact();
  } else {
    given_J_ += dt * last_N_.dot(in.state.v_W_m_per_s);
  }
  last_N_ = force;
  if (time_usable) last_s_ = in.now_s, started_ = true;
  return force;
}

}  // namespace touchstone::hil
