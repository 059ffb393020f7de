// Novint Falcon over libusb: an FTDI serial bridge (0403:cb48, endpoints 0x02 and 0x81, two modem bytes before every
// answer), firmware uploaded at 140 kbaud with every byte echoed, then 16-byte frames `<` 14 nibbles + 0x41 `>` both
// ways. Source of the protocol: libnifalcon. The firmware is the vendor's and not part of this project: its file is
// named in the hardware map. The device has no watchdog of its own: drive it behind the guardian (guardian.h) only.
#pragma once

#include <array>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "devices/interfaces.h"
#include "devices/known_device.h"

namespace touchstone::hil {

namespace falcon {
inline constexpr std::uint16_t vendor = 0x0403, product = 0xcb48;
inline constexpr std::size_t frame_bytes = 16;
using Frame = std::array<unsigned char, frame_bytes>;

struct Command {
  std::array<int, 3> motors{};  // signed 16 bit
  // The firmware counts from the arms' index marks while set, and forgets them where a packet comes without: "the
  // homing mode bit must be set in each input packet" (libnifalcon, FalconFirmware.h).
  bool homing = true;
};
struct Answer {
  std::array<int, 3> encoders{};
  unsigned homed = 0;  // bit per arm
  unsigned buttons = 0;
};
// What the motors are told for these torques [N m]. If one would be beyond what a motor takes (4095), all are scaled by
// the same, so that the force keeps its direction (as libnifalcon does it); none if a torque is no number.
std::array<int, 3> motor_counts(const Vec3& torque_Nm, double counts_per_Nm);
Frame encode(const Command& command);
Command decode_command(const Frame& frame);
Frame encode(const Answer& answer);
// Nothing where brackets or nibbles are not a frame's.
std::optional<Answer> decode_answer(std::span<const unsigned char, frame_bytes> bytes);
}  // namespace falcon

struct FalconOptions {
  std::string serial;              // empty: any
  std::filesystem::path firmware;  // uploaded where the device does not answer without; empty: must be running
  double timeout_s = 1.0;          // of each transfer while opening
  double counts_per_newton_metre = 10000.0;  // nominal; libnifalcon's scale, measure your own (docs/how-to/lab.md)
  bool emulated = false;
};

// Throws DeviceError: absent, wrong_serial, no_permission, busy, failed (firmware refused), timed_out, gone.
std::unique_ptr<HapticDevice> open_falcon(const FalconOptions& options);

extern const KnownDevice falcon_device;

}  // namespace touchstone::hil
