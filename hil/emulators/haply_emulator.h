// Haply's Inverse service on the loopback interface, as Haply documents it (docs.haply.co/inverseSDK/service, 3.5:
// "WebSocket Protocol", "Control Commands" and "JSON Conventions"; 3.4: "Simulation Channel"): an inventory with
// config, state and status on connecting, then exactly one state update for each message; forces by set_cursor_force
// with "vector", before 3.5 with "values"; any other key is ignored without a word. Not as documented: the device's
// type is "emulated", so that no result from here enters a hardware report; the last force stays when the client falls
// silent (3.5 lets go, after a time that is not said). All results say `emulated`.
#pragma once

#include <atomic>
#include <functional>
#include <string>
#include <thread>

#include "harness/base/vec.h"

namespace touchstone::hil {

struct HaplyFaults {
  bool no_device = false;
  bool strange_inventory = false;  // devices are numbers, which no service documents
  bool not_calibrated = false;
  bool no_status = false;         // as older services
  bool before_3_5 = false;        // no basis, mount or applied force is said, and "values" is heard
  bool ignores_commands = false;  // as keys that it does not know
  double force_before_N = 0.0;    // along x, by another client
  double mount_scale = 1.0;
  const char* axes = "XYZ";
  std::uint32_t silent_after = 0;  // no answer from the n-th message on
  std::uint32_t garbage_at = 0;    // the n-th answer is no JSON
  std::uint32_t gone_after = 0;    // the device is not listed from the n-th answer on
};

class HaplyEmulator {
 public:
  // Where the cursor is over the emulator's time [m].
  HaplyEmulator(HaplyFaults faults, std::function<Vec3(double)> cursor);
  ~HaplyEmulator();
  HaplyEmulator(const HaplyEmulator&) = delete;
  HaplyEmulator& operator=(const HaplyEmulator&) = delete;

  [[nodiscard]] int port() const noexcept { return port_; }
  [[nodiscard]] Vec3 applied_N() const { return {force_[0], force_[1], force_[2]}; }
  [[nodiscard]] std::uint64_t messages() const noexcept { return messages_; }

 private:
  void serve();

  HaplyFaults faults_;
  std::function<Vec3(double)> cursor_;
  int port_ = 0, listener_ = -1;
  std::atomic<double> force_[3] = {0.0, 0.0, 0.0};
  std::atomic<std::uint64_t> messages_{0};
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

}  // namespace touchstone::hil
