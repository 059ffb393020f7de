// A Net F/T on the loopback interface: HTTP configuration and RDT records, with the faults that networks and sensors
// have. It answers netftapi2.xml with what a real Gamma answered (netft_answers.h), its rate and name exchanged.
// Requests and records are laid out as ATI's manual 9620-05-NET FT, section "RDT protocol", and public ROS drivers for
// it (netft_utils) have them: big-endian, 8 and 36 bytes; nothing is taken from the driver that it tests. All results
// say `emulated`.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <thread>

#include "drivers/netft.h"

namespace touchstone::hil {

struct NetFtFaults {
  std::uint32_t drop_every = 0;        // every n-th record is not sent; 0: none
  std::uint32_t repeat_every = 0;      // every n-th is sent twice
  std::uint32_t swap_every = 0;        // every n-th changes places with the next
  std::uint32_t short_every = 0;       // every n-th is cut to 20 bytes
  std::uint32_t error_bit_every = 0;   // every n-th has the status bit of an error
  std::uint32_t first_sequence = 1;    // near 2^32: rolls over
  std::uint32_t silent_after = 0;      // stops sending after this many; 0: never
  bool http_silent = false;            // accepts the connection and never answers
  bool http_garbage = false;           // answers with something that is not a configuration
  bool newest_client_wins = false;     // a second client takes the stream from the first
  bool names_itself_a_sensor = false;  // its name does not say that it is emulated
  double clock_ppm = 0.0;              // the sensor's clock against this machine's
};

class NetFtEmulator {
 public:
  // Force and torque [N, N m] over the emulator's own time; sends at `rate_Hz`.
  NetFtEmulator(double rate_Hz, NetFtFaults faults, std::function<Wrench(double)> wrench);
  ~NetFtEmulator();
  NetFtEmulator(const NetFtEmulator&) = delete;
  NetFtEmulator& operator=(const NetFtEmulator&) = delete;

  [[nodiscard]] NetFtAddress address() const;
  [[nodiscard]] std::uint64_t sent() const noexcept { return sent_.load(); }
  // This machine's time at which the stream was asked for: record n (from 1) is due (n - 1) / rate later, by the
  // sensor's own clock.
  [[nodiscard]] double started_s() const noexcept { return started_s_; }
  // The network cable is pulled: both ports close.
  void unplug();

 private:
  void serve_http();
  void serve_rdt();

  double rate_Hz_;
  NetFtFaults faults_;
  std::function<Wrench(double)> wrench_;
  int http_socket_ = -1, udp_socket_ = -1;
  int http_port_ = 0, udp_port_ = 0;
  std::atomic<bool> stop_{false};
  std::atomic<std::uint64_t> sent_{0};
  std::atomic<double> started_s_{0.0};
  std::thread http_thread_, rdt_thread_;
};

}  // namespace touchstone::hil
