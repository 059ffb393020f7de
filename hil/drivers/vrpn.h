// Trackers behind a VRPN server (Vicon, Polhemus, OptiTrack and others serve it), over TCP alone: this client announces
// no UDP port, so that the server sends everything over the one connection, nothing is lost and nothing is out of
// order.
//
//   both sides first send a cookie of 24 bytes, "vrpn: ver. 07.38  0" and zeroes; the major version must agree
//
//   message, all big-endian: length u32 (of header and payload without padding), time of the server u32 s, u32 us,
//     sender i32, type i32, a sequence u32; padded to 24; the payload, padded to 8
//
//   type -1: the sender is described, -2: a type is; each payload is a length u32 and the name with its zero
//
//   type "vrpn_Tracker Pos_Quat": sensor i32, i32, position 3 f64 [m], orientation x y z w 4 f64
//
// Source: vrpn/vrpn, commit 893c7496 (vrpn_Connection.C, vrpn_Tracker.C), and what a server built from it sends
// (emulators/vrpn_answers.h).
//   Samples have the server's time of the report. A sensor that is hidden sends nothing: a gap in time, no flag. The
// server numbers no reports of one sensor, so that a report it left out cannot be seen.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "devices/interfaces.h"
#include "devices/known_device.h"

namespace touchstone::hil {

namespace vrpn {
inline constexpr int usual_port = 3883;
inline constexpr std::size_t cookie_bytes = 24, header_bytes = 24;
struct Message {
  double time_s = 0.0;
  std::uint32_t seconds = 0, microseconds = 0;
  std::int32_t sender = 0, type = 0;
  std::span<const unsigned char> payload;
  std::size_t bytes = 0;  // of the whole message with its padding
};
std::string cookie();
// True where the other side speaks this major version.
bool cookie_agrees(std::span<const unsigned char> bytes);
// The message that begins there; nothing where it is not whole yet. Throws DeviceError(failed) for a length that no
// message has.
std::optional<Message> parse(std::span<const unsigned char> bytes, const std::string& place);
}  // namespace vrpn

struct VrpnOptions {
  std::string host;
  int port = vrpn::usual_port;
  std::string tracker;  // as the server names it; empty: the only one that reports
  int sensor = 0;
  double timeout_s = 3.0;
  double rate_Hz = 0.0;  // where the user states it
};
// "name" or "name:sensor".
VrpnOptions vrpn_options(const std::string& host, const std::string& body);

// Throws DeviceError: absent, failed (another version, no such tracker: the message lists those that there are).
std::unique_ptr<PoseSource> open_vrpn(const VrpnOptions& options);

extern const KnownDevice vrpn_device;

}  // namespace touchstone::hil
