// What the tests, the recorder and the safety supervisor know of a device: a source of wrenches, a device that renders
// forces, and a clock. Every call that waits takes a deadline.
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <span>
#include <string>

#include "devices/device_error.h"
#include "harness/base/vec.h"
#include "harness/recording/ati_calibration.h"

namespace touchstone::hil {

// Seconds that never run back. A test's clock may stand still or jump.
class Clock {
 public:
  virtual ~Clock() = default;
  [[nodiscard]] virtual double now_s() const = 0;
  virtual void sleep_until(double t_s) = 0;
};
// CLOCK_BOOTTIME: it counts the time in which the machine was suspended, so that a command from before a suspend is old
// after it. CLOCK_MONOTONIC stands still meanwhile.
class MonotonicClock final : public Clock {
 public:
  [[nodiscard]] double now_s() const override;
  void sleep_until(double t_s) override;
};

struct DeviceIdentity {
  std::string id;  // of the device table
  std::string serial;
  std::string firmware;     // or driver, or library version
  std::string calibration;  // name and SHA-256 of what turned counts into units; empty where there is none
  bool emulated = false;    // results from it never enter a hardware report
};

struct WrenchSample {
  double t_s = 0.0;            // MonotonicClock's time when the sample arrived, by the kernel where it says so
  std::uint64_t sequence = 0;  // of the device, unwrapped; gaps mean lost samples
  Wrench wrench;               // sensor's frame
  std::uint32_t flags = recording::sample_ok;
  std::uint32_t device_status = 0;
};

// What happened to the stream since start().
struct StreamCounters {
  std::uint64_t received = 0, lost = 0, repeated = 0, reordered = 0, malformed = 0, device_errors = 0;
  std::uint64_t foreign_packets = 0;  // packets from another address than the device's: left out
  std::uint64_t clock_steps = 0;      // of the device's own clock, which somebody set meanwhile
};

class WrenchSource {
 public:
  virtual ~WrenchSource() = default;
  [[nodiscard]] virtual const DeviceIdentity& identity() const = 0;
  // Records per second as the device states them; 0: it does not say.
  [[nodiscard]] virtual double nominal_rate_Hz() const { return 0.0; }
  // Whether the device numbers its records, so that a loss shows as a gap.
  [[nodiscard]] virtual bool numbers_records() const { return true; }
  virtual void start() = 0;
  virtual void stop() noexcept = 0;
  // The samples that have come, at least one unless the deadline (Clock's seconds) passes first: then 0. A deadline
  // that has passed already asks for what is there, without waiting. Throws DeviceError when the device is gone.
  virtual std::size_t read(std::span<WrenchSample> out, double deadline_s) = 0;
  [[nodiscard]] virtual StreamCounters counters() const = 0;
};

// Where a tracker saw a body, or a haptic device its handle.
struct PoseSample {
  double t_s = 0.0;              // as of WrenchSample
  std::uint64_t sequence = 0;    // of the device where it numbers its frames, else of arrival
  std::uint64_t ticks = 0;       // of the device's own clock, PoseSource::ticks_per_s(); 0 where it has none
  Vec3 p_W_m = Vec3::Zero();     // the body's origin in the device's world
  Quat q_WB = Quat::Identity();  // turns the body's frame into the device's world
  std::uint32_t flags = recording::sample_ok;
  std::uint32_t device_status = 0;
};

class PoseSource {
 public:
  virtual ~PoseSource() = default;
  [[nodiscard]] virtual const DeviceIdentity& identity() const = 0;
  [[nodiscard]] virtual double nominal_rate_Hz() const { return 0.0; }
  // Of the clock that stamps each sample where it was measured; 0: the device has none.
  [[nodiscard]] virtual double ticks_per_s() const { return 0.0; }
  // Whether the device numbers its frames, so that a loss shows as a gap.
  [[nodiscard]] virtual bool numbers_frames() const { return true; }
  virtual void start() = 0;
  virtual void stop() noexcept = 0;
  // As WrenchSource::read().
  virtual std::size_t read(std::span<PoseSample> out, double deadline_s) = 0;
  [[nodiscard]] virtual StreamCounters counters() const = 0;
};

struct DeviceState {
  double t_s = 0.0;
  Vec3 p_W_m = Vec3::Zero();
  Vec3 v_W_m_per_s = Vec3::Zero();
  std::uint32_t buttons = 0;
  double temperature_C = std::numeric_limits<double>::quiet_NaN();  // of the motors; NaN: not read
};

class HapticDevice {
 public:
  virtual ~HapticDevice() = default;
  [[nodiscard]] virtual const DeviceIdentity& identity() const = 0;
  // One servo exchange: commands the force and returns the state. Throws DeviceError past the deadline or when gone.
  virtual DeviceState exchange(const Vec3& f_W_N, double deadline_s) = 0;
  // Best effort, from any state, never throws; returns whether the device confirmed.
  virtual bool zero_force() noexcept = 0;
  // The amplifiers off, where the device can: what remains when zero was confirmed, or could not be. As zero_force().
  virtual bool motors_off() noexcept { return zero_force(); }
  // After this long without an exchange the device itself lets go; 0: it has no watchdog.
  [[nodiscard]] virtual double watchdog_s() const = 0;
  // True once position and force are trustworthy (homed, calibrated). Forces before are refused by the supervisor.
  [[nodiscard]] virtual bool calibrated() const = 0;
};

}  // namespace touchstone::hil
