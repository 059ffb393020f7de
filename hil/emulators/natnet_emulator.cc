#include "emulators/natnet_emulator.h"

#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cmath>
#include <cstring>
#include <stdexcept>

#include "emulators/loopback_socket.h"

namespace touchstone::hil {
namespace {

template <class T>
void put(std::string& to, T value) {
  char bytes[sizeof value];
  std::memcpy(bytes, &value, sizeof value);
  to.append(bytes, sizeof value);
}

std::string packet_of(std::uint16_t id, const std::string& payload) {
  std::string packet;
  put(packet, id);
  put(packet, static_cast<std::uint16_t>(payload.size()));
  return packet + payload;
}

// A count, its bytes where the version states them, and what there is.
void put_section(std::string& to, std::uint32_t count, const std::string& content, bool sized) {
  put(to, count);
  if (sized) put(to, static_cast<std::uint32_t>(content.size()));
  to += content;
}

std::string server_info(bool sized) {
  std::string payload(256, '\0');
  std::memcpy(payload.data(), "Motive", 6);
  payload += sized ? std::string("\3\1\0\0\4\1\0\0", 8) : std::string("\2\1\0\0\3\0\0\0", 8);
  put(payload, static_cast<std::uint64_t>(NatNetEmulator::ticks_per_s));
  put(payload, std::uint16_t{1511});
  put(payload, std::uint8_t{0});                  // to each client by itself
  payload += std::string("\xef\xff\x2a\x63", 4);  // 239.255.42.99
  return packet_of(1, payload);
}

// A rigid body "probe" (2), and the marker sets that Motive lists with it.
std::string descriptions(bool sized) {
  std::string body("probe\0", 6);
  put(body, std::int32_t{2});
  put(body, std::int32_t{-1});
  body += std::string(12, '\0');
  if (!sized) {
    put(body, std::uint32_t{1});
    body += std::string(12, '\0');
    put(body, std::uint32_t{0});
  } else {
    body += std::string(4, '\0');
  }
  std::string set("all\0", 4);
  put(set, std::uint32_t{1});
  set += std::string("probe_1\0", 8);
  std::string payload;
  put(payload, std::uint32_t{2});
  // 4.1 lists marker sets first, as Motive may: the order is not the protocol's.
  const std::pair<std::uint32_t, const std::string*> items[] = {{sized ? 0U : 1U, sized ? &set : &body},
                                                                {sized ? 1U : 0U, sized ? &body : &set}};
  for (const auto& [kind, content] : items) {
    put(payload, kind);
    if (sized) put(payload, static_cast<std::uint32_t>(content->size()));
    payload += *content;
  }
  return packet_of(5, payload);
}

}  // namespace

std::string natnet_frame_packet(const EmulatedFrame& f, bool sized) {
  std::string payload;
  put(payload, f.number);
  put_section(payload, 0, "", sized);  // marker sets
  std::string older, bodies, labelled;
  std::uint32_t count = 0;
  for (const auto& m : f.markers) {
    put(labelled, m.marker);
    put(labelled, m.model);
    for (const float v : m.p) put(labelled, v);
    put(labelled, m.size);
    put(labelled, m.parameters);
    put(labelled, m.residual);
    if (m.model == 0) continue;
    ++count;
    for (const float v : m.p) put(older, v);
  }
  put_section(payload, count, older, sized);
  put(bodies, f.body);
  for (const float v : f.p) put(bodies, v);
  for (const float v : f.q_xyzw) put(bodies, v);
  put(bodies, f.mean_error);
  put(bodies, static_cast<std::int16_t>(f.tracked ? 1 : 0));
  put_section(payload, 1, bodies, sized);
  put_section(payload, 0, "", sized);             // skeletons
  if (sized) put_section(payload, 0, "", sized);  // assets
  put_section(payload, static_cast<std::uint32_t>(f.markers.size()), labelled, sized);
  put_section(payload, 0, "", sized);  // force plates
  put_section(payload, 0, "", sized);  // devices
  put(payload, std::uint32_t{0});      // timecode
  put(payload, std::uint32_t{0});
  put(payload, f.time_s);
  put(payload, f.exposure);
  put(payload, f.received);
  put(payload, f.sent);
  if (sized) payload += std::string(8, '\0');  // precision time stamp
  put(payload, std::int16_t{0});
  put(payload, std::uint32_t{0});
  return packet_of(7, payload);
}

NatNetEmulator::NatNetEmulator(double rate_Hz, NatNetFaults faults, std::function<EmulatedPose(double)> pose,
                               bool version_4_1)
    : rate_Hz_(rate_Hz), faults_(faults), pose_(std::move(pose)), sized_(version_4_1) {
  const LoopbackSocket opened = datagrams_on_loopback();
  socket_ = opened.fd;
  port_ = opened.port;
  if (faults_.second_card) {
    second_socket_ = ::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
    sockaddr_in second{};
    second.sin_family = AF_INET;
    second.sin_addr.s_addr = htonl(INADDR_LOOPBACK + 1);
    if (::bind(second_socket_, reinterpret_cast<const sockaddr*>(&second), sizeof second) != 0)
      throw std::runtime_error("127.0.0.2 cannot be bound");
  }
  began_s_ = MonotonicClock().now_s();
  thread_ = std::thread([this] { serve(); });
}

NatNetEmulator::~NatNetEmulator() {
  stop_ = true;
  thread_.join();
  ::close(socket_);
  if (second_socket_ >= 0) ::close(second_socket_);
}

void NatNetEmulator::send(int socket, const std::string& packet) {
  if (client_.size() != sizeof(sockaddr_in)) return;
  sockaddr_in to{};
  std::memcpy(&to, client_.data(), sizeof to);
  ::sendto(socket, packet.data(), packet.size(), MSG_NOSIGNAL, reinterpret_cast<const sockaddr*>(&to), sizeof to);
}

void NatNetEmulator::answer(const unsigned char* request, long size) {
  if (size < 4) return;
  const int id = request[0] | request[1] << 8;
  if (id == 0) send(socket_, server_info(sized_));
  if (id == 4) send(socket_, descriptions(sized_));
}

void NatNetEmulator::serve() {
  MonotonicClock clock;
  std::uint32_t count = 0;
  const auto due = [&](std::uint32_t every) { return every != 0 && count % every == 0; };
  while (!stop_) {
    unsigned char request[512];
    sockaddr_in from{};
    socklen_t length = sizeof from;
    for (;;) {
      const auto n =
          ::recvfrom(socket_, request, sizeof request, MSG_DONTWAIT, reinterpret_cast<sockaddr*>(&from), &length);
      if (n <= 0) break;
      client_.assign(reinterpret_cast<const char*>(&from), sizeof from);
      answer(request, n);
    }
    const double now = clock.now_s() - began_s_;
    // Motive's clock: frames are due by it.
    const double own = now * (1.0 + 1e-6 * faults_.clock_ppm) + 0.5e-6 * faults_.drift_ppm_per_s * now * now;
    while (static_cast<double>(count + 1) / rate_Hz_ + latency_s <= own) {
      ++count;
      if (client_.empty() || silent_ || (faults_.silent_after != 0 && sent_ >= faults_.silent_after)) continue;
      const double t = static_cast<double>(count) / rate_Hz_;
      const EmulatedPose pose = pose_(t);
      EmulatedFrame frame;
      const bool again = faults_.begins_again != 0 && count > faults_.begins_again;
      frame.number = again ? count - faults_.begins_again : count + faults_.begins_at - 1;
      for (int k = 0; k < 3; ++k) frame.p[k] = static_cast<float>(pose.p_W_m[k]);
      for (int k = 0; k < 3; ++k) frame.q_xyzw[k] = static_cast<float>(pose.q_WB.vec()[k]);
      frame.q_xyzw[3] = static_cast<float>(pose.q_WB.w());
      frame.tracked = pose.tracked;
      frame.markers.emplace_back();
      frame.time_s = t;
      const double stamp_s = epoch_s + t + set_by_s_;
      frame.exposure = static_cast<std::uint64_t>(std::llround(stamp_s * ticks_per_s));
      frame.received = frame.exposure + static_cast<std::uint64_t>(0.0046 * ticks_per_s);
      frame.sent = frame.exposure + static_cast<std::uint64_t>(latency_s * ticks_per_s);
      if (due(faults_.drop_every)) continue;
      std::string packet = natnet_frame_packet(frame, sized_);
      if (due(faults_.short_every)) packet.resize(packet.size() / 2);
      const int by = faults_.second_card ? second_socket_ : socket_;
      send(by, packet);
      if (due(faults_.repeat_every)) send(by, packet);
      ++sent_;
    }
    clock.sleep_until(clock.now_s() + 5e-4);
  }
}

}  // namespace touchstone::hil
