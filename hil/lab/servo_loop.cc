#include "lab/servo_loop.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <utility>

#include "drivers/device_table.h"

namespace touchstone::hil {
namespace {

class Loop {
 public:
  Loop(Bench& bench, double rate_Hz) : bench_(bench), period_s_(1.0 / rate_Hz), supervisor_(bench.limits) {}

  // At zero until calibrated and held.
  void take_hold() {
    bench_.tell(bench_.dead_man->instruction() + ", and keep it held; let go to stop");
    const double deadline = bench_.clock.now_s() + bench_.hold_within_s;
    restart();
    const std::string how = calibrating_text(bench_.device.identity().id);
    for (bool told = false;;) {
      tick(Vec3::Zero());
      if (!bench_.device.calibrated() && !std::exchange(told, true)) bench_.tell("the device is not calibrated" + how);
      if (bench_.device.calibrated() && bench_.dead_man->held(bench_.clock.now_s(), state_)) return;
      if (bench_.stop()) throw DeviceError(DeviceStatus::failed, "stopped by the user");
      if (bench_.clock.now_s() > deadline) {
        throw DeviceError(DeviceStatus::timed_out,
                          bench_.device.calibrated()
                              ? fmt::format("nobody took hold within {:.3g} s: {}", bench_.hold_within_s,
                                            bench_.dead_man->instruction())
                              : fmt::format("{}: was not calibrated (homed) within {:.3g} s{}",
                                            bench_.device.identity().id, bench_.hold_within_s, how));
      }
    }
  }

  ServoRun run(double seconds, const WantedForce* wanted) {
    ServoRun result;
    discard_wrenches();
    restart();
    result.start_s = start_s_;
    const auto ticks = static_cast<std::size_t>(std::llround(seconds / period_s_));
    result.ticks.reserve(ticks);
    while (result.ticks.size() < ticks) {
      const double now = wait();
      ForceSupervisor::Input in;
      in.now_s = now;
      in.state = state_;
      if (wanted != nullptr) {
        in.calibrated = bench_.device.calibrated();
        in.dead_man_held = bench_.dead_man->held(now, state_);
        in.wanted_W_N = (*wanted)(state_, now - start_s_);
        // Let go ends the run also where the force happens to be zero: what follows would not be what was wanted.
        if (!in.dead_man_held) supervisor_.trip(Trip::dead_man);
      }
      const Vec3 allowed = supervisor_.allow(in);
      state_ = bench_.device.exchange(allowed, now + bench_.patience_s);
      result.ticks.push_back({now - start_s_, state_.p_W_m, state_.v_W_m_per_s, allowed});
      read_wrenches(result);
      if (supervisor_.tripped() != Trip::none && allowed.isZero()) break;
      if (bench_.stop()) {
        result.stopped = true;
        supervisor_.trip(Trip::asked);
        if (wanted == nullptr) break;
      }
    }
    result.trip = supervisor_.tripped();
    result.saturated = supervisor_.saturated_steps();
    return result;
  }

 private:
  void restart() {
    start_s_ = bench_.clock.now_s();
    count_ = 0;
    supervisor_ = ForceSupervisor(bench_.limits);
    if (!asked_) state_.t_s = start_s_;
  }
  double wait() {
    bench_.clock.sleep_until(start_s_ + period_s_ * static_cast<double>(count_++));
    return bench_.clock.now_s();
  }
  void tick(const Vec3& force) {
    const double now = wait();
    state_ = bench_.device.exchange(force, now + bench_.patience_s);
    asked_ = true;
  }
  void discard_wrenches() {
    ServoRun none;
    if (bench_.sensor != nullptr) read_wrenches(none);
  }
  void read_wrenches(ServoRun& run) {
    if (bench_.sensor == nullptr) return;
    while (const std::size_t n = bench_.sensor->read(samples_, bench_.clock.now_s())) {
      for (std::size_t i = 0; i < n; ++i) {
        run.wrenches.push_back(samples_[i]);
        run.wrenches.back().t_s -= start_s_;
      }
      if (n < samples_.size()) break;
    }
  }

  Bench& bench_;
  double period_s_;
  ForceSupervisor supervisor_;
  DeviceState state_;
  double start_s_ = 0.0;
  std::size_t count_ = 0;
  bool asked_ = false;
  std::array<WrenchSample, 64> samples_;
};

}  // namespace

ServoRun run_servo(Bench& bench, double seconds, const WantedForce& wanted, double rate_Hz) {
  if (bench.dead_man == nullptr)
    throw UsageError(
        "no force is commanded without a dead-man input: set TOUCHSTONE_HIL_DEAD_MAN (see docs/how-to/lab.md)");
  const ForceGuard guard(bench.device);
  Loop loop(bench, rate_Hz);
  loop.take_hold();
  return loop.run(seconds, &wanted);
}

ServoRun run_servo_at_zero(Bench& bench, double seconds, double rate_Hz) {
  const ForceGuard guard(bench.device);
  return Loop(bench, rate_Hz).run(seconds, nullptr);
}

}  // namespace touchstone::hil
