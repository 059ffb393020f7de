// An NDI Polaris on a serial line or on the network, from ndicapi's side of the conversation (PlusToolkit/ndicapi,
// commit 652d9ead): the answers are what its parser expects, its own client was run against this emulator. One wired
// tool at port handle 01; with PHRQ a passive one at 0A that wants its definition. Nothing is taken from the driver
// that it tests. All results say `emulated`.
#pragma once

#include <atomic>
#include <functional>
#include <string>
#include <thread>

#include "harness/base/rooms.h"
#include "hil/emulators/natnet_emulator.h"

namespace touchstone::hil {

struct NdiFaults {
  bool no_tool = false;
  std::uint32_t wrong_crc_every = 0;  // of the answers to TX
  std::uint32_t missing_every = 0;    // frames in which the tool is hidden
};

class NdiEmulator {
 public:
  NdiEmulator(double rate_Hz, NdiFaults faults, std::function<EmulatedPose(double)> pose);
  ~NdiEmulator();
  NdiEmulator(const NdiEmulator&) = delete;
  NdiEmulator& operator=(const NdiEmulator&) = delete;
  [[nodiscard]] int port() const noexcept { return port_; }
  // The bytes of the definition that was written.
  [[nodiscard]] std::size_t definition_bytes() const noexcept { return definition_bytes_; }

 private:
  void serve();
  std::string answer(const std::string& command, double t_s);

  double rate_Hz_;
  NdiFaults faults_;
  std::function<EmulatedPose(double)> pose_;
  int port_ = 0, listener_ = -1;
  std::atomic<std::size_t> definition_bytes_{0};
  std::string handle_ = "01";
  bool tracking_ = false;
  std::uint32_t asked_ = 0;
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

}  // namespace touchstone::hil
