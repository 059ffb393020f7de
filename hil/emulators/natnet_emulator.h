// Motive on the loopback interface: NatNet's answers and frames. Laid out as mje-nz/python_natnet (commit dcb6fd0a) has
// them, whose packets were captured from Motive 2.1: a frame made here from the values of a captured one is that packet
// byte for byte (natnet_test.cc); NatNet 4.1's section lengths as in the Python client of OptiTrack's SDK. Nothing is
// taken from the driver that it tests. All results say `emulated`.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <string>
#include <thread>
#include <vector>

#include "devices/interfaces.h"

namespace touchstone::hil {

struct EmulatedMarker {
  std::uint16_t marker = 1, model = 2;
  float p[3] = {0, 0, 0};
  float size = 0.02F, residual = 2e-4F;
  std::int16_t parameters = 10;
};

struct EmulatedFrame {
  std::uint32_t number = 0;
  std::int32_t body = 2;
  float p[3] = {0, 0, 0}, q_xyzw[4] = {0, 0, 0, 1};
  float mean_error = 5e-4F;
  bool tracked = true;
  std::vector<EmulatedMarker> markers;  // those of a model are also sent as markers of older clients
  double time_s = 0.0;
  std::uint64_t exposure = 0, received = 0, sent = 0;
};
// The packet of NatNet 3.0, or with section lengths that of 4.1.
std::string natnet_frame_packet(const EmulatedFrame& frame, bool sized);

struct EmulatedPose {
  Vec3 p_W_m = Vec3::Zero();
  Quat q_WB = Quat::Identity();
  bool tracked = true;
};

struct NatNetFaults {
  double clock_ppm = 0.0;          // Motive's clock against this machine's
  double drift_ppm_per_s = 0.0;    // and by how much more with each second
  std::uint32_t drop_every = 0;    // every n-th frame is not sent
  std::uint32_t repeat_every = 0;  // every n-th is sent twice
  std::uint32_t short_every = 0;   // every n-th is cut in half
  std::uint32_t silent_after = 0;
  std::uint32_t begins_at = 1;     // the first frame's number
  std::uint32_t begins_again = 0;  // after this many frames the numbers begin at 1
  bool second_card = false;        // frames come from 127.0.0.2, answers from 127.0.0.1
};

class NatNetEmulator {
 public:
  // The pose over the emulator's own time; NatNet 3.0, or 4.1.
  NatNetEmulator(double rate_Hz, NatNetFaults faults, std::function<EmulatedPose(double)> pose,
                 bool version_4_1 = false);
  ~NatNetEmulator();
  NatNetEmulator(const NatNetEmulator&) = delete;
  NatNetEmulator& operator=(const NatNetEmulator&) = delete;

  [[nodiscard]] int command_port() const noexcept { return port_; }
  [[nodiscard]] std::uint64_t sent() const noexcept { return sent_; }
  // From now on it sends nothing.
  void fall_silent() noexcept { silent_ = true; }
  // Its computer's clock is set, so much on.
  void set_clock(double by_s) noexcept { set_by_s_ = by_s; }
  // This machine's time at which the emulator's own time was zero.
  [[nodiscard]] double began_s() const noexcept { return began_s_; }

  static constexpr double ticks_per_s = 3312787.0;  // as captured
  static constexpr double epoch_s = 1e5;            // its own clock's time at began_s(): since its computer was started
  static constexpr double latency_s = 0.0055;       // from exposure to sending, as captured

 private:
  void serve();
  void answer(const unsigned char* request, long size);
  void send(int socket, const std::string& packet);

  double rate_Hz_;
  NatNetFaults faults_;
  std::function<EmulatedPose(double)> pose_;
  bool sized_;
  int socket_ = -1, second_socket_ = -1, port_ = 0;
  std::string client_;  // its address, as bytes
  std::atomic<bool> stop_{false}, silent_{false};
  std::atomic<std::uint64_t> sent_{0};
  std::atomic<double> began_s_{0.0}, set_by_s_{0.0};
  std::thread thread_;
};

}  // namespace touchstone::hil
