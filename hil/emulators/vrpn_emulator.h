// A VRPN server on the loopback interface. Its greeting and its descriptions of senders and types are what a server
// built from vrpn/vrpn (commit 893c7496) sent to a client over TCP (vrpn_answers.h); its reports are captured ones with
// time, sensor and pose exchanged. Nothing is taken from the driver that it tests. All results say `emulated`.
#pragma once

#include <atomic>
#include <functional>
#include <thread>

#include "emulators/natnet_emulator.h"

namespace touchstone::hil {

class VrpnEmulator {
 public:
  // Sensor 0 moves as `pose` says; sensor 1 reports too, elsewhere.
  VrpnEmulator(double rate_Hz, std::function<EmulatedPose(double)> pose);
  ~VrpnEmulator();
  VrpnEmulator(const VrpnEmulator&) = delete;
  VrpnEmulator& operator=(const VrpnEmulator&) = delete;

  [[nodiscard]] int port() const noexcept { return port_; }
  // The server's clock is set, so much on.
  void set_clock(double by_s) noexcept { set_by_s_ = by_s; }
  // The server goes away.
  void close();

 private:
  void serve();

  double rate_Hz_;
  std::function<EmulatedPose(double)> pose_;
  int port_ = 0, listener_ = -1;
  std::atomic<bool> stop_{false};
  std::atomic<double> set_by_s_{0.0};
  std::thread thread_;
};

}  // namespace touchstone::hil
