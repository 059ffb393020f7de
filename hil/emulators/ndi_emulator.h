// An NDI Polaris on a serial line or on the network, from ndicapi's side of the conversation (PlusToolkit/ndicapi,
// commit 652d9ead): the answers are what its parser expects, its own client was run against this emulator. One wired
// tool at port handle 01; with PHRQ a passive one at 0A that wants its definition. The frame counter runs at 60 Hz
// whatever the tracking rate: a Vega at 20 Hz numbers its poses ... 635, 635, 638
// (SciKit-Surgery/scikit-surgerynditracker, issue 90), and PlusToolkit/PlusLib's pull request 1068 sets rates as thirds
// of the "frame frequency". Nothing is taken from the driver that it tests. On a line it understands and answers only
// at the speed that it was last told, from 9600 baud on. All results say `emulated`.
#pragma once

#include <atomic>
#include <functional>
#include <string>
#include <thread>

#include "emulators/natnet_emulator.h"
#include "emulators/serial_emulator.h"

namespace touchstone::hil {

struct NdiFaults {
  bool no_tool = false;
  std::uint32_t wrong_crc_every = 0;  // of the answers to TX
  std::uint32_t missing_every = 0;    // frames in which the tool is hidden
  double late_s = 0.0;                // the answers to TX
  bool endless = false;               // the answers to TX have no CR, and no end
  double deaf_s = 0.0;                // on a line: hears nothing so long, then greets as after a break
};

// The device itself: answers commands.
class NdiDevice {
 public:
  NdiDevice(double rate_Hz, NdiFaults faults, std::function<EmulatedPose(double)> pose)
      : rate_Hz_(rate_Hz), faults_(faults), pose_(std::move(pose)) {}
  // To a command without its CR, with what ends it; `t_s` since the device began.
  std::string answer(const std::string& command, double t_s);
  // As answer(), for what comes on a line at that speed.
  std::string on_line(const std::string& came, double t_s, int baud);
  [[nodiscard]] const NdiFaults& faults() const noexcept { return faults_; }
  [[nodiscard]] std::size_t definition_bytes() const noexcept { return definition_bytes_; }
  [[nodiscard]] std::size_t commands() const noexcept { return commands_; }

 private:
  [[nodiscard]] std::string frame(double t_s);

  double rate_Hz_;
  NdiFaults faults_;
  std::function<EmulatedPose(double)> pose_;
  std::atomic<std::size_t> definition_bytes_{0}, commands_{0};
  std::string handle_ = "01", heard_;
  bool tracking_ = false, greeted_ = false;
  std::uint32_t asked_ = 0;
  int baud_ = 9600;
};

class NdiEmulator {
 public:
  NdiEmulator(double rate_Hz, NdiFaults faults, std::function<EmulatedPose(double)> pose);
  ~NdiEmulator();
  NdiEmulator(const NdiEmulator&) = delete;
  NdiEmulator& operator=(const NdiEmulator&) = delete;
  [[nodiscard]] int port() const noexcept { return port_; }
  // The bytes of the definition that was written.
  [[nodiscard]] std::size_t definition_bytes() const noexcept { return device_.definition_bytes(); }
  // How many came.
  [[nodiscard]] std::size_t commands() const noexcept { return device_.commands(); }

 private:
  void serve();

  NdiDevice device_;
  int port_ = 0, listener_ = -1;
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

// For a SerialEmulator.
SerialEmulator::Device ndi_on_a_line(NdiFaults faults, std::function<EmulatedPose(double)> pose);

}  // namespace touchstone::hil
