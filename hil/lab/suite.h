// What the files of the lab's suite share: when a test runs, is skipped or fails, and a bench for the device, on
// hardware or simulated.
//   TOUCHSTONE_HIL_OPERATOR=1   a person is at the bench: tests that need one run
//   TOUCHSTONE_HIL_DEAD_MAN     what must be held while a test commands forces (hil/safety/dead_man.h)
#pragma once

#include <gtest/gtest.h>

#include <memory>
#include <string>

#include "devices/device_lock.h"
#include "devices/hardware_map.h"
#include "emulators/simulated_bench.h"
#include "lab/availability.h"
#include "lab/evidence.h"
#include "lab/finding.h"
#include "lab/servo_loop.h"
#include "safety/guardian.h"
#include "safety/stop_signal.h"

namespace touchstone::hil {

bool operator_present();

// Skips or fails by the rules. `found` is left where the test runs.
#define TOUCHSTONE_JUDGE(found)                                           \
  if ((found).decision == Decision::skip) GTEST_SKIP() << (found).reason; \
  ASSERT_NE((found).decision, Decision::fail) << (found).reason

#define TOUCHSTONE_REQUIRE_DEVICE(found, id)   \
  const Availability found = availability(id); \
  TOUCHSTONE_JUDGE(found)

enum class Needs { nothing, person, forces };  // forces: a person with a dead-man input
// As availability(), and what else the test needs.
Availability availability_for(const std::string& device_id, Needs needs);

// A haptic device behind the guardian with all that a test needs of it.
class LabStation {
 public:
  // `with_sensor`: also the first force sensor that the hardware map connects. Throws DeviceError.
  LabStation(const std::string& device_id, const Availability& found, bool commands_forces, bool with_sensor);

  [[nodiscard]] Bench& bench() { return *bench_; }
  [[nodiscard]] SimulatedBench* simulated() { return simulated_.get(); }
  [[nodiscard]] const LabLimits& limits() const { return limits_; }
  [[nodiscard]] double force_limit_N() const { return bench_->limits.force_N; }
  [[nodiscard]] bool emulated() const { return simulated_ != nullptr; }
  // Publishes the finding as this device's evidence and reports each limit that does not hold as a test failure.
  void conclude(const Finding& finding);

 private:
  std::string id_;
  MappedDevice mapped_;
  LabLimits limits_;
  std::unique_ptr<SimulatedBench> simulated_;
  std::unique_ptr<DeviceLock> sensor_lock_;
  std::unique_ptr<HapticDevice> device_;
  std::unique_ptr<WrenchSource> sensor_;
  std::unique_ptr<DeadMan> dead_man_;
  std::unique_ptr<StopSignal> stop_;
  MonotonicClock clock_;
  std::unique_ptr<Bench> bench_;
};

// The guard's limits for it: the map's force limit, and what the lab's tests need of the rest.
GuardOptions guard_options(const MappedDevice& mapped);

}  // namespace touchstone::hil
