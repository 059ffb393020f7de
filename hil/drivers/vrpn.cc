#include "drivers/vrpn.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>

#include "drivers/byte_reader.h"
#include "drivers/record_count.h"
#include "drivers/tcp_line.h"
#include "harness/base/error.h"

namespace touchstone::hil {

namespace vrpn {

namespace {
constexpr std::size_t align = 8;
// vrpn_CONNECTION_TCP_BUFLEN is 64000; nothing longer is sent.
constexpr std::uint32_t longest = 1U << 17U;
constexpr std::size_t padded(std::size_t bytes) { return (bytes + align - 1) / align * align; }
constexpr char magic[] = "vrpn: ver. 07.38";
// Up to the minor version.
constexpr std::size_t magic_major = 14;
}  // namespace

std::string cookie() {
  std::string text = std::string(magic) + "  0";
  text.resize(cookie_bytes, '\0');
  return text;
}

bool cookie_agrees(std::span<const unsigned char> bytes) {
  return bytes.size() >= magic_major && std::equal(magic, magic + magic_major, bytes.begin());
}

std::optional<Message> parse(std::span<const unsigned char> bytes, const std::string& place) {
  if (bytes.size() < header_bytes) return std::nullopt;
  ByteReader reader(bytes);
  const auto length = reader.big<std::uint32_t>();
  if (length < header_bytes || length > longest)
    throw DeviceError(DeviceStatus::failed,
                      fmt::format("{}: a message of {} bytes: this is no VRPN stream", place, length),
                      "give the address and the port of a VRPN server");
  Message m;
  m.seconds = reader.big<std::uint32_t>();
  m.microseconds = reader.big<std::uint32_t>();
  m.time_s = static_cast<double>(m.seconds) + 1e-6 * static_cast<double>(m.microseconds);
  m.sender = reader.big<std::int32_t>();
  m.type = reader.big<std::int32_t>();
  m.bytes = header_bytes + padded(length - header_bytes);
  if (bytes.size() < m.bytes) return std::nullopt;
  m.payload = bytes.subspan(header_bytes, length - header_bytes);
  return m;
}

}  // namespace vrpn

namespace {

constexpr std::int32_t describes_sender = -1, describes_type = -2;
constexpr char position_type[] = "vrpn_Tracker Pos_Quat";
constexpr char control_sender[] = "VRPN Control";
constexpr double vrpn_ticks_per_s = 1e6;
// Of a unit quaternion that went through single precision or four digits of text.
constexpr double most_off_unit = 0.01;
constexpr double largest_room_m = 1000.0;
// For all trackers of a server to have reported, where the user named none.
constexpr double look_round_s = 0.5;

class VrpnSource final : public PoseSource {
 public:
  explicit VrpnSource(const VrpnOptions& options)
      : options_(options),
        line_(fmt::format("VRPN at {}:{}", options.host, options.port), options.host, options.port, options.timeout_s) {
    greet();
    find_tracker();
    identity_ = {std::string(vrpn_device.id), fmt::format("{}:{}", tracker_, options_.sensor), "VRPN " + version_, "",
                 line_.emulated()};
  }

  [[nodiscard]] const DeviceIdentity& identity() const override { return identity_; }
  [[nodiscard]] double nominal_rate_Hz() const override { return options_.rate_Hz; }
  [[nodiscard]] double ticks_per_s() const override { return vrpn_ticks_per_s; }
  [[nodiscard]] bool numbers_frames() const override { return false; }

  void start() override {
    counters_ = {};
    sequence_ = 0;
    stamps_.restart();
    // Poses that wait are of before; what is described among them is not said again.
    while (fill(0.0)) each([this](const vrpn::Message& m) { learn(m); });
  }
  void stop() noexcept override {}

  std::size_t read(std::span<PoseSample> out, double deadline_s) override {
    for (;;) {
      std::size_t filled = 0;
      std::size_t at = 0;
      while (filled < out.size()) {
        const auto message = vrpn::parse(std::span<const unsigned char>(held_).subspan(at), line_.place());
        if (!message) break;
        at += message->bytes;
        learn(*message);
        if (const auto sample = sample_of(*message)) out[filled++] = *sample;
      }
      held_.erase(held_.begin(), held_.begin() + static_cast<std::ptrdiff_t>(at));
      if (filled > 0 || !fill(deadline_s)) return filled;
    }
  }

  [[nodiscard]] StreamCounters counters() const override { return counters_; }

 private:
  void greet() {
    line_.write(vrpn::cookie());
    const double until = clock_.now_s() + options_.timeout_s;
    while (held_.size() < vrpn::cookie_bytes && fill(until)) {
    }
    if (held_.size() < vrpn::cookie_bytes || !vrpn::cookie_agrees(held_)) {
      throw DeviceError(DeviceStatus::failed,
                        fmt::format("{}: {}", line_.place(),
                                    held_.size() < vrpn::cookie_bytes
                                        ? "it accepts the connection and does not greet as a VRPN server does"
                                        : "it is no VRPN server of version 07"));
    }
    version_.assign(held_.begin() + 11, held_.begin() + 16);
    held_.erase(held_.begin(), held_.begin() + vrpn::cookie_bytes);
  }

  void learn(const vrpn::Message& m) {
    if (m.type != describes_sender && m.type != describes_type) return;
    ByteReader reader(m.payload);
    reader.skip(4);
    // In these messages the field of the sender holds what is described.
    (m.type == describes_sender ? senders_ : types_)[m.sender] = reader.text();
  }

  [[nodiscard]] bool is_position(const vrpn::Message& m) const {
    const auto type = types_.find(m.type);
    return type != types_.end() && type->second == position_type;
  }

  void find_tracker() {
    const double until = clock_.now_s() + options_.timeout_s;
    std::vector<std::string> reporting;
    double first_s = 0.0;
    while (clock_.now_s() < until) {
      if (!fill(std::min(until, clock_.now_s() + 0.05)) && reporting.empty()) continue;
      each([&](const vrpn::Message& m) {
        learn(m);
        if (!is_position(m)) return;
        const std::string& name = senders_[m.sender];
        if (std::find(reporting.begin(), reporting.end(), name) == reporting.end()) reporting.push_back(name);
        if (first_s == 0.0) first_s = clock_.now_s();
      });
      const bool named = std::find(reporting.begin(), reporting.end(), options_.tracker) != reporting.end();
      if (named || (options_.tracker.empty() && first_s > 0.0 && clock_.now_s() > first_s + look_round_s)) break;
      // A named tracker that the server has is taken also where it does not report yet.
      if (!options_.tracker.empty() && first_s > 0.0 && clock_.now_s() > first_s + look_round_s &&
          has(options_.tracker))
        break;
    }
    tracker_ = options_.tracker.empty() && reporting.size() == 1 ? reporting.front() : options_.tracker;
    if (!tracker_.empty() && has(tracker_)) return;
    std::string names;
    for (const auto& [id, name] : senders_) {
      if (name != control_sender) names += (names.empty() ? "" : ", ") + name;
    }
    throw DeviceError(
        DeviceStatus::failed,
        fmt::format("{}: {}; it has {}", line_.place(),
                    options_.tracker.empty() ? "which tracker is to be recorded is not said"
                                             : "it has no tracker \"" + options_.tracker + "\"",
                    names.empty() ? "none" : names),
        names.empty() ? "start a tracker in the server" : "name one of them as \"body\" in the hardware map");
  }

  [[nodiscard]] bool has(const std::string& tracker) const {
    return std::any_of(senders_.begin(), senders_.end(), [&](const auto& s) { return s.second == tracker; });
  }

  std::optional<PoseSample> sample_of(const vrpn::Message& m) {
    if (!is_position(m) || senders_[m.sender] != tracker_) return std::nullopt;
    ByteReader reader(m.payload);
    const auto sensor = reader.big<std::int32_t>();
    reader.skip(4);
    if (sensor != options_.sensor) return std::nullopt;
    PoseSample sample;
    for (int k = 0; k < 3; ++k) sample.p_W_m[k] = reader.big<double>();
    double q[4];
    for (double& v : q) v = reader.big<double>();  // x y z w
    sample.q_WB = Quat(q[3], q[0], q[1], q[2]);
    if (!reader.good() || !sample.p_W_m.allFinite() || !sample.q_WB.coeffs().allFinite()) {
      ++counters_.malformed;
      return std::nullopt;
    }
    // A server reports what its device gives; neither of these is a pose of a body in a room.
    if (std::abs(sample.q_WB.norm() - 1.0) > most_off_unit || sample.p_W_m.norm() > largest_room_m) {
      sample.flags |= recording::sample_not_tracked;
      sample.p_W_m.setZero();
      sample.q_WB.setIdentity();
    }
    const auto stamp = static_cast<std::int64_t>(std::uint64_t{m.seconds} * 1000000U + m.microseconds);
    if (stamps_.repeats(stamp)) {
      ++counters_.repeated;
      return std::nullopt;
    }
    sample.ticks = stamps_.on_axis(stamp, arrived_s_, counters_);
    sample.sequence = sequence_++;
    sample.t_s = arrived_s_;
    ++counters_.received;
    return sample;
  }

  template <class Visit>
  void each(Visit visit) {
    std::size_t at = 0;
    while (const auto message = vrpn::parse(std::span<const unsigned char>(held_).subspan(at), line_.place())) {
      at += message->bytes;
      visit(*message);
    }
    held_.erase(held_.begin(), held_.begin() + static_cast<std::ptrdiff_t>(at));
  }

  // What comes until the deadline; false where nothing did.
  bool fill(double deadline_s) {
    unsigned char bytes[65536];
    const std::size_t n = line_.read(bytes, deadline_s, arrived_s_);
    held_.insert(held_.end(), bytes, bytes + n);
    return n > 0;
  }

  VrpnOptions options_;
  TcpLine line_;
  MonotonicClock clock_;
  std::string version_, tracker_;
  std::map<std::int32_t, std::string> senders_, types_;
  std::vector<unsigned char> held_;
  DeviceIdentity identity_;
  StreamCounters counters_;
  std::uint64_t sequence_ = 0;
  DeviceStamps stamps_{vrpn_ticks_per_s};
  double arrived_s_ = 0.0;
};

}  // namespace

VrpnOptions vrpn_options(const std::string& host, const std::string& body) {
  VrpnOptions options;
  options.host = host;
  const auto colon = body.rfind(':');
  options.tracker = body.substr(0, colon);
  if (colon != std::string::npos) {
    const char* const end = body.data() + body.size();
    const auto [stop, error] = std::from_chars(body.data() + colon + 1, end, options.sensor);
    if (error != std::errc() || stop != end || options.sensor < 0) {
      throw UsageError(
          fmt::format("vrpn: \"body\" is \"{}\" in the hardware map; a tracker, or tracker:sensor with a whole number, "
                      "was expected",
                      body));
    }
  }
  return options;
}

std::unique_ptr<PoseSource> open_vrpn(const VrpnOptions& options) { return std::make_unique<VrpnSource>(options); }

namespace {

VrpnOptions mapped_vrpn(const MappedDevice& device) {
  VrpnOptions options = vrpn_options(device.address, device.body);
  if (device.port != 0) options.port = device.port;
  options.rate_Hz = device.rate_Hz;
  return options;
}

}  // namespace

constexpr KnownDevice vrpn_device{
    .id = "vrpn",
    .name = "A tracker behind a VRPN server (Vicon, Polhemus and others)",
    .role = DeviceRole::tracker,
    .bus = Bus::network,
    .source = "VRPN's sources",
    .confidence = Confidence::confirmed,
    .note = "looked for at the address in the hardware map only",
    .address_example = "192.168.1.10",
    .connected_when_named = true,
    .usual_port = vrpn::usual_port,
    .open_poses = [](const MappedDevice& device) -> std::unique_ptr<PoseSource> {
      return open_vrpn(mapped_vrpn(device));
    },
    .look = [](const MappedDevice& device, double timeout_s) -> DeviceSeen {
      VrpnOptions options = mapped_vrpn(device);
      options.timeout_s = timeout_s;
      const auto tracker = open_vrpn(options);
      return {tracker->identity().serial, fmt::format("{} at {}", tracker->identity().firmware, device.address)};
    }};

}  // namespace touchstone::hil
