#include "lab/live_loop.h"

#include <cmath>
#include <utility>

#include "drivers/device_table.h"

namespace touchstone::hil {
namespace {

class LiveLoop {
 public:
  LiveLoop(GuardedDevice& device, const LiveOptions& options, DeadMan* dead_man)
      : device_(device), options_(options), dead_man_(dead_man), period_s_(1.0 / options.rate_Hz) {}

  // At zero until calibrated and held. Returns why not, or nothing.
  std::string get_ready(const std::function<bool()>& stop) {
    const double until = clock_.now_s() + options_.ready_within_s;
    const std::string how = calibrating_text(device_.identity().id);
    bool told = false;
    for (double tick = clock_.now_s();; tick += period_s_) {
      clock_.sleep_until(tick);
      state_ = device_.exchange(Vec3::Zero(), clock_.now_s() + options_.exchange_s);
      if (device_.calibrated() && held()) return "";
      if (!device_.calibrated() && !std::exchange(told, true)) options_.tell("the device is not calibrated" + how);
      if (stop()) return "stopped by the user";
      if (clock_.now_s() > until)
        return device_.calibrated() ? "nobody took hold in time"
                                    : "the device was not calibrated (homed) in time" + how;
    }
  }

  void run(LiveRun& result, const std::function<bool()>& stop,
           const std::function<Vec3(const DeviceState&, double)>& step) {
    const auto wanted_ticks = static_cast<std::size_t>(std::llround(options_.seconds * options_.rate_Hz));
    result.ticks.reserve(wanted_ticks);
    const double start = clock_.now_s();
    double last_t = -1.0;
    for (std::size_t i = 0; i < wanted_ticks; ++i) {
      const double due = start + static_cast<double>(i) * period_s_;
      clock_.sleep_until(due);
      LiveTick tick;
      tick.late_s = clock_.now_s() - due;
      if (tick.late_s >= period_s_) ++result.missed;
      tick.state = state_;
      tick.t_s = state_.t_s - start;
      // A state that is no newer than the last is not rendered twice: a replay needs time that increases.
      if (tick.t_s > last_t || result.ticks.empty()) {
        last_t = tick.t_s;
        const double before = clock_.now_s();
        tick.wanted_W_N = step(state_, tick.t_s);
        tick.step_us = 1e6 * (clock_.now_s() - before);
        state_ = device_.exchange(tick.wanted_W_N, clock_.now_s() + options_.exchange_s);
        tick.allowed_W_N = device_.last_allowed_N();
        if (tick.allowed_W_N != tick.wanted_W_N) ++result.cut;
        result.ticks.push_back(tick);
      } else {
        ++result.stale;
        state_ = device_.exchange(result.ticks.back().wanted_W_N, clock_.now_s() + options_.exchange_s);
      }
      if (!held()) {
        result.ended = "dead-man released";
        return;
      }
      if (stop()) {
        result.ended = "stopped by the user";
        return;
      }
    }
    result.ended = "time is up";
    result.whole = true;
  }

 private:
  bool held() { return dead_man_ == nullptr || dead_man_->held(clock_.now_s(), state_); }

  GuardedDevice& device_;
  const LiveOptions& options_;
  DeadMan* dead_man_;
  double period_s_;
  DeviceState state_;
  MonotonicClock clock_;
};

}  // namespace

LiveRun run_live(GuardedDevice& device, const LiveOptions& options, DeadMan* dead_man,
                 const std::function<bool()>& stop,
                 const std::function<Vec3(const DeviceState& state, double t_s)>& step) {
  const ForceGuard guard(device);
  LiveRun result;
  try {
    LiveLoop loop(device, options, dead_man);
    result.ended = loop.get_ready(stop);
    if (result.ended.empty()) loop.run(result, stop, step);
  } catch (const std::exception& error) {
    result.ended = error.what();
    result.whole = false;
  }
  if (result.ticks.size() > 1) {
    result.rate_Hz =
        static_cast<double>(result.ticks.size() - 1) / (result.ticks.back().state.t_s - result.ticks.front().state.t_s);
  }
  return result;
}

}  // namespace touchstone::hil
