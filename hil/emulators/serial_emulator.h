// The other end of a serial line: a pseudo-terminal whose node a driver opens. What it says is the device's, from third
// parties' sources (see each device); nothing is taken from the drivers that it tests. All results say `emulated`.
#pragma once

#include <atomic>
#include <functional>
#include <string>
#include <thread>

#include "devices/interfaces.h"

namespace touchstone::hil {

class SerialEmulator {
 public:
  // What there is to send, given what came, the seconds since it began and the speed that the driver set [baud]; called
  // about every half millisecond.
  using Device = std::function<std::string(const std::string& came, double t_s, int baud)>;
  explicit SerialEmulator(Device device);
  ~SerialEmulator();
  SerialEmulator(const SerialEmulator&) = delete;
  SerialEmulator& operator=(const SerialEmulator&) = delete;

  [[nodiscard]] const std::string& node() const noexcept { return node_; }
  void unplug();

 private:
  Device device_;
  std::string node_;
  int fd_ = -1;
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

struct BotaFaults {
  std::uint32_t drop_every = 0;    // every n-th frame is not sent
  std::uint32_t halved_until = 0;  // until this frame every second one is not sent
  std::uint32_t damage_every = 0;  // every n-th has a wrong byte
  std::uint32_t status_every = 0;  // every n-th has a status bit
  std::uint32_t resets_at = 0;     // at this frame its clock begins again
  bool refuses_filter = false;
  std::function<void(const std::string&)> configured;  // is told each command "c,..."
};
// Bota's sensor as its own Python interface expects it (see drivers/bota.h for the source): greets with "App Init",
// answers commands as "r,0,<command>,0", then frames at 1 / (sinc length x 19.53125 us). Its checksum is counted bit by
// bit from the polynomial as X.25 writes it, not as the driver does.
SerialEmulator::Device bota_sensor(BotaFaults faults, std::function<Wrench(double)> wrench);

struct LeptrinoFaults {
  std::uint32_t drop_every = 0;    // every n-th sample is not sent
  std::uint32_t damage_every = 0;  // every n-th has a wrong byte
  std::uint32_t status_every = 0;  // every n-th has the status
  unsigned char status = 0;
  std::uint64_t overflow_at = 0;   // of this sample half is sent, and nothing of the next 600
  unsigned char start_result = 0;  // of the answer to the command to start
  int damaged_commands = 0;        // the first so many commands come to it damaged
  bool endless = false;            // the answer to the first command has no end
  bool was_sending = false;        // another program left it so
  float rated_force_N = 200.0F;    // along z twice that
  std::string rate = "1200";       // as protocol 1.31 says it; empty: protocol 1.13, which does not
  double sends_Hz = 1200.0;
};
// A sensor with protocol 1.13 or 1.31, by Leptrino's specification and, for the output rate, by what a PFS055YA251U6
// answered (see drivers/leptrino.h for both).
SerialEmulator::Device leptrino_sensor(LeptrinoFaults faults, std::function<Wrench(double)> wrench);

// A microcontroller that prints the load [units] as the example sketch of HX711 (HX711_full_example.ino, from its
// setup() on, without the pause of 5 s between readings) or of HX711_ADC does. It begins half a second after its line
// was opened, as one that the opening resets.
SerialEmulator::Device load_cell_sketch(bool adc_library, double rate_Hz, const std::function<double(double)>& units);

}  // namespace touchstone::hil
