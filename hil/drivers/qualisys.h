// Qualisys Track Manager over its real-time protocol, version 1.8 and later, by TCP, little-endian. Read only: control
// of QTM is never taken.
//
//   packet: size u32 (of all of it), type u32, content
//     0 error and 1 command or its answer: text and a zero; 2 XML and a zero; 3 data; 4 no more data; 6 event
//
//   client -> "Version 1.8", "QTMVersion", "GetParameters 6D" (the bodies' names), "StreamFrames AllFrames 6DRes"
//
//   data: time i64 [us from the measurement's start], frame number u32, components u32; each component: size u32, type
//   u32
//
//   component 11 (6DRes): bodies u32, two rates u16, u16; each body: position 3 f32 [mm], rotation 9 f32 column by
//   column,
//     residual f32 [mm]. A body that is not seen is NaN.
//
// Sources: "QTM Real-time Server Protocol Documentation" 1.20 (qualisys/Real-Time-Protocol-Documentation, commit
// 81deb9a9), whose list of changes says that 1.8 made the coordinates single precision. It leaves the matrix' order,
// the unit and the lost body open: these are as ViSP's client has them (lagadic/visp, commit 20cf165f,
// vpMocapQualisys.cpp).
//   The rotation turns the body's frame into QTM's world. Frames that are sent have the cameras' numbers, of which QTM
//   may
// process every n-th only: the shortest step is one frame. Times are the cameras', not those of the packets.
#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "devices/interfaces.h"
#include "devices/known_device.h"

namespace touchstone::hil {

namespace qtm {
inline constexpr int usual_port = 22223;  // the base port and 1
enum class Type : std::uint32_t { error = 0, command = 1, xml = 2, data = 3, no_more_data = 4, event = 6 };
struct Packet {
  Type type = Type::error;
  std::span<const unsigned char> content;
  std::size_t bytes = 0;  // of the whole packet

  [[nodiscard]] std::string text() const;  // up to its zero
};
std::string command(const std::string& text);
// The packet that begins there; nothing where it is not whole yet. Throws DeviceError(failed) for a size that no packet
// has; `place` begins the message.
std::optional<Packet> parse(std::span<const unsigned char> bytes, const std::string& place);

// A body whose pose holds a number that is none, or no rotation, is not tracked and at the origin.
struct Body {
  Vec3 p_W_m = Vec3::Zero();
  Quat q_WB = Quat::Identity();
  double residual_m = std::numeric_limits<double>::quiet_NaN();
  bool tracked = false;
};
struct Frame {
  std::int64_t time_us = 0;
  std::uint32_t number = 0;
  std::vector<Body> bodies;
};
// False where the content of a data packet is cut short or holds no 6DRes.
bool parse_frame(std::span<const unsigned char> content, Frame& frame);
// The bodies' names in the order of the frames' bodies; nothing where the text is no such XML.
std::optional<std::vector<std::string>> parse_names(const std::string& xml);
}  // namespace qtm

struct QualisysOptions {
  std::string host;
  int port = qtm::usual_port;
  std::string body;        // as QTM names it; empty: the only one
  double timeout_s = 3.0;  // for each of QTM's answers
  double rate_Hz = 0.0;    // of QTM's real-time processing, where the user states it: QTM says the cameras' alone
};

// The device status of a sample is the body's residual in micrometres, all bits where QTM gives none.
// Throws DeviceError: absent, busy (it serves ten clients), timed_out, failed (no such body: the message lists them).
std::unique_ptr<PoseSource> open_qualisys(const QualisysOptions& options);

extern const KnownDevice qualisys_device;

}  // namespace touchstone::hil
