#include "drivers/natnet.h"

#include <arpa/inet.h>
#include <fmt/format.h>
#include <netdb.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstring>
#include <optional>

#include "drivers/record_count.h"
#include "drivers/stamped_udp.h"

namespace touchstone::hil {
namespace {

using natnet::Message;

// A frame with many bodies and markers; UDP allows no more.
constexpr std::size_t largest_packet = 65536;
// Motive stops sending to a unicast client that it has not heard of for some seconds.
constexpr double keep_alive_s = 1.0;
// No network holds a frame back for so many: seconds at 240 Hz.
constexpr std::uint32_t most_reordered = 1000;

class Socket {
 public:
  Socket() : fd_(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0)) {
    if (fd_ >= 0) ask_for_stamps(fd_);
  }
  ~Socket() {
    if (fd_ >= 0) ::close(fd_);
  }
  Socket(const Socket&) = delete;
  Socket& operator=(const Socket&) = delete;
  [[nodiscard]] int fd() const noexcept { return fd_; }
  [[nodiscard]] StampedArrivals& arrivals() noexcept { return arrivals_; }

 private:
  int fd_;
  StampedArrivals arrivals_;
};

sockaddr_in address_of(const std::string& host, int port) {
  addrinfo hints{};
  hints.ai_family = AF_INET;
  hints.ai_socktype = SOCK_DGRAM;
  addrinfo* found = nullptr;
  if (::getaddrinfo(host.c_str(), std::to_string(port).c_str(), &hints, &found) != 0 || found == nullptr)
    throw DeviceError(DeviceStatus::absent, fmt::format("NatNet: the host {} is not known", host));
  sockaddr_in address{};
  std::memcpy(&address, found->ai_addr, sizeof address);
  ::freeaddrinfo(found);
  return address;
}

class NatNetSource final : public PoseSource {
 public:
  explicit NatNetSource(const NatNetOptions& options)
      : options_(options),
        place_(fmt::format("NatNet at {}:{}", options.host, options.command_port)),
        server_(address_of(options.host, options.command_port)),
        packet_(largest_packet) {
    const auto info = ask(natnet::connect_request(), &natnet::parse_server_info);
    if (!info) {
      throw DeviceError(DeviceStatus::absent, fmt::format("{}: no answer within {} s", place_, options_.timeout_s),
                        "is Motive streaming, and is this its address?");
    }
    info_ = *info;
    if (info_.natnet_version.major < 3 || !(info_.ticks_per_s > 0.0)) {
      throw DeviceError(DeviceStatus::failed,
                        fmt::format("{}: it speaks NatNet {}.{}, which does not say when its frames were taken", place_,
                                    info_.natnet_version.major, info_.natnet_version.minor),
                        "Motive 2.0 and later do");
    }
    choose_body();
    if (info_.multicast) join();
    sockaddr_storage address{};
    std::memcpy(&address, &server_, sizeof server_);
    identity_ = {std::string(natnet_device.id), body_name_,
                 fmt::format("{} {}.{}, NatNet {}.{}", info_.application, info_.application_version.major,
                             info_.application_version.minor, info_.natnet_version.major, info_.natnet_version.minor),
                 "", is_loopback(address)};
  }

  [[nodiscard]] const DeviceIdentity& identity() const override { return identity_; }
  [[nodiscard]] double nominal_rate_Hz() const override { return options_.rate_Hz; }
  [[nodiscard]] double ticks_per_s() const override { return info_.ticks_per_s; }

  void start() override {
    counters_ = {};
    started_ = false;
    stamps_.emplace(info_.ticks_per_s);
    for (Socket* socket : {&command_, &data_}) {
      while (::recv(socket->fd(), packet_.data(), packet_.size(), MSG_DONTWAIT) > 0) {
      }
    }
    if (!info_.multicast) send(natnet::connect_request());
    alive_s_ = clock_.now_s();
  }
  void stop() noexcept override {}

  std::size_t read(std::span<PoseSample> out, double deadline_s) override {
    for (;;) {
      std::size_t filled = 0;
      for (Socket* socket : {&data_, &command_}) {
        while (filled < out.size() && receive(*socket, out[filled], filled)) {
        }
      }
      if (!info_.multicast && clock_.now_s() > alive_s_ + keep_alive_s) {
        send(natnet::empty_message(Message::keep_alive));
        alive_s_ = clock_.now_s();
      }
      const double left = deadline_s - clock_.now_s();
      if (filled > 0 || left <= 0.0) return filled;
      pollfd ready[2] = {{data_.fd(), POLLIN, 0}, {command_.fd(), POLLIN, 0}};
      ::poll(ready, 2, static_cast<int>(std::ceil(std::min({left, keep_alive_s}) * 1e3)));
    }
  }

  [[nodiscard]] StreamCounters counters() const override { return counters_; }

 private:
  void send(const std::string& packet) {
    ::sendto(command_.fd(), packet.data(), packet.size(), MSG_NOSIGNAL, reinterpret_cast<const sockaddr*>(&server_),
             sizeof server_);
  }

  // The answer to a request, which is repeated: UDP may lose either.
  template <class Parse>
  auto ask(const std::string& request, Parse parse) -> decltype(parse(std::span<const unsigned char>())) {
    constexpr double repeat_s = 0.25;
    const double until = clock_.now_s() + options_.timeout_s;
    while (clock_.now_s() < until) {
      send(request);
      const double again = std::min(until, clock_.now_s() + repeat_s);
      while (clock_.now_s() < again) {
        pollfd ready{command_.fd(), POLLIN, 0};
        const double left = std::max(0.0, again - clock_.now_s());  // below 0 poll() would wait for ever
        if (::poll(&ready, 1, static_cast<int>(std::ceil(left * 1e3))) <= 0) continue;
        const auto n = ::recv(command_.fd(), packet_.data(), packet_.size(), MSG_DONTWAIT);
        if (n <= 0) break;  // nothing listens there, as the network says
        if (auto answer = parse(std::span<const unsigned char>(packet_.data(), static_cast<std::size_t>(n))))
          return answer;
      }
      clock_.sleep_until(again);
    }
    return {};
  }

  void choose_body() {
    const bool by_number = !options_.body.empty() && std::all_of(options_.body.begin(), options_.body.end(),
                                                                 [](char c) { return c >= '0' && c <= '9'; });
    if (by_number) {
      const char* const end = options_.body.data() + options_.body.size();
      if (std::from_chars(options_.body.data(), end, body_).ec != std::errc())
        throw DeviceError(DeviceStatus::failed, fmt::format("{}: there is no rigid body {}", place_, options_.body),
                          "name one of Motive's as \"body\"");
      body_name_ = options_.body;
      return;
    }
    const auto bodies =
        ask(natnet::empty_message(Message::request_descriptions),
            [&](std::span<const unsigned char> p) { return natnet::parse_descriptions(p, info_.natnet_version); });
    std::string names;
    for (const auto& [name, id] : bodies.value_or(std::vector<std::pair<std::string, int>>{})) {
      names += (names.empty() ? "" : ", ") + fmt::format("\"{}\" ({})", name, id);
      if (name == options_.body || (options_.body.empty() && bodies->size() == 1)) {
        body_ = id;
        body_name_ = name;
        return;
      }
    }
    throw DeviceError(DeviceStatus::failed,
                      fmt::format("{}: {}; it has {}", place_,
                                  options_.body.empty() ? std::string("which rigid body is to be recorded is not said")
                                                        : fmt::format("there is no rigid body \"{}\"", options_.body),
                                  names.empty() ? "none" : names),
                      names.empty() ? "make a rigid body of the markers in Motive"
                                    : "name one of them as \"body\" in the hardware map");
  }

  void join() {
    const int on = 1;
    ::setsockopt(data_.fd(), SOL_SOCKET, SO_REUSEADDR, &on, sizeof on);
    sockaddr_in any{};
    any.sin_family = AF_INET;
    any.sin_port = htons(static_cast<std::uint16_t>(info_.data_port));
    ip_mreq group{};
    std::memcpy(&group.imr_multiaddr, info_.group.data(), 4);
    // On the interface that leads to the server.
    sockaddr_in own{};
    socklen_t size = sizeof own;
    const Socket probe;
    if (::connect(probe.fd(), reinterpret_cast<const sockaddr*>(&server_), sizeof server_) == 0 &&
        ::getsockname(probe.fd(), reinterpret_cast<sockaddr*>(&own), &size) == 0)
      group.imr_interface = own.sin_addr;
    if (::bind(data_.fd(), reinterpret_cast<const sockaddr*>(&any), sizeof any) != 0 ||
        ::setsockopt(data_.fd(), IPPROTO_IP, IP_ADD_MEMBERSHIP, &group, sizeof group) != 0) {
      throw DeviceError(
          DeviceStatus::failed,
          fmt::format("{}: the frames' group {}.{}.{}.{} port {} cannot be joined: {}", place_, info_.group[0],
                      info_.group[1], info_.group[2], info_.group[3], info_.data_port, std::strerror(errno)));
    }
  }

  // True while there may be more. `filled` grows if the packet was a frame with the body.
  bool receive(Socket& socket, PoseSample& sample, std::size_t& filled) {
    double t_s = 0.0;
    sockaddr_storage from{};
    const long n = receive_stamped(socket.fd(), socket.arrivals(), packet_, t_s, &from);
    if (n < 0) return errno == EINTR || errno == ECONNREFUSED;
    sockaddr_in sender{};
    std::memcpy(&sender, &from, sizeof sender);
    // Another Motive in the same group, or this one by a second network card.
    if (sender.sin_addr.s_addr != server_.sin_addr.s_addr) {
      ++counters_.foreign_packets;
      return true;
    }
    const std::span<const unsigned char> packet(packet_.data(), static_cast<std::size_t>(n));
    if (!natnet::parse_frame(packet, info_.natnet_version, frame_)) {
      // Answers to the keep-alive and to connecting come on the same socket.
      if (n >= 2 && packet[0] == static_cast<unsigned char>(Message::frame) && packet[1] == 0) ++counters_.malformed;
      return true;
    }
    if (started_ && frame_.number + most_reordered < last_number_) {
      throw DeviceError(
          DeviceStatus::failed,
          fmt::format("{}: its frame numbers began again, {} after {}", place_, frame_.number, last_number_),
          "was Motive restarted, or does it play a take in a loop? Record each run by itself");
    }
    if (started_ && frame_.number <= last_number_) {
      const bool again = frame_.number == last_number_;
      ++(again ? counters_.repeated : counters_.reordered);
      if (!again && counters_.lost > 0) --counters_.lost;
      return true;
    }
    sample = {};
    sample.flags = recording::sample_not_tracked;
    const auto body =
        std::find_if(frame_.bodies.begin(), frame_.bodies.end(), [&](const natnet::Body& b) { return b.id == body_; });
    if (body != frame_.bodies.end()) {
      sample.p_W_m = body->p_W_m;
      sample.q_WB = body->q_WB;
      if (body->tracked) sample.flags = recording::sample_ok;
    }
    if (started_ && frame_.number != last_number_ + 1) {
      counters_.lost += frame_.number - last_number_ - 1;
      sample.flags |= recording::sample_after_gap;
    }
    started_ = true;
    last_number_ = frame_.number;
    sample.t_s = t_s;
    sample.sequence = frame_.number;
    sample.ticks = stamps_->on_axis(static_cast<std::int64_t>(frame_.exposure_ticks), t_s, counters_);
    ++counters_.received;
    ++filled;
    return true;
  }

  NatNetOptions options_;
  std::string place_;
  sockaddr_in server_;
  Socket command_, data_;
  std::vector<unsigned char> packet_;
  natnet::ServerInfo info_;
  natnet::Frame frame_;
  int body_ = 0;
  std::string body_name_;
  DeviceIdentity identity_;
  MonotonicClock clock_;
  StreamCounters counters_;
  std::optional<DeviceStamps> stamps_;
  bool started_ = false;
  std::uint32_t last_number_ = 0;
  double alive_s_ = 0.0;
};

}  // namespace

std::unique_ptr<PoseSource> open_natnet(const NatNetOptions& options) {
  return std::make_unique<NatNetSource>(options);
}

namespace {

NatNetOptions mapped_natnet(const MappedDevice& device) {
  NatNetOptions options;
  options.host = device.address;
  if (device.port != 0) options.command_port = device.port;
  options.body = device.body;
  options.rate_Hz = device.rate_Hz;
  return options;
}

}  // namespace

constexpr KnownDevice natnet_device{
    .id = "optitrack",
    .name = "OptiTrack cameras, by Motive's NatNet stream",
    .role = DeviceRole::tracker,
    .bus = Bus::network,
    .source = "python_natnet and its captured packets; OptiTrack's SDK",
    .confidence = Confidence::confirmed,
    .note = "looked for at the address in the hardware map only",
    .address_example = "192.168.1.10",
    .connected_when_named = true,
    .usual_port = natnet::command_port,
    .open_poses = [](const MappedDevice& device) -> std::unique_ptr<PoseSource> {
      return open_natnet(mapped_natnet(device));
    },
    .look = [](const MappedDevice& device, double timeout_s) -> DeviceSeen {
      NatNetOptions options = mapped_natnet(device);
      options.timeout_s = timeout_s;
      const auto tracker = open_natnet(options);
      return {tracker->identity().serial, fmt::format("{} at {}", tracker->identity().firmware, device.address)};
    }};

}  // namespace touchstone::hil
