// QTM's real-time server on the loopback interface, by Qualisys' protocol documentation 1.20 and, for what it leaves
// open (column by column, millimetres, NaN), by what ViSP's client expects (both named in drivers/qualisys.h). Nothing
// is taken from the driver that it tests. All results say `emulated`.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <string>
#include <thread>

#include "emulators/natnet_emulator.h"

namespace touchstone::hil {

struct QualisysFaults {
  std::uint32_t number_step = 1;      // of the frame numbers: QTM processes every n-th of the cameras' frames
  std::uint32_t drop_every = 0;       // every n-th frame is not sent
  std::uint32_t repeat_every = 0;     // every n-th is sent twice
  std::uint32_t damage_every = 0;     // of every n-th the component is shorter than its bodies
  std::uint32_t begins_again = 0;     // after this many frames a measurement is started
  std::uint32_t finishes_after = 0;   // after this many frames the measurement is over
  std::uint32_t body_lost_after = 0;  // after this many frames the bodies are one fewer
  bool full = false;                  // it serves ten clients already
  bool mute = false;                  // it takes the connection and says nothing
  bool endless = false;               // its greeting says to be 4 MB long, and never ends
  bool big_endian = false;            // it is the port after it
  bool no_bodies = false;
};

// Two bodies: "Table", which stands still, and "Stylus", which moves as `pose` says. Its time is zero when a client has
// it stream; its clock says `began_us` more.
class QualisysEmulator {
 public:
  QualisysEmulator(double rate_Hz, QualisysFaults faults, std::function<EmulatedPose(double)> pose);
  ~QualisysEmulator();
  QualisysEmulator(const QualisysEmulator&) = delete;
  QualisysEmulator& operator=(const QualisysEmulator&) = delete;

  static constexpr std::int64_t began_us = 7'000'000'000;
  static constexpr float residual_mm = 0.4321F;
  [[nodiscard]] int port() const noexcept { return port_; }
  // QTM is closed.
  void close();

 private:
  void serve();
  std::string answer(const std::string& command);
  std::string frame(std::uint64_t count);

  double rate_Hz_;
  QualisysFaults faults_;
  std::function<EmulatedPose(double)> pose_;
  int port_ = 0, listener_ = -1;
  bool streaming_ = false;
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

}  // namespace touchstone::hil
