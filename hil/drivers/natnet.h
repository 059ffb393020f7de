// OptiTrack's Motive over NatNet: commands by UDP to port 1510, frames by UDP to a multicast group or to this client.
//
//   message: id u16, payload bytes u16, payload; little-endian
//
//   0 connect ("Ping" in 256 bytes, two versions) -> 1 server information
//
//   1 server information: name 256 bytes, its version, NatNet's version, ticks per second u64, data port u16,
//     multicast u8, group 4 bytes
//
//   4 request of descriptions -> 5 descriptions; 7 frame; 10 keep-alive
//
// Sources: the layouts in mje-nz/python_natnet (commit dcb6fd0a), which were verified against packets of Motive 2.1 and
// OptiTrack's SampleClient; from NatNet 4.1 on, OptiTrack's Python client in its SDK (each section states its bytes).
// Lengths in metres, in Motive's world (y or z up, as Motive is set); orientations x y z w.
//   Times are those of the camera's exposure by Motive's own clock, so that neither its latency nor the network's is in
// them. Motive before 2.0 (NatNet 2) does not send them and is refused.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "devices/interfaces.h"
#include "devices/known_device.h"

namespace touchstone::hil {

namespace natnet {

inline constexpr int command_port = 1510;
enum class Message : std::uint16_t {
  connect = 0,
  server_info = 1,
  request_descriptions = 4,
  descriptions = 5,
  frame = 7,
  keep_alive = 10
};

struct Version {
  int major = 0, minor = 0;
  // From 4.1 on each section of a frame states its length.
  [[nodiscard]] bool states_sizes() const { return major > 4 || (major == 4 && minor >= 1); }
};

struct ServerInfo {
  std::string application;
  Version application_version, natnet_version;
  double ticks_per_s = 0.0;
  int data_port = 0;
  bool multicast = false;
  std::array<unsigned char, 4> group{};
};

// A body whose pose holds a number that is none, or no rotation, is not tracked and at the origin.
struct Body {
  int id = 0;
  Vec3 p_W_m = Vec3::Zero();
  Quat q_WB = Quat::Identity();
  double mean_error_m = 0.0;
  bool tracked = false;
};

struct Frame {
  std::uint32_t number = 0;
  std::vector<Body> bodies;
  std::uint64_t exposure_ticks = 0, sent_ticks = 0;
};

std::string connect_request();
std::string empty_message(Message message);
// Nothing where the packet is no such message or is cut short.
std::optional<ServerInfo> parse_server_info(std::span<const unsigned char> packet);
// Allocates for the first frame only, where `frame` is reused. False as above.
bool parse_frame(std::span<const unsigned char> packet, const Version& version, Frame& frame);
// Name and number of each rigid body.
std::optional<std::vector<std::pair<std::string, int>>> parse_descriptions(std::span<const unsigned char> packet,
                                                                           const Version& version);

}  // namespace natnet

struct NatNetOptions {
  std::string host;
  int command_port = natnet::command_port;
  std::string body;        // name in Motive, or its streaming number; empty: the only one
  double timeout_s = 3.0;  // for the server's answers
  double rate_Hz = 0.0;    // frames per second of the cameras, where the user states it (NatNet does not say)
};

// Throws DeviceError: absent, failed (the body is not there: the message lists those that are).
std::unique_ptr<PoseSource> open_natnet(const NatNetOptions& options);

extern const KnownDevice natnet_device;

}  // namespace touchstone::hil
