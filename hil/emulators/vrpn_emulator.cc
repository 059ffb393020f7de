#include "emulators/vrpn_emulator.h"

#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <string>

#include "emulators/loopback_socket.h"
#include "emulators/vrpn_answers.h"

namespace touchstone::hil {
namespace {

// Another computer's clock, in seconds since 1970.
constexpr double began_by_its_clock_s = 1.76e9;
// Where the fields of a captured report are.
constexpr std::size_t seconds_at = 4, microseconds_at = 8, sensor_at = 24, pose_at = 32;

template <class T>
void put_big_endian_at(std::string& message, std::size_t at, T value) {
  char bytes[sizeof value];
  std::memcpy(bytes, &value, sizeof value);
  std::reverse(bytes, bytes + sizeof value);
  message.replace(at, sizeof value, bytes, sizeof value);
}

std::string report_of(double t_s, std::int32_t sensor, const EmulatedPose& pose) {
  std::string message(reinterpret_cast<const char*>(vrpn_report), sizeof vrpn_report);
  const double whole = std::floor(t_s);
  put_big_endian_at(message, seconds_at, static_cast<std::uint32_t>(whole));
  put_big_endian_at(message, microseconds_at, static_cast<std::uint32_t>((t_s - whole) * 1e6));
  put_big_endian_at(message, sensor_at, sensor);
  put_big_endian_at(message, sensor_at + 4, sensor);
  for (std::size_t k = 0; k < 3; ++k) put_big_endian_at(message, pose_at + 8 * k, pose.p_W_m[static_cast<int>(k)]);
  for (std::size_t k = 0; k < 4; ++k)
    put_big_endian_at(message, pose_at + 24 + 8 * k, pose.q_WB.coeffs()[static_cast<int>(k)]);
  return message;
}

}  // namespace

VrpnEmulator::VrpnEmulator(double rate_Hz, std::function<EmulatedPose(double)> pose)
    : rate_Hz_(rate_Hz), pose_(std::move(pose)) {
  const LoopbackSocket opened = listen_on_loopback();
  listener_ = opened.fd;
  port_ = opened.port;
  thread_ = std::thread([this] { serve(); });
}

VrpnEmulator::~VrpnEmulator() { close(); }

void VrpnEmulator::close() {
  stop_ = true;
  if (thread_.joinable()) thread_.join();
  if (listener_ >= 0) ::close(listener_);
  listener_ = -1;
}

void VrpnEmulator::serve() {
  MonotonicClock clock;
  int client = -1;
  std::uint64_t count = 0;
  double began = 0.0;
  const auto send = [&](const void* bytes, std::size_t size) {
    if (::send(client, bytes, size, MSG_NOSIGNAL) != static_cast<ssize_t>(size)) ::close(client), client = -1;
  };
  while (!stop_) {
    if (client < 0) {
      pollfd ready{listener_, POLLIN, 0};
      if (::poll(&ready, 1, 20) <= 0) continue;
      client = ::accept4(listener_, nullptr, nullptr, SOCK_CLOEXEC);
      char cookie[24];
      if (client < 0 || ::recv(client, cookie, sizeof cookie, MSG_WAITALL) != sizeof cookie ||
          std::memcmp(cookie, vrpn_greeting, 14) != 0) {
        if (client >= 0) ::close(client), client = -1;
        continue;
      }
      const int on = 1;
      ::setsockopt(client, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
      send(vrpn_greeting, sizeof vrpn_greeting);
      count = 0, began = clock.now_s();
    }
    const double since = clock.now_s() - began;
    while (client >= 0 && static_cast<double>(count + 1) / rate_Hz_ <= since) {
      const double t = static_cast<double>(++count) / rate_Hz_;
      const EmulatedPose pose = pose_(t);
      const double stamp = began_by_its_clock_s + t + set_by_s_;
      const auto first = report_of(stamp, 0, pose);
      send(first.data(), first.size());
      EmulatedPose other;
      other.p_W_m = pose.p_W_m + Vec3(1, 1, 1);
      const auto second = report_of(stamp, 1, other);
      if (client >= 0) send(second.data(), second.size());
    }
    clock.sleep_until(clock.now_s() + 5e-4);
  }
  if (client >= 0) ::close(client);
}

}  // namespace touchstone::hil
