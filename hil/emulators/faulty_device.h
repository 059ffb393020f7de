// An emulated haptic device (haptic_emulator.h) whose driver goes wrong on order: in any of its calls, in any of the
// ways in which drivers go wrong. Orders and what became of them lie in memory that processes share. For tests of the
// guard.
#pragma once

#include <atomic>
#include <filesystem>
#include <memory>

#include "devices/interfaces.h"

namespace touchstone::hil {

enum class DeviceCall : int { none, open, exchange, zero_force, motors_off, calibrated, close };
enum class DriverFault : int {
  none,
  device_error,   // throws DeviceError
  out_of_memory,  // throws bad_alloc
  not_exception,  // throws an int
  blocks,         // never returns
  late,           // returns after 50 ms
  not_finite,     // a position that is no number
  frozen,         // a state of a second ago
  out_of_reach,   // a position half a metre off
  refuses,        // zero or motors off is not confirmed, and not done
  aborts          // the process dies
};

// What a process orders. A call that strikes has done its work on the device before it goes wrong, except `refuses`.
struct FaultOrders {
  std::atomic<DeviceCall> call{DeviceCall::none};
  std::atomic<DriverFault> fault{DriverFault::none};
  std::atomic<int> times{0};     // how often it strikes; negative: always
  std::atomic<int> instance{0};  // only in the n-th device that is opened, from 1; 0: in each
  std::atomic<int> opened{0};    // devices so far
  std::atomic<double> struck_s{0.0};
  // What the device does by its nature, not on order.
  std::atomic<bool> one_owner{false};     // opens only if the process that opened it last is gone: UUCP's lock files
  std::atomic<double> open_takes_s{0.0};  // from the second opening on, as vendors' daemons that search the bus
  std::atomic<int> owner{0};
};
std::shared_ptr<FaultOrders> make_fault_orders();

// The plant's file as open_emulated_haptic() takes it.
std::unique_ptr<HapticDevice> open_faulty_device(const std::filesystem::path& file, FaultOrders& orders);

}  // namespace touchstone::hil
