#include <cmath>
#include <exception>

#include "safety/guard_messages.h"
#include "safety/guard_processes.h"
#include "safety/harden.h"

namespace touchstone::hil {
namespace {

constexpr int driver_priority = 80;
constexpr double between_zeros_s = 0.0005;
constexpr double patience_at_the_end_s = 2.0;

class Driver {
 public:
  Driver(int guard, const GuardOptions& options, GuardPage& page) : guard_(guard), options_(options), page_(page) {}

  // Whatever goes wrong while opening is the hello's message.
  bool open(const OpenDevice& open) {
    GuardHello hello;
    try {
      const double before_s = clock_.now_s();
      device_ = open();
      page_.open_took_s = clock_.now_s() - before_s;
      const DeviceIdentity& identity = device_->identity();
      copy_text(hello.id, identity.id);
      copy_text(hello.serial, identity.serial);
      copy_text(hello.firmware, identity.firmware);
      copy_text(hello.calibration, identity.calibration);
      hello.emulated = identity.emulated ? 1 : 0;
      hello.calibrated = device_->calibrated() ? 1 : 0;
      hello.watchdog_s = device_->watchdog_s();
    } catch (const DeviceError& error) {
      hello.status = static_cast<int>(error.device_status());
      hello.advised = 1;
      copy_message(hello.message, error.what());
    } catch (const std::exception& error) {
      hello.status = static_cast<int>(DeviceStatus::failed);
      copy_message(hello.message, error.what());
    } catch (...) {
      hello.status = static_cast<int>(DeviceStatus::failed);
      copy_message(hello.message, "the driver threw something that is no exception");
    }
    return send_message(guard_, hello) && hello.status == 0;
  }

  int serve() {
    // The guard lets go of a silent program after limits.stale_s; silence of the guard itself is noticed later.
    const double guard_silent_s = options_.limits.stale_s + options_.watchdog_s;
    for (;;) {
      GuardRequest request;
      switch (receive_message(guard_, request, clock_.now_s() + (pushing_ ? guard_silent_s : 1.0))) {
        case Received::nothing:
          if (pushing_) zero();
          continue;
        case Received::gone:
          bring_to_rest_confirmed(patience_at_the_end_s);
          return 1;
        case Received::message:
          break;
      }
      if (request.ask == GuardAsk::end) {
        bring_to_rest_confirmed(patience_at_the_end_s);
        return 0;
      }
      GuardReply reply = answer(request);
      reply.number = request.number;
      if (!send_message(guard_, reply)) bring_to_rest_confirmed(patience_at_the_end_s);
    }
  }

 private:
  GuardReply answer(const GuardRequest& request) {
    GuardReply reply;
    if (request.ask == GuardAsk::zero) {
      reply.confirmed = zero() ? 1 : 0;
      return reply;
    }
    if (request.ask == GuardAsk::motors_off) {
      reply.confirmed = device_->motors_off() ? 1 : 0;
      return reply;
    }
    const Vec3 force(request.f_N[0], request.f_N[1], request.f_N[2]);
    try {
      // The guard's limits once more, the last thing before the device.
      constexpr double rounding = 1e-9;
      if (!force.allFinite() || force.norm() > options_.limits.force_N * (1 + rounding))
        throw DeviceError(DeviceStatus::failed, "a force beyond the limit reached the driver");
      if (!force.isZero(0.0)) {
        page_.device_zero = false;
        pushing_ = true;
      }
      const bool on = !force.isZero(0.0);
      const DeviceState state =
          device_->exchange(force, clock_.now_s() + (on ? options_.driver_timeout_s : options_.idle_timeout_s));
      pushing_ = on;
      if (!on) page_.device_zero = true;
      reply.t_s = state.t_s;
      for (int k = 0; k < 3; ++k) reply.p_m[k] = state.p_W_m[k], reply.v_m_per_s[k] = state.v_W_m_per_s[k];
      reply.buttons = state.buttons;
      reply.temperature_C = state.temperature_C;
      reply.calibrated = device_->calibrated() ? 1 : 0;
      return reply;
    } catch (const DeviceError& error) {
      reply.status = static_cast<int>(error.device_status());
      reply.advised = 1;
      copy_message(reply.message, error.what());
    } catch (const std::exception& error) {
      reply.status = static_cast<int>(DeviceStatus::failed);
      copy_message(reply.message, error.what());
    } catch (...) {
      reply.status = static_cast<int>(DeviceStatus::failed);
      copy_message(reply.message, "the driver threw something that is no exception");
    }
    reply.confirmed = zero() ? 1 : 0;
    return reply;
  }

  bool zero() noexcept {
    if (!device_->zero_force()) return false;
    pushing_ = false;
    page_.device_zero = true;
    return true;
  }
  void bring_to_rest_confirmed(double within_s) noexcept {
    if (bring_to_rest(*device_, clock_.now_s() + within_s)) page_.device_zero = true;
  }

  int guard_;
  const GuardOptions& options_;
  GuardPage& page_;
  MonotonicClock clock_;
  std::unique_ptr<HapticDevice> device_;
  bool pushing_ = false;
};

}  // namespace

bool bring_to_rest(HapticDevice& device, double deadline_s) noexcept {
  MonotonicClock clock;
  bool zero = device.zero_force();
  while (!zero && clock.now_s() < deadline_s) {
    clock.sleep_until(clock.now_s() + between_zeros_s);
    zero = device.zero_force();
  }
  const bool off = device.motors_off();
  return zero || off;
}

int run_driver(int guard, const OpenDevice& open, const GuardOptions& options, GuardPage& page) {
  const auto missing = harden(driver_priority, LockedMemory::present);
  if (!missing.empty())
    page.log(MonotonicClock().now_s(), GuardPhase::opening, Trip::none, ("driver without " + missing).c_str());
  Driver driver(guard, options, page);
  return driver.open(open) ? driver.serve() : 1;
}

}  // namespace touchstone::hil
