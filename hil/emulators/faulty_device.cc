#include "emulators/faulty_device.h"

#include <sys/mman.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <limits>
#include <new>
#include <stdexcept>

#include "emulators/haptic_emulator.h"

namespace touchstone::hil {
namespace {

class FaultyDevice final : public HapticDevice {
 public:
  FaultyDevice(const std::filesystem::path& file, FaultOrders& orders) : orders_(orders), instance_(++orders.opened) {
    MonotonicClock clock;
    if (instance_ > 1) clock.sleep_until(clock.now_s() + orders.open_takes_s);
    // A lock by number, as /var/lock/LCK..* (FHS 5.9): a zombie still has its number.
    if (const int owner = orders.owner; orders.one_owner && owner != 0 && ::kill(owner, 0) == 0)
      throw DeviceError(DeviceStatus::busy, "another process has it");
    orders.owner = ::getpid();
    go_wrong(due(DeviceCall::open));
    device_ = open_emulated_haptic(file);
  }
  ~FaultyDevice() override {
    if (due(DeviceCall::close) == DriverFault::blocks) block();
  }
  FaultyDevice(const FaultyDevice&) = delete;
  FaultyDevice& operator=(const FaultyDevice&) = delete;

  [[nodiscard]] const DeviceIdentity& identity() const override { return device_->identity(); }
  [[nodiscard]] double watchdog_s() const override { return device_->watchdog_s(); }
  [[nodiscard]] bool calibrated() const override {
    go_wrong(due(DeviceCall::calibrated));
    return device_->calibrated();
  }
  DeviceState exchange(const Vec3& f_W_N, double deadline_s) override {
    DeviceState state = device_->exchange(f_W_N, deadline_s);
    const DriverFault fault = due(DeviceCall::exchange);
    go_wrong(fault);
    if (fault == DriverFault::not_finite) state.p_W_m.y() = std::numeric_limits<double>::quiet_NaN();
    if (fault == DriverFault::frozen) state.t_s -= 1.0;
    if (fault == DriverFault::out_of_reach) state.p_W_m.x() += 0.5;
    return state;
  }
  bool zero_force() noexcept override { return rest(DeviceCall::zero_force); }
  bool motors_off() noexcept override { return rest(DeviceCall::motors_off); }

 private:
  bool rest(DeviceCall call) noexcept {
    const DriverFault fault = due(call);
    if (fault == DriverFault::refuses || fault == DriverFault::blocks || fault == DriverFault::aborts) {
      go_wrong(fault);  // before anything reached the device
      return false;
    }
    const bool confirmed = device_->zero_force();
    go_wrong(fault);  // an exception out of noexcept ends the process
    return confirmed;
  }
  [[nodiscard]] DriverFault due(DeviceCall call) const noexcept {
    if (orders_.call != call || (orders_.instance != 0 && orders_.instance != instance_)) return DriverFault::none;
    if (orders_.times == 0) return DriverFault::none;
    if (orders_.times > 0) --orders_.times;
    double never = 0.0;
    orders_.struck_s.compare_exchange_strong(never, MonotonicClock().now_s());
    return orders_.fault;
  }
  static void block() {
    for (MonotonicClock clock;;) clock.sleep_until(clock.now_s() + 1000.0);
  }
  static void go_wrong(DriverFault fault) {
    if (fault == DriverFault::device_error) throw DeviceError(DeviceStatus::failed, "ordered fault");
    if (fault == DriverFault::out_of_memory) throw std::bad_alloc();
    if (fault == DriverFault::not_exception) throw 42;
    if (fault == DriverFault::blocks) block();
    if (fault == DriverFault::late) {
      MonotonicClock clock;
      clock.sleep_until(clock.now_s() + 0.05);
    }
    if (fault == DriverFault::aborts) std::abort();
  }

  FaultOrders& orders_;
  int instance_;
  std::unique_ptr<HapticDevice> device_;
};

}  // namespace

std::shared_ptr<FaultOrders> make_fault_orders() {
  void* const memory = ::mmap(nullptr, sizeof(FaultOrders), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  if (memory == MAP_FAILED) throw std::runtime_error("mmap");
  return {new (memory) FaultOrders, [](FaultOrders* orders) { ::munmap(orders, sizeof(FaultOrders)); }};
}

std::unique_ptr<HapticDevice> open_faulty_device(const std::filesystem::path& file, FaultOrders& orders) {
  return std::make_unique<FaultyDevice>(file, orders);
}

}  // namespace touchstone::hil
