#include <algorithm>
#include <cmath>

#include "drivers/byte_reader.h"
#include "drivers/natnet.h"

namespace touchstone::hil::natnet {
namespace {

constexpr std::size_t name_bytes = 256, header_bytes = 4;
constexpr std::size_t vector_bytes = 12, quaternion_bytes = 16;
// More of anything than this is a damaged packet.
constexpr std::uint32_t most = 10000;
// What ends a frame up to NatNet 4.0: timecode 2 x 4, timestamp 8, three stamps 8 each, parameters 2, an end mark 4.
constexpr std::size_t suffix_bytes = 46;
constexpr std::int16_t tracking_valid = 1;
// Of a rotation's length; that of four 32-bit numbers is off by some 1e-7.
constexpr double most_off_unit = 1e-3;
constexpr std::uint32_t kind_rigid_body = 1, kind_marker_set = 0;

// The payload, where the packet is the message.
std::optional<ByteReader> payload_of(std::span<const unsigned char> packet, Message message) {
  ByteReader reader(packet);
  const auto id = reader.little<std::uint16_t>(), bytes = reader.little<std::uint16_t>();
  if (!reader.good() || id != static_cast<std::uint16_t>(message) || reader.left() < bytes) return std::nullopt;
  return ByteReader(packet.subspan(header_bytes, bytes));
}

Version read_version(ByteReader& reader) {
  Version v;
  v.major = reader.little<std::uint8_t>();
  v.minor = reader.little<std::uint8_t>();
  reader.skip(2);  // build and revision
  return v;
}

// A section that is not needed: its count, and what it says or is known to hold.
void skip_section(ByteReader& reader) {
  reader.skip(4);
  reader.skip(reader.little<std::uint32_t>());
}

void skip_marker_sets(ByteReader& reader) {
  const auto sets = reader.little<std::uint32_t>();
  for (std::uint32_t i = 0; i < sets && i < most && reader.good(); ++i) {
    reader.text();
    reader.skip(vector_bytes * std::size_t{reader.little<std::uint32_t>()});
  }
}

Body read_body(ByteReader& reader) {
  Body body;
  body.id = static_cast<int>(reader.little<std::uint32_t>());
  for (int k = 0; k < 3; ++k) body.p_W_m[k] = reader.little<float>();
  double q[4];
  for (double& v : q) v = reader.little<float>();  // x y z w
  body.q_WB = Quat(q[3], q[0], q[1], q[2]);
  body.mean_error_m = reader.little<float>();
  body.tracked = (reader.little<std::int16_t>() & tracking_valid) != 0;
  // What is no pose is none: in a table it would spoil all others.
  if (!body.p_W_m.allFinite() || !(std::abs(body.q_WB.norm() - 1.0) < most_off_unit)) {
    body.p_W_m.setZero();
    body.q_WB.setIdentity();
    body.tracked = false;
  }
  return body;
}

}  // namespace

std::string connect_request() {
  std::string packet(header_bytes + name_bytes + 8, '\0');
  packet[2] = static_cast<char>((name_bytes + 8) & 0xff);
  packet[3] = static_cast<char>((name_bytes + 8) >> 8);
  const std::string ping = "Ping";
  std::copy(ping.begin(), ping.end(), packet.begin() + header_bytes);
  // Which versions this client understands; the captured request of OptiTrack's own client has 3 twice.
  packet[header_bytes + name_bytes] = 3;
  packet[header_bytes + name_bytes + 4] = 3;
  return packet;
}

std::string empty_message(Message message) {
  std::string packet(header_bytes, '\0');
  packet[0] = static_cast<char>(message);
  return packet;
}

std::optional<ServerInfo> parse_server_info(std::span<const unsigned char> packet) {
  auto reader = payload_of(packet, Message::server_info);
  if (!reader) return std::nullopt;
  ServerInfo info;
  info.application = reader->text();
  if (reader->at() > name_bytes) return std::nullopt;
  reader->skip(name_bytes - reader->at());
  info.application_version = read_version(*reader);
  info.natnet_version = read_version(*reader);
  if (!reader->good()) return std::nullopt;
  if (info.natnet_version.major >= 3) {
    info.ticks_per_s = static_cast<double>(reader->little<std::uint64_t>());
    info.data_port = reader->little<std::uint16_t>();
    info.multicast = reader->little<std::uint8_t>() != 0;
    for (auto& byte : info.group) byte = reader->little<std::uint8_t>();
    if (!reader->good()) return std::nullopt;
  }
  return info;
}

bool parse_frame(std::span<const unsigned char> packet, const Version& version, Frame& frame) {
  auto payload = payload_of(packet, Message::frame);
  if (!payload) return false;
  ByteReader& reader = *payload;
  const std::size_t total = reader.left();
  frame.bodies.clear();
  frame.number = reader.little<std::uint32_t>();
  const bool sized = version.states_sizes();
  if (sized) {
    skip_section(reader);  // marker sets
    skip_section(reader);  // markers of older clients
  } else {
    skip_marker_sets(reader);
    reader.skip(vector_bytes * std::size_t{reader.little<std::uint32_t>()});
  }
  const auto bodies = reader.little<std::uint32_t>();
  if (sized) reader.skip(4);
  if (bodies > most) return false;
  for (std::uint32_t i = 0; i < bodies && reader.good(); ++i) frame.bodies.push_back(read_body(reader));
  if (sized) {
    // Skeletons, assets, labelled markers, force plates, devices.
    for (int section = 0; section < 5; ++section) skip_section(reader);
  } else {
    if (total < suffix_bytes || reader.at() > total - suffix_bytes) return false;
    reader.skip(total - suffix_bytes - reader.at());
  }
  reader.skip(4 + 4 + 8);  // timecode, its part, time since Motive began
  frame.exposure_ticks = reader.little<std::uint64_t>();
  reader.skip(8);  // when the computer had the cameras' data
  frame.sent_ticks = reader.little<std::uint64_t>();
  return reader.good();
}

std::optional<std::vector<std::pair<std::string, int>>> parse_descriptions(std::span<const unsigned char> packet,
                                                                           const Version& version) {
  auto reader = payload_of(packet, Message::descriptions);
  if (!reader) return std::nullopt;
  std::vector<std::pair<std::string, int>> bodies;
  const auto count = reader->little<std::uint32_t>();
  for (std::uint32_t i = 0; i < count && i < most && reader->good(); ++i) {
    const auto kind = reader->little<std::uint32_t>();
    const std::size_t bytes = version.states_sizes() ? reader->little<std::uint32_t>() : 0;
    const std::size_t began = reader->at();
    if (kind == kind_rigid_body) {
      auto name = reader->text();
      bodies.emplace_back(std::move(name), reader->little<std::int32_t>());
    }
    if (version.states_sizes()) {
      if (reader->at() > began + bytes) return std::nullopt;
      reader->skip(began + bytes - reader->at());
    } else if (kind == kind_rigid_body) {
      reader->skip(4 + vector_bytes);  // parent, offset
      const std::size_t markers = reader->little<std::uint32_t>();
      reader->skip(markers * (vector_bytes + 4));
      // From 4.0 on each marker has a name.
      for (std::size_t m = 0; version.major >= 4 && m < markers && reader->good(); ++m) reader->text();
    } else if (kind == kind_marker_set) {
      reader->text();
      const auto markers = reader->little<std::uint32_t>();
      for (std::uint32_t m = 0; m < markers && reader->good(); ++m) reader->text();
    } else {
      break;  // skeletons and devices come last and are not needed
    }
  }
  if (!reader->good()) return std::nullopt;
  return bodies;
}

}  // namespace touchstone::hil::natnet
