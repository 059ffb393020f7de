#include "drivers/rdt_source.h"

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
#include <cmath>
#include <cstring>

#include "drivers/stamped_udp.h"

namespace touchstone::hil {
namespace {

int connect_udp(const std::string& called, const std::string& host, int port) {
  addrinfo hints{};
  hints.ai_family = AF_INET;
  hints.ai_socktype = SOCK_DGRAM;
  addrinfo* found = nullptr;
  if (getaddrinfo(host.c_str(), std::to_string(port).c_str(), &hints, &found) != 0 || found == nullptr) {
    throw DeviceError(DeviceStatus::absent, fmt::format("{}: the host {} is not known", called, host));
  }
  const std::unique_ptr<addrinfo, void (*)(addrinfo*)> owner(found, freeaddrinfo);
  const int fd = ::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  if (fd >= 0) ask_for_stamps(fd);
  if (fd < 0 || ::connect(fd, found->ai_addr, found->ai_addrlen) != 0) {
    const int error = errno;
    if (fd >= 0) ::close(fd);
    throw DeviceError(DeviceStatus::absent, fmt::format("{} at {}:{}: {}", called, host, port, std::strerror(error)));
  }
  return fd;
}

bool on_loopback(int socket) {
  sockaddr_in peer{};
  socklen_t size = sizeof peer;
  return ::getpeername(socket, reinterpret_cast<sockaddr*>(&peer), &size) == 0 &&
         ntohl(peer.sin_addr.s_addr) >> 24U == IN_LOOPBACKNET;
}

class RdtSource final : public WrenchSource {
 public:
  RdtSource(const std::string& host, int port, RdtSensor sensor)
      : sensor_(std::move(sensor)),
        place_(fmt::format("{} at {}:{}", sensor_.called, host, port)),
        socket_(connect_udp(sensor_.called, host, port)) {
    // No sensor answers from this machine.
    sensor_.identity.emulated = sensor_.identity.emulated || on_loopback(socket_);
  }
  ~RdtSource() override {
    stop();
    ::close(socket_);
  }
  RdtSource(const RdtSource&) = delete;
  RdtSource& operator=(const RdtSource&) = delete;

  [[nodiscard]] const DeviceIdentity& identity() const override { return sensor_.identity; }

  [[nodiscard]] double nominal_rate_Hz() const override { return sensor_.rate_Hz; }

  void start() override {
    sequence_ = {};
    for (const auto& [command, value] : sensor_.before_start) {
      request(command, value);
      clock_.sleep_until(clock_.now_s() + sensor_.between_commands_s);
    }
    // What is still there of an earlier stream would be mistaken for a jump of this one.
    unsigned char old[2 * rdt_record_bytes];
    while (::recv(socket_, old, sizeof old, MSG_DONTWAIT) > 0) {
    }
    request(RdtCommand::start_realtime, sensor_.records);
  }

  void stop() noexcept override {
    if (sensor_.records > 0) return;  // it ends by itself, and another program's stream may run
    const auto bytes = encode_request(RdtCommand::stop, 0);
    [[maybe_unused]] const auto sent = ::send(socket_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
  }

  std::size_t read(std::span<WrenchSample> out, double deadline_s) override {
    std::size_t filled = receive(out);
    while (filled == 0) {
      const double left = deadline_s - clock_.now_s();
      if (left <= 0.0) return 0;
      pollfd ready{socket_, POLLIN, 0};
      const int n = ::poll(&ready, 1, static_cast<int>(std::ceil(std::min(left, 3600.0) * 1e3)));
      if (n < 0 && errno != EINTR)
        throw DeviceError(DeviceStatus::failed, fmt::format("{}: poll: {}", place_, std::strerror(errno)));
      if (n > 0) filled = receive(out);
    }
    return filled;
  }

  [[nodiscard]] StreamCounters counters() const override { return sequence_.counters(); }

 private:
  void request(RdtCommand command, std::uint32_t samples) {
    const auto bytes = encode_request(command, samples);
    if (::send(socket_, bytes.data(), bytes.size(), MSG_NOSIGNAL) != static_cast<ssize_t>(bytes.size())) {
      throw DeviceError(DeviceStatus::failed,
                        fmt::format("{}: the request was not sent: {}", place_, std::strerror(errno)));
    }
  }

  std::size_t receive(std::span<WrenchSample> out) {
    constexpr std::size_t batch = 64;
    std::array<std::array<unsigned char, 2 * rdt_record_bytes>, batch> buffers;
    std::array<iovec, batch> vectors{};
    std::array<mmsghdr, batch> messages{};
    std::array<StampBuffer, batch> stamps;
    const std::size_t want = std::min(batch, out.size());
    for (std::size_t i = 0; i < want; ++i) {
      vectors[i] = {buffers[i].data(), buffers[i].size()};
      messages[i].msg_hdr.msg_iov = &vectors[i];
      messages[i].msg_hdr.msg_iovlen = 1;
      messages[i].msg_hdr.msg_control = stamps[i].bytes;
      messages[i].msg_hdr.msg_controllen = sizeof stamps[i].bytes;
    }
    const int n = ::recvmmsg(socket_, messages.data(), static_cast<unsigned>(want), MSG_DONTWAIT, nullptr);
    if (n < 0) {
      if (errno == EAGAIN || errno == EINTR) return 0;
      if (errno == ECONNREFUSED)
        throw DeviceError(DeviceStatus::gone, fmt::format("{}: nothing listens there any more", place_));
      throw DeviceError(DeviceStatus::failed, fmt::format("{}: {}", place_, std::strerror(errno)));
    }
    arrivals_.received(clock_.now_s(), real_now_s());
    std::size_t filled = 0;
    for (std::size_t i = 0; i < static_cast<std::size_t>(n); ++i) {
      if (messages[i].msg_len != rdt_record_bytes) {
        ++sequence_.counters().malformed;
        continue;
      }
      const RdtRecord record =
          decode_record(std::span<const unsigned char, rdt_record_bytes>(buffers[i].data(), rdt_record_bytes));
      const auto verdict = sequence_.accept(record.rdt_sequence);
      // A late record would make time run back in the recording: it is counted and left out.
      if (verdict == SequenceTracker::Verdict::repeated || verdict == SequenceTracker::Verdict::reordered) continue;
      WrenchSample& sample = out[filled++];
      sample = {};
      sample.t_s = arrivals_.arrival_s(messages[i].msg_hdr);
      sample.sequence = sequence_.unwrapped();
      sample.device_status = record.status;
      if ((record.status & rdt_error_bit) != 0) {
        sample.flags |= recording::sample_device_error;
        ++sequence_.counters().device_errors;
      }
      if (verdict == SequenceTracker::Verdict::after_gap) sample.flags |= recording::sample_after_gap;
      for (int k = 0; k < 3; ++k) {
        sample.wrench.f_N[k] = sensor_.newtons_per_count * record.counts[static_cast<std::size_t>(k)];
        sample.wrench.torque_Nm[k] = sensor_.newton_metres_per_count * record.counts[static_cast<std::size_t>(k + 3)];
      }
    }
    return filled;
  }

  RdtSensor sensor_;
  std::string place_;
  MonotonicClock clock_;
  SequenceTracker sequence_;
  StampedArrivals arrivals_;
  int socket_;
};

}  // namespace

std::unique_ptr<WrenchSource> open_rdt(const std::string& host, int udp_port, RdtSensor sensor) {
  return std::make_unique<RdtSource>(host, udp_port, std::move(sensor));
}

}  // namespace touchstone::hil
