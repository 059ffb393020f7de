// Bota Systems' force-torque sensors with a serial line (SensONE, Rokubi: BFT-SENS-SER-M8).
//
//   text commands, answered `r,0,<command>,0`:
//     C to configuration
//     c,<temperature compensation>,<calibration>,<0: binary>,<speed>
//     f,<sinc length>,<chop>,<fast>,<no FIR>
//     R to measuring
//
//   speed: 0: 9600 baud, 1: 57600, 2: 115200, 3: 230400, 4: 460800
//
//   frame, 37 bytes, little-endian: 0xaa, status u16, force 3 f32 [N], torque 3 f32 [N m], time u32 (its unit is not
//     needed: only its steps are used, against each other), temperature f32 [deg C], CRC u16 over the 34 bytes between
//
// Sources: Bota's Python interface as published with public loggers of it, and Bota's MATLAB example (BOTAsys/matlab,
// commit 74bbe419). The CRC is X.25's (polynomial 0x1021 reflected, begun and ended with 0xffff). A frame comes each
// sinc length x 19.53125 us. The sensor numbers no frames: a loss shows in its time, in steps of the shortest one seen.
// What was lost before the first undisturbed step is counted when that comes.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "devices/interfaces.h"
#include "devices/known_device.h"

namespace touchstone::hil {

namespace bota {
inline constexpr std::size_t frame_bytes = 37;
inline constexpr unsigned char header = 0xaa;
// As ITU-T X.25 has it; of "123456789" 0x906e.
std::uint16_t crc_x25(std::span<const unsigned char> bytes);
struct Frame {
  std::uint16_t status = 0;
  Wrench wrench;
  std::uint32_t time = 0;  // by the sensor's clock
  float temperature_C = 0.0F;
};
// Nothing where the header or the checksum is wrong, or a force or torque is no finite number.
std::optional<Frame> decode(std::span<const unsigned char, frame_bytes> bytes);
}  // namespace bota

struct BotaOptions {
  std::string node;
  int baud = 460800;       // that the sensor is at, and stays at
  int sinc_length = 128;   // 400 Hz; 51 to 512
  double timeout_s = 3.0;  // for the answers to its commands
};

// Throws DeviceError: absent, no_permission, timed_out (it does not answer), failed (it refuses a setting).
std::unique_ptr<WrenchSource> open_bota(const BotaOptions& options);

extern const KnownDevice bota_device;

}  // namespace touchstone::hil
