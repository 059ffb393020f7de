#include "drivers/qualisys.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <pugixml.hpp>
#include <utility>

#include "drivers/byte_reader.h"
#include "drivers/record_count.h"
#include "drivers/tcp_line.h"

namespace touchstone::hil {

namespace qtm {
namespace {

constexpr std::size_t packet_header_bytes = 8;
// A thousand bodies in a frame are 52 kB, their parameters a megabyte or two.
constexpr std::uint32_t longest_packet = 1U << 22U;
constexpr std::uint32_t bodies_with_residuals = 11;
constexpr std::size_t body_bytes = 13 * sizeof(float);
constexpr double mm = 1e-3;
// Of a rotation in single precision.
constexpr double most_off_rotation = 1e-3;
constexpr double largest_space_m = 1000.0;

Body read_body(ByteReader& reader) {
  Body body;
  Vec3 p_m;
  for (int k = 0; k < 3; ++k) p_m[k] = mm * reader.little<float>();
  Mat3 rotation;
  for (int column = 0; column < 3; ++column) {
    for (int row = 0; row < 3; ++row) rotation(row, column) = reader.little<float>();
  }
  body.residual_m = mm * reader.little<float>();
  const bool turns = (rotation * rotation.transpose() - Mat3::Identity()).cwiseAbs().maxCoeff() < most_off_rotation &&
                     rotation.determinant() > 0.0;
  if (!turns || !(p_m.norm() < largest_space_m)) return body;
  body.p_W_m = p_m;
  body.q_WB = Quat(rotation).normalized();
  body.tracked = true;
  return body;
}

}  // namespace

std::string Packet::text() const { return {content.begin(), std::find(content.begin(), content.end(), '\0')}; }

std::string command(const std::string& text) {
  const auto size = static_cast<std::uint32_t>(packet_header_bytes + text.size() + 1);
  std::string bytes;
  for (const std::uint32_t field : {size, static_cast<std::uint32_t>(Type::command)}) {
    for (unsigned shift = 0; shift < 32; shift += 8) bytes += static_cast<char>(field >> shift);
  }
  return bytes + text + '\0';
}

std::optional<Packet> parse(std::span<const unsigned char> bytes, const std::string& place) {
  if (bytes.size() < packet_header_bytes) return std::nullopt;
  ByteReader reader(bytes);
  const auto size = reader.little<std::uint32_t>();
  if (size < packet_header_bytes || size > longest_packet)
    throw DeviceError(
        DeviceStatus::failed, fmt::format("{}: a packet of {} bytes: this is no QTM", place, size),
        fmt::format("give the little-endian port of its real-time output, {} if its base port is as usual",
                    usual_port));
  if (bytes.size() < size) return std::nullopt;
  return Packet{static_cast<Type>(reader.little<std::uint32_t>()),
                bytes.subspan(packet_header_bytes, size - packet_header_bytes), size};
}

bool parse_frame(std::span<const unsigned char> content, Frame& frame) {
  ByteReader reader(content);
  frame.time_us = reader.little<std::int64_t>();
  frame.number = reader.little<std::uint32_t>();
  const auto components = reader.little<std::uint32_t>();
  frame.bodies.clear();
  for (std::uint32_t i = 0; i < components && reader.good(); ++i) {
    const auto size = reader.little<std::uint32_t>();
    if (size < packet_header_bytes) return false;
    if (reader.little<std::uint32_t>() != bodies_with_residuals) {
      reader.skip(size - packet_header_bytes);
      continue;
    }
    const auto bodies = reader.little<std::uint32_t>();
    reader.skip(4);
    if (!reader.good() || bodies > reader.left() / body_bytes) return false;
    for (std::uint32_t k = 0; k < bodies; ++k) frame.bodies.push_back(read_body(reader));
    return true;
  }
  return false;
}

std::optional<std::vector<std::string>> parse_names(const std::string& xml) {
  pugi::xml_document document;
  if (!document.load_buffer(xml.data(), xml.size())) return std::nullopt;
  const auto bodies = document.document_element().child("The_6D");
  if (!bodies) return std::nullopt;
  std::vector<std::string> names;
  for (const auto& body : bodies.children("Body")) names.emplace_back(body.child("Name").text().get());
  return names;
}

}  // namespace qtm

namespace {

constexpr double qtm_ticks_per_s = 1e6;
constexpr std::uint32_t no_residual = std::numeric_limits<std::uint32_t>::max();

std::uint32_t micrometres(double residual_m) {
  const double um = std::round(1e6 * residual_m);
  return um >= 0.0 && um < no_residual ? static_cast<std::uint32_t>(um) : no_residual;
}

class QualisysSource final : public PoseSource {
 public:
  explicit QualisysSource(const QualisysOptions& options)
      : options_(options),
        line_(fmt::format("QTM at {}:{}", options.host, options.port), options.host, options.port, options.timeout_s) {
    // It greets first, or says that it serves too many.
    wait_for(qtm::Type::command, "its greeting");
    const std::string version = ask("Version 1.8", qtm::Type::command);
    if (version != "Version set to 1.8")
      throw DeviceError(DeviceStatus::failed,
                        fmt::format("{}: it answers \"{}\" to \"Version 1.8\"", line_.place(), version));
    const std::string application = ask("QTMVersion", qtm::Type::command);
    choose_body(qtm::parse_names(ask("GetParameters 6D", qtm::Type::xml)));
    identity_ = {std::string(qualisys_device.id), name_, application + ", protocol 1.8", "", line_.emulated()};
  }
  ~QualisysSource() override { stop(); }
  QualisysSource(const QualisysSource&) = delete;
  QualisysSource& operator=(const QualisysSource&) = delete;

  [[nodiscard]] const DeviceIdentity& identity() const override { return identity_; }
  [[nodiscard]] double nominal_rate_Hz() const override { return options_.rate_Hz; }
  [[nodiscard]] double ticks_per_s() const override { return qtm_ticks_per_s; }

  void start() override {
    stop();
    // What still comes is of before.
    const double until_s = clock_.now_s() + options_.timeout_s;
    while (clock_.now_s() < until_s && fill(0.0)) {
      while (next()) {
      }
    }
    counters_ = {};
    count_ = {};
    steps_ = {};
    stamps_.restart();
    line_.write(qtm::command("StreamFrames AllFrames 6DRes"));
    running_ = true;
  }
  void stop() noexcept override {
    if (!running_) return;
    running_ = false;
    try {
      line_.write(qtm::command("StreamFrames Stop"));
    } catch (const DeviceError&) {
      // It is gone.
    }
  }

  std::size_t read(std::span<PoseSample> out, double deadline_s) override {
    if (out.empty()) return 0;
    for (;;) {
      std::size_t filled = 0;
      while (filled < out.size()) {
        const auto packet = next();
        if (!packet) break;
        if (take(*packet, out[filled])) ++filled;
      }
      if (filled > 0 || !fill(deadline_s)) return filled;
    }
  }

  [[nodiscard]] StreamCounters counters() const override { return counters_; }

 private:
  bool fill(double deadline_s) {
    held_.erase(held_.begin(), held_.begin() + static_cast<std::ptrdiff_t>(std::exchange(done_, 0)));
    unsigned char bytes[65536];
    const std::size_t n = line_.read(bytes, deadline_s, arrived_s_);
    held_.insert(held_.end(), bytes, bytes + n);
    return n > 0;
  }

  // Good until the next fill().
  std::optional<qtm::Packet> next() {
    const auto packet = qtm::parse(std::span<const unsigned char>(held_).subspan(done_), line_.place());
    if (packet) done_ += packet->bytes;
    return packet;
  }

  // The text of the next packet of this type; throws for an error, or none in time.
  std::string wait_for(qtm::Type type, const std::string& what) {
    const double until_s = clock_.now_s() + options_.timeout_s;
    do {
      while (const auto packet = next()) {
        if (packet->type == qtm::Type::error) throw says_error(packet->text(), what);
        if (packet->type == type) return packet->text();
      }
    } while (clock_.now_s() < until_s && fill(until_s));
    throw DeviceError(DeviceStatus::timed_out,
                      fmt::format("{}: it takes the connection, and {} did not come within {} s", line_.place(), what,
                                  options_.timeout_s),
                      "is it QTM's real-time output that listens there?");
  }

  std::string ask(const std::string& text, qtm::Type type) {
    line_.write(qtm::command(text));
    return wait_for(type, "the answer to \"" + text + "\"");
  }

  [[nodiscard]] DeviceError says_error(const std::string& text, const std::string& what) const {
    const bool full = text.find("Max number of clients") != std::string::npos;
    return {full ? DeviceStatus::busy : DeviceStatus::failed,
            fmt::format("{}: it says \"{}\" in the place of {}", line_.place(), text, what),
            full ? "end another program that reads from it" : "are its cameras on, and is 6DOF tracked in real time?"};
  }

  void choose_body(const std::optional<std::vector<std::string>>& names) {
    if (!names)
      throw DeviceError(DeviceStatus::failed, fmt::format("{}: its list of bodies cannot be read", line_.place()));
    bodies_ = names->size();
    std::string all;
    for (std::size_t i = 0; i < names->size(); ++i) {
      const std::string& name = (*names)[i];
      all += (all.empty() ? "" : ", ") + fmt::format("\"{}\"", name);
      if (options_.body.empty() ? names->size() > 1 : name != options_.body) continue;
      body_ = i;
      name_ = name;
      return;
    }
    throw DeviceError(
        DeviceStatus::failed,
        fmt::format("{}: {}; it has {}", line_.place(),
                    options_.body.empty() ? "which rigid body is to be recorded is not said"
                                          : "there is no rigid body \"" + options_.body + "\"",
                    all.empty() ? "none" : all),
        all.empty() ? "make a rigid body of the markers in QTM" : "name one of them as \"body\" in the hardware map");
  }

  // Whether the packet was a new frame.
  bool take(const qtm::Packet& packet, PoseSample& sample) {
    if (packet.type == qtm::Type::error) throw says_error(packet.text(), "frames");
    if (packet.type == qtm::Type::no_more_data)
      throw DeviceError(DeviceStatus::failed, fmt::format("{}: it says that no measurement runs", line_.place()),
                        "start one in QTM (File, New), or play a file with real-time output");
    if (packet.type != qtm::Type::data) return false;
    if (!qtm::parse_frame(packet.content, frame_)) {
      ++counters_.malformed;
      return false;
    }
    if (frame_.bodies.size() != bodies_)
      throw DeviceError(DeviceStatus::failed,
                        fmt::format("{}: a frame has {} bodies, and QTM named {}: which is which is not known",
                                    line_.place(), frame_.bodies.size(), bodies_),
                        "leave QTM's rigid bodies as they are while you record, all of them enabled");
    if (count_.started() && frame_.number == last_number_) {
      ++counters_.repeated;
      return false;
    }
    if (count_.started() && frame_.number < last_number_)
      throw DeviceError(
          DeviceStatus::failed,
          fmt::format("{}: its frame numbers began again, {} after {}", line_.place(), frame_.number, last_number_),
          "was a measurement started, or does QTM play a file in a loop? Record each run by itself");
    sample = {};
    sample.flags |= count_.take(count_.started() ? steps_.ahead(frame_.number - last_number_) : 1, counters_);
    last_number_ = frame_.number;
    sample.sequence = count_.sequence();
    sample.t_s = arrived_s_;
    sample.ticks = stamps_.on_axis(frame_.time_us, arrived_s_, counters_);
    const qtm::Body& body = frame_.bodies[body_];
    sample.p_W_m = body.p_W_m;
    sample.q_WB = body.q_WB;
    sample.device_status = micrometres(body.residual_m);
    if (!body.tracked) sample.flags |= recording::sample_not_tracked;
    return true;
  }

  QualisysOptions options_;
  TcpLine line_;
  MonotonicClock clock_;
  std::vector<unsigned char> held_;
  std::size_t done_ = 0;  // of what is held
  double arrived_s_ = 0.0;
  std::string name_;
  std::size_t body_ = 0, bodies_ = 0;
  DeviceIdentity identity_;
  StreamCounters counters_;
  RecordCount count_;
  CountedSteps steps_;
  DeviceStamps stamps_{qtm_ticks_per_s};
  qtm::Frame frame_;
  std::uint32_t last_number_ = 0;
  bool running_ = false;
};

QualisysOptions mapped_qualisys(const MappedDevice& device) {
  QualisysOptions options;
  options.host = device.address;
  if (device.port != 0) options.port = device.port;
  options.body = device.body;
  options.rate_Hz = device.rate_Hz;
  return options;
}

}  // namespace

std::unique_ptr<PoseSource> open_qualisys(const QualisysOptions& options) {
  return std::make_unique<QualisysSource>(options);
}

constexpr KnownDevice qualisys_device{
    .id = "qualisys",
    .name = "Qualisys cameras, by QTM's real-time protocol",
    .role = DeviceRole::tracker,
    .bus = Bus::network,
    .source = "Qualisys' protocol documentation 1.20; ViSP's client",
    .confidence = Confidence::confirmed,
    .note = "looked for at the address in the hardware map only",
    .address_example = "192.168.1.10",
    .usual_port = qtm::usual_port,
    .open_poses = [](const MappedDevice& device) -> std::unique_ptr<PoseSource> {
      return open_qualisys(mapped_qualisys(device));
    },
    .look = [](const MappedDevice& device, double timeout_s) -> DeviceSeen {
      QualisysOptions options = mapped_qualisys(device);
      options.timeout_s = timeout_s;
      const auto tracker = open_qualisys(options);
      return {tracker->identity().serial, fmt::format("{} at {}", tracker->identity().firmware, device.address)};
    }};

}  // namespace touchstone::hil
