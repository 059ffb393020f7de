#include "fuzz/read_structured_packets.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "devices/interfaces.h"
#include "drivers/bota.h"
#include "drivers/leptrino.h"
#include "drivers/natnet.h"
#include "drivers/ndi.h"
#include "drivers/netft.h"
#include "drivers/qualisys.h"
#include "drivers/vrpn.h"
#include "emulators/natnet_emulator.h"
#include "emulators/netft_answers.h"
#include "emulators/vrpn_answers.h"
#include "harness/base/error.h"
#include "harness/testing/choices.h"

namespace touchstone::hil::fuzz {
namespace {

std::span<const unsigned char> bytes_of(const std::string& packet) {
  return {reinterpret_cast<const unsigned char*>(packet.data()), packet.size()};
}

std::string frame_packet(bool sized) {
  EmulatedFrame frame;
  frame.number = 7;
  frame.p[2] = 1.5F;
  frame.markers.resize(3);
  return natnet_frame_packet(frame, sized);
}

bool reads_natnet(const std::string& packet, bool sized) {
  natnet::Frame frame;
  const natnet::Version version = sized ? natnet::Version{4, 1} : natnet::Version{3, 0};
  (void)natnet::parse_server_info(bytes_of(packet));
  (void)natnet::parse_descriptions(bytes_of(packet), version);
  if (!natnet::parse_frame(bytes_of(packet), version, frame)) return false;
  for (const natnet::Body& body : frame.bodies) {
    if (!body.p_W_m.allFinite() || !body.q_WB.coeffs().allFinite()) std::abort();
  }
  return true;
}

// Message by message, as the driver reads a stream.
bool reads_vrpn(const std::string& stream) {
  std::span<const unsigned char> rest = bytes_of(stream);
  std::size_t messages = 0;
  while (const auto message = vrpn::parse(rest, "fuzz")) {
    if (message->bytes == 0 || message->bytes > rest.size()) std::abort();
    const auto* const end = message->payload.data() + message->payload.size();
    if (!message->payload.empty() && (message->payload.data() < rest.data() || end > rest.data() + rest.size()))
      std::abort();
    rest = rest.subspan(message->bytes);
    ++messages;
  }
  return messages > 0;
}

bool reads_ndi(const std::string& answer) {
  const auto tools = ndi::parse_tx(answer);
  if (!tools) return false;
  for (const ndi::Tool& tool : *tools) {
    if (!tool.p_W_m.allFinite() || !tool.q_WB.coeffs().allFinite()) std::abort();
  }
  return !tools->empty();
}

bool reads_bota(std::string frame) {
  frame.resize(bota::frame_bytes);
  const auto bytes = bytes_of(frame);
  const auto read = bota::decode(std::span<const unsigned char, bota::frame_bytes>(bytes.data(), bota::frame_bytes));
  if (!read) return false;
  if (!read->wrench.f_N.allFinite() || !read->wrench.torque_Nm.allFinite()) std::abort();
  return true;
}

// Packet by packet, as the driver reads a stream.
bool reads_qualisys(const std::string& stream) {
  std::span<const unsigned char> rest = bytes_of(stream);
  bool whole = false;
  while (const auto packet = qtm::parse(rest, "fuzz")) {
    if (packet->bytes > rest.size() || packet->content.size() > packet->bytes) std::abort();
    rest = rest.subspan(packet->bytes);
    if (const auto names = qtm::parse_names(packet->text()); names && !names->empty()) whole = true;
    qtm::Frame frame;
    if (!qtm::parse_frame(packet->content, frame)) continue;
    whole = true;
    for (const qtm::Body& body : frame.bodies) {
      if (!body.p_W_m.allFinite() || !body.q_WB.coeffs().allFinite()) std::abort();
    }
  }
  return whole;
}

// A frame of one body at the origin, turned by nothing, by qualisys.h's layout.
std::string qualisys_frame() {
  std::string bytes;
  const auto put = [&](const auto value) {
    bytes.append(reinterpret_cast<const char*>(&value), sizeof value);  // this machine is little-endian
  };
  for (const std::uint32_t field : {92U, 3U, 1000U, 0U, 7U, 1U, 68U, 11U, 1U, 0U}) put(field);
  for (const float value : {0.0F, 0.0F, 0.0F, 1.0F, 0.0F, 0.0F, 0.0F, 1.0F, 0.0F, 0.0F, 0.0F, 1.0F, 0.25F}) put(value);
  return bytes;
}

// Piece by piece, as the driver reads a stream.
bool reads_leptrino(const std::string& stream) {
  std::span<const unsigned char> rest = bytes_of(stream);
  std::size_t samples = 0;
  for (auto next = leptrino::next_piece(rest); next.piece != leptrino::Piece::incomplete;
       next = leptrino::next_piece(rest)) {
    if (next.used == 0 || next.used > rest.size() || next.content.size() > leptrino::longest_content) std::abort();
    rest = rest.subspan(next.used);
    samples += leptrino::parse_sample(next.content) ? 1 : 0;
    (void)leptrino::parse_product(next.content);
    if (const auto rated = leptrino::parse_rated_values(next.content)) {
      for (const double value : *rated) {
        if (!(value > 0.0)) std::abort();
      }
    }
  }
  return samples > 0;
}

bool reads_netft(const std::string& xml) {
  const NetFtConfiguration configuration = parse_netft_configuration(xml, "fuzz");
  if (!(configuration.newtons_per_count > 0.0) || !std::isfinite(configuration.newtons_per_count)) std::abort();
  if (!(configuration.newton_metres_per_count > 0.0) || !std::isfinite(configuration.newton_metres_per_count))
    std::abort();
  return true;
}

// A frame of zeros with its header and its checksum, the only one that passes (bota.h has the layout's source).
std::string bota_frame() {
  std::string frame(bota::frame_bytes, '\0');
  frame[0] = static_cast<char>(bota::header);
  const std::uint16_t sum = bota::crc_x25(bytes_of(frame).subspan(1, bota::frame_bytes - 3));
  frame[bota::frame_bytes - 2] = static_cast<char>(sum & 0xff);
  frame[bota::frame_bytes - 1] = static_cast<char>(sum >> 8);
  return frame;
}

// A sample by leptrino.h's layout: 0x1010 along x, whose bytes are doubled, and 0x5f as the check.
constexpr char leptrino_sample[] =
    "\x10\x02\x14\xff\x32\x00\x10\x10\x10\x10\xff\xff\x00\x80\x01\x00\x02\x00\x03\x00\x00\x00\x05\x00\x10\x03\x5f";

struct Reader {
  std::string valid;
  std::function<bool(const std::string&)> reads;
};

const std::vector<Reader>& readers() {
  static const std::vector<Reader> all{
      {frame_packet(false), [](const std::string& p) { return reads_natnet(p, false); }},
      {frame_packet(true), [](const std::string& p) { return reads_natnet(p, true); }},
      {std::string(reinterpret_cast<const char*>(vrpn_report), sizeof vrpn_report), reads_vrpn},
      {"0201+09659+00000+02588+00000-012345+000100-150000+00750000000310000ABCD\n02MISSING000000310000ABCD\n0000",
       reads_ndi},
      {bota_frame(), reads_bota},
      {std::string(leptrino_sample, sizeof leptrino_sample - 1), reads_leptrino},
      {qualisys_frame(), reads_qualisys},
      {qtm::command("<QTM_Parameters_Ver_1.8><The_6D><Body><Name>Pen</Name></Body></The_6D></QTM_Parameters_Ver_1.8>"),
       reads_qualisys},
      {std::string(netft_gamma_answer), reads_netft},
      {std::string(netft_axia_answer), reads_netft},
  };
  return all;
}

bool read(const Reader& reader, const std::string& packet) {
  try {
    return reader.reads(packet);
  } catch (const BadData&) {
    return false;
  } catch (const DeviceError&) {
    return false;
  }
}

}  // namespace

std::size_t read_structured_packets(const std::uint8_t* data, std::size_t size) {
  if (size == 0)
    return static_cast<std::size_t>(std::ranges::count_if(readers(), [](const Reader& r) { return read(r, r.valid); }));
  testing::Choices choices({data, size});
  const Reader& reader = readers()[choices.below(readers().size())];
  return read(reader, choices.damaged(reader.valid)) ? 1 : 0;
}

}  // namespace touchstone::hil::fuzz
