// Leptrino's six-axis force sensors on a serial line or the virtual one of their USB (CFS, PFS, FFS).
//
//   message, both ways: DLE STX, content, DLE ETX, BCC; a DLE in the content is sent twice. The BCC is the exclusive or
//     of the content (each doubled DLE once) and ETX.
//
//   content, little-endian: length u8 (of the content), 0xff, command u8, result u8 (0 in a command), data
//
//   0x2a product: 16 characters model, 8 serial, 4 firmware, from protocol 1.31 on 6 of the output rate [Hz]
//   0x2b rated values: 6 f32 [N, N m]
//   0x32 start: answered, then a sample each period: 6 i16 in rated values / 10000, 2 bytes, status u8, 1 byte
//   0x33 stop
//
//   status: bit 0 correction data in its memory, bit 1 sensor, bit 2 beyond the rated values; the others are undefined.
//     Values beyond 3.2 times the rated ones stop at 32000.
//
// Sources: Leptrino's "communication format specification" Ver 1.13 of 2013-01-22, which public ROS drivers carry along
// (hiveground-ros-package/leptrino_force_torque, commit 02774a4f, doc/protocal.pdf); the output rate as a PFS055YA251U6
// with protocol 1.31 answers it (katayama-ki/leptrino_force_torque_ros_driver, commit 2a973f22).
//   The sensor neither numbers nor stamps its samples, which it sends at an even rate: they are numbered as they come.
//   A
// damaged message is one that is missing. Behind bytes that are no message, as when a line overflows, it is not known
// how many are: the number is that of the arrival at this rate. A message that is lost whole bends the axis, which its
// own check finds (stream_export.h), and shows in the rate.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "devices/interfaces.h"
#include "devices/known_device.h"

namespace touchstone::hil {

namespace leptrino {
inline constexpr std::size_t longest_content = 128;
enum class Command : std::uint8_t { product = 0x2a, rated_values = 0x2b, start = 0x32, stop = 0x33 };

// A command without data, as it is sent.
std::string message(Command command);

enum class Piece : std::uint8_t {
  incomplete,  // more bytes are needed
  content,     // a message whose BCC and length agree
  refused,     // DLE NAK: the sensor got a damaged command
  damaged,     // a message with its end whose BCC or length is wrong
  noise,       // bytes that belong to no message
};
struct Next {
  Piece piece = Piece::incomplete;
  std::size_t used = 0;  // bytes that are done with
  std::string content;
};
// What the bytes begin with.
Next next_piece(std::span<const unsigned char> bytes);

struct Product {
  std::string model, serial, firmware;
  double rate_Hz = 0.0;  // 0: it does not say
};
// Nothing where the content is no such answer.
std::optional<Product> parse_product(std::string_view content);
// Above 0 and finite, each.
std::optional<std::array<double, 6>> parse_rated_values(std::string_view content);
struct Sample {
  std::array<std::int16_t, 6> counts{};
  std::uint8_t status = 0;  // its defined bits
};
std::optional<Sample> parse_sample(std::string_view content);
}  // namespace leptrino

struct LeptrinoOptions {
  std::string node;
  int baud = 460800;       // as the specification has it
  double rate_Hz = 0.0;    // if the sensor does not say it
  double timeout_s = 3.0;  // for the answer to a command, which is sent up to three times meanwhile
};

// Throws DeviceError: absent, no_permission, busy, timed_out (it does not answer), failed (it refuses a command, or its
// rate is not known).
std::unique_ptr<WrenchSource> open_leptrino(const LeptrinoOptions& options);

extern const KnownDevice leptrino_device;

}  // namespace touchstone::hil
