// NDI's trackers (Polaris and what speaks the same commands) over the network (port 8765) or a serial line.
//
//   command: NAME:arguments, CRC as four hex digits, CR; answer: text, CRC, CR; ERRORnn for what went wrong
//
//   a wired tool: PHSR:02 lists port handles to be initialised; a passive one: PHRQ gives a handle, PVWR writes its
//     definition (.rom) in pieces of 64 bytes; then PINIT, PENA, TSTART
//
//   TX:0001 -> count, and per handle: handle, quaternion 4 x 6 characters [1e-4], position 3 x 7 [1e-2 mm], error 6, or
//     MISSING or DISABLED; status 8 hex, frame 8 hex, LF; at the end the system's status, 4 hex
//
//   on a serial line: the device begins at 9600 baud; COMM changes the speed and the device keeps it, so that it is
//     sent back to 9600 in the end; a break resets the device to 9600, where it greets with RESET
//
// Source: PlusToolkit/ndicapi, commit 652d9ead (ndicapi.cxx: commands, CRC-16 of polynomial 0x8005 reflected, parsing
// of TX, ndiSerialProbe; ndicapi.h: the commands' forms, what COMM leaves behind). Orientations w x y z. The frame
// number is the device's own; its rate is not said (60 frames a second with Polaris), so that the user states it.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "devices/interfaces.h"
#include "devices/known_device.h"

namespace touchstone::hil {

namespace ndi {
inline constexpr int usual_port = 8765;
// Of "RESET" 0xbe6f, as the device greets.
std::uint16_t crc16(std::string_view text);
std::string command(const std::string& text);
// The answer without its CRC; nothing where that is wrong.
std::optional<std::string> checked(std::string_view answer);
struct Tool {
  int handle = 0;
  bool missing = true;  // or disabled
  Vec3 p_W_m = Vec3::Zero();
  Quat q_WB = Quat::Identity();
  std::uint32_t status = 0, frame = 0;
};
// Of an answer to TX:0001 without its CRC; nothing where it is cut or no number stands where one must.
std::optional<std::vector<Tool>> parse_tx(std::string_view answer);
}  // namespace ndi

struct NdiOptions {
  std::string address;  // host, or a node (/dev/...) for a serial line
  int port = ndi::usual_port;
  int baud = 115200;      // what the serial line is switched to; the device begins at 9600
  std::string tool_file;  // definition of a passive tool; empty: a wired tool
  double rate_Hz = 0.0;   // frames per second; 0: not known, and it is asked as often as a Polaris counts, 60 a second
  double timeout_s = 5.0;
};

// Connects over the network and asks nothing: a tracker that another program uses goes on. Throws DeviceError(absent).
void reach_ndi(const NdiOptions& options);
// Throws DeviceError: absent, failed (no tool, or the device says an error).
std::unique_ptr<PoseSource> open_ndi(const NdiOptions& options);

extern const KnownDevice ndi_device;

}  // namespace touchstone::hil
