#include "emulators/qualisys_emulator.h"

#include <fmt/format.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cmath>
#include <cstring>
#include <utility>

#include "emulators/loopback_socket.h"

namespace touchstone::hil {
namespace {

// This machine is little-endian, as the port is.
template <class T>
std::string bytes_of_field(T value) {
  std::string bytes(sizeof value, '\0');
  std::memcpy(bytes.data(), &value, sizeof value);
  return bytes;
}

std::string qtm_packet(std::uint32_t type, const std::string& data) {
  return bytes_of_field(static_cast<std::uint32_t>(8 + data.size())) + bytes_of_field(type) + data;
}
std::string qtm_text(std::uint32_t type, const std::string& text) { return qtm_packet(type, text + '\0'); }
constexpr std::uint32_t qtm_error = 0, qtm_answer = 1, qtm_xml = 2, qtm_data = 3, qtm_no_more_data = 4, qtm_event = 6;

std::string body_of(const EmulatedPose& pose) {
  // "If a marker is missing ... all their 32 bits set" (3D components), and a body's as ViSP takes it.
  if (!pose.tracked) return std::string(13 * sizeof(float), '\xff');
  std::string data;
  for (int k = 0; k < 3; ++k) data += bytes_of_field(static_cast<float>(1e3 * pose.p_W_m[k]));
  const Mat3 r = pose.q_WB.toRotationMatrix();
  for (const double cell : {r(0, 0), r(1, 0), r(2, 0), r(0, 1), r(1, 1), r(2, 1), r(0, 2), r(1, 2), r(2, 2)})
    data += bytes_of_field(static_cast<float>(cell));
  return data + bytes_of_field(QualisysEmulator::residual_mm);
}

}  // namespace

QualisysEmulator::QualisysEmulator(double rate_Hz, QualisysFaults faults, std::function<EmulatedPose(double)> pose)
    : rate_Hz_(rate_Hz), faults_(faults), pose_(std::move(pose)) {
  const LoopbackSocket opened = listen_on_loopback();
  listener_ = opened.fd;
  port_ = opened.port;
  thread_ = std::thread([this] { serve(); });
}

QualisysEmulator::~QualisysEmulator() { close(); }

void QualisysEmulator::close() {
  stop_ = true;
  if (thread_.joinable()) thread_.join();
  if (listener_ >= 0) ::close(listener_);
  listener_ = -1;
}

std::string QualisysEmulator::answer(const std::string& command) {
  if (command == "Version 1.8") return qtm_text(qtm_answer, "Version set to 1.8");
  if (command == "QTMVersion") return qtm_text(qtm_answer, "QTM Version is 2.17 (build 4000)");
  if (command == "GetParameters 6D") {
    std::string bodies;
    for (const char* const name : {"Table", "Stylus"}) {
      bodies += fmt::format(
          "<Body><Name>{}</Name><RGBColor>ffffff</RGBColor><Point><X>10.5</X><Y>9.5</Y><Z>10.5</Z></Point></Body>\n",
          name);
    }
    if (faults_.no_bodies) bodies.clear();
    // A client must be ready for an event at any time.
    return qtm_packet(qtm_event, "\x0b") +
           qtm_text(qtm_xml,
                    fmt::format("<QTM_Parameters_Ver_1.8>\n<The_6D>\n<Bodies>{}</Bodies>\n{}<Euler><First>Roll</"
                                "First></Euler>\n</The_6D>\n</QTM_Parameters_Ver_1.8>",
                                faults_.no_bodies ? 0 : 2, bodies));
  }
  if (command == "StreamFrames AllFrames 6DRes") return streaming_ = true, "";
  if (command == "StreamFrames Stop") return streaming_ = false, "";
  return qtm_text(qtm_error, "Parse error");
}

std::string QualisysEmulator::frame(std::uint64_t count) {
  const auto due = [&](std::uint32_t every) { return every != 0 && count % every == 0; };
  if (faults_.finishes_after != 0 && count > faults_.finishes_after)
    return streaming_ = false, qtm_packet(qtm_no_more_data, "");
  if (due(faults_.drop_every)) return {};
  const double t_s = static_cast<double>(count) / rate_Hz_;
  const bool again = faults_.begins_again != 0 && count > faults_.begins_again;
  const bool fewer = faults_.body_lost_after != 0 && count > faults_.body_lost_after;
  EmulatedPose table;
  table.p_W_m = Vec3(1, 2, 3);
  const std::string bodies = (fewer ? "" : body_of(table)) + body_of(pose_(t_s));
  // The two rates are of frames that were lost before QTM.
  std::string component = bytes_of_field(std::uint32_t{fewer ? 1U : 2U}) + bytes_of_field(std::uint16_t{3}) +
                          bytes_of_field(std::uint16_t{1}) + bodies;
  if (due(faults_.damage_every)) component.resize(component.size() - 10);
  const std::int64_t time_us = (again ? 0 : began_us) + std::llround(1e6 * t_s);
  const std::uint64_t number = (again ? count - faults_.begins_again : 1000 + count) * faults_.number_step;
  const std::string packet =
      qtm_packet(qtm_data, bytes_of_field(time_us) + bytes_of_field(static_cast<std::uint32_t>(number)) +
                               bytes_of_field(std::uint32_t{1}) +
                               bytes_of_field(static_cast<std::uint32_t>(8 + component.size())) +
                               bytes_of_field(std::uint32_t{11}) + component);
  return due(faults_.repeat_every) ? packet + packet : packet;
}

void QualisysEmulator::serve() {
  const MonotonicClock clock;
  int client = -1;
  std::string heard;
  std::uint64_t count = 0;
  double began = 0.0;
  const auto say = [&](const std::string& bytes) {
    if (client >= 0 && ::send(client, bytes.data(), bytes.size(), MSG_NOSIGNAL) != static_cast<ssize_t>(bytes.size()))
      ::close(client), client = -1;
  };
  while (!stop_) {
    if (client < 0) {
      pollfd ready{listener_, POLLIN, 0};
      if (::poll(&ready, 1, 20) <= 0) continue;
      client = ::accept4(listener_, nullptr, nullptr, SOCK_CLOEXEC);
      const int on = 1;
      ::setsockopt(client, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
      heard.clear(), streaming_ = false;
      const std::string greeting = qtm_text(qtm_answer, "QTM RT Interface connected");
      if (faults_.full)
        say(qtm_text(qtm_error, "Connection refused. Max number of clients reached."));
      else if (faults_.big_endian)
        say(std::string(3, '\0') + static_cast<char>(greeting.size()) + greeting.substr(4));
      else if (faults_.endless)
        say(bytes_of_field(std::uint32_t{4'000'000}) + std::string(5000, 'x'));
      else if (!faults_.mute)
        say(greeting);
    }
    char bytes[512];
    if (const auto n = ::recv(client, bytes, sizeof bytes, MSG_DONTWAIT); n > 0)
      heard.append(bytes, static_cast<std::size_t>(n));
    else if (n == 0)
      ::close(client), client = -1;
    while (client >= 0 && heard.size() > 8 && !faults_.mute) {
      std::uint32_t size = 0;
      std::memcpy(&size, heard.data(), sizeof size);
      if (heard.size() < size || size < 8) break;
      const bool streamed = streaming_;
      const std::string text = heard.substr(8, size - 8);  // with a zero, or without
      say(answer(text.substr(0, text.find('\0'))));
      if (streaming_ && !streamed) count = 0, began = clock.now_s();
      heard.erase(0, size);
    }
    while (client >= 0 && streaming_ && static_cast<double>(count + 1) / rate_Hz_ <= clock.now_s() - began)
      say(frame(++count));
    MonotonicClock().sleep_until(clock.now_s() + 5e-4);
  }
  if (client >= 0) ::close(client);
}

}  // namespace touchstone::hil
