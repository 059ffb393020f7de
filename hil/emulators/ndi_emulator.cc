#include "emulators/ndi_emulator.h"

#include <fmt/format.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cmath>
#include <memory>
#include <utility>

#include "emulators/loopback_socket.h"

namespace touchstone::hil {
namespace {

// ndicapi's running sum: a byte at a time by its parity, not bit by bit.
std::string with_sum(const std::string& text) {
  static const unsigned odd[16] = {0, 1, 1, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0, 1, 1, 0};
  unsigned crc = 0;
  for (const char c : text) {
    unsigned data = (static_cast<unsigned char>(c) ^ (crc & 0xffU)) & 0xffU;
    crc >>= 8U;
    if ((odd[data & 0x0fU] ^ odd[data >> 4U]) != 0) crc ^= 0xc001U;
    data <<= 6U;
    crc ^= data;
    data <<= 1U;
    crc ^= data;
  }
  return fmt::format("{}{:04X}\r", text, crc & 0xffffU);
}

}  // namespace

NdiEmulator::NdiEmulator(double rate_Hz, NdiFaults faults, std::function<EmulatedPose(double)> pose)
    : device_(rate_Hz, faults, std::move(pose)) {
  const LoopbackSocket opened = listen_on_loopback();
  listener_ = opened.fd;
  port_ = opened.port;
  thread_ = std::thread([this] { serve(); });
}

NdiEmulator::~NdiEmulator() {
  stop_ = true;
  thread_.join();
  ::close(listener_);
}

std::string NdiDevice::answer(const std::string& text, double t_s) {
  ++commands_;
  if (text.size() < 4 || with_sum(text.substr(0, text.size() - 4)) != text + "\r") return with_sum("ERROR04");
  const auto command = text.substr(0, text.size() - 4);
  const auto name = command.substr(0, command.find(':'));
  if (name == "PHSR") return with_sum(faults_.no_tool ? "00" : "0101001");
  if (name == "PHRQ") {
    handle_ = "0A";
    return with_sum("0A");
  }
  if (name == "PVWR") {
    if (command.size() != 5 + 2 + 4 + 128) return with_sum("ERROR03");
    definition_bytes_ += 64;
    return with_sum("OKAY");
  }
  if (name == "COMM") {
    // The speed's code, then 8 bits, no parity, one stop bit, no handshake (ndicapi.h, ndiCOMM).
    constexpr int speeds[] = {9600, 14400, 19200, 38400, 57600, 115200, 921600};
    if (command.size() != 10 || command[5] < '0' || command[5] > '6' || command.substr(6) != "0000")
      return with_sum("ERROR03");
    baud_ = speeds[command[5] - '0'];
  }
  if (name == "TSTART") tracking_ = true;
  if (name != "TX") return with_sum("OKAY");
  if (!tracking_) return with_sum("ERROR0C");
  return frame(t_s);
}

std::string NdiDevice::frame(double t_s) {
  ++asked_;
  constexpr double frames_per_s = 60.0;
  const double tracked = std::floor(t_s * rate_Hz_);
  const auto frame = static_cast<std::uint32_t>(tracked * frames_per_s / rate_Hz_);
  const EmulatedPose pose = pose_(tracked / rate_Hz_);
  const bool hidden = faults_.missing_every != 0 && frame % faults_.missing_every == 0;
  std::string reply = "01" + handle_;
  if (hidden) {
    reply += "MISSING";
  } else {
    reply += fmt::format("{:+06.0f}{:+06.0f}{:+06.0f}{:+06.0f}", pose.q_WB.w() * 1e4, pose.q_WB.x() * 1e4,
                         pose.q_WB.y() * 1e4, pose.q_WB.z() * 1e4);
    for (int k = 0; k < 3; ++k) reply += fmt::format("{:+07.0f}", pose.p_W_m[k] * 1e5);
    reply += "+00750";
  }
  reply += fmt::format("{:08X}{:08X}\n0000", 0x00000031U, frame);
  auto bytes = with_sum(reply);
  if (faults_.wrong_crc_every != 0 && asked_ % faults_.wrong_crc_every == 0) bytes[5] = bytes[5] == '1' ? '2' : '1';
  return bytes;
}

std::string NdiDevice::on_line(const std::string& came, double t_s, int baud) {
  if (faults_.deaf_s > 0.0) {
    if (t_s < faults_.deaf_s) return {};
    if (!std::exchange(greeted_, true)) return with_sum("RESET");
  }
  if (baud != baud_) return {};  // noise
  heard_ += came;
  std::string said;
  for (auto end = heard_.find('\r'); end != std::string::npos && baud == baud_; end = heard_.find('\r')) {
    said += answer(heard_.substr(0, end), t_s);
    heard_.erase(0, end + 1);
  }
  return said;
}

SerialEmulator::Device ndi_on_a_line(NdiFaults faults, std::function<EmulatedPose(double)> pose) {
  const auto device = std::make_shared<NdiDevice>(60.0, faults, std::move(pose));
  return [device](const std::string& came, double t_s, int baud) { return device->on_line(came, t_s, baud); };
}

void NdiEmulator::serve() {
  MonotonicClock clock;
  const double began = clock.now_s();
  while (!stop_) {
    pollfd ready{listener_, POLLIN, 0};
    if (::poll(&ready, 1, 20) <= 0) continue;
    const int client = ::accept4(listener_, nullptr, nullptr, SOCK_CLOEXEC);
    std::string came;
    while (!stop_ && client >= 0) {
      pollfd data{client, POLLIN, 0};
      if (::poll(&data, 1, 20) <= 0) continue;
      char bytes[1024];
      const auto n = ::recv(client, bytes, sizeof bytes, 0);
      if (n <= 0) break;
      came.append(bytes, static_cast<std::size_t>(n));
      for (auto end = came.find('\r'); end != std::string::npos; end = came.find('\r')) {
        const auto reply = device_.answer(came.substr(0, end), clock.now_s() - began);
        if (came.rfind("TX", 0) == 0) clock.sleep_until(clock.now_s() + device_.faults().late_s);
        came.erase(0, end + 1);
        [[maybe_unused]] const auto sent = ::send(client, reply.data(), reply.size(), MSG_NOSIGNAL);
        const std::string more(4096, 'A');
        while (!stop_ && device_.faults().endless && reply.size() > 40 &&
               ::send(client, more.data(), more.size(), MSG_NOSIGNAL) > 0) {
        }
      }
    }
    if (client >= 0) ::close(client);
  }
}

}  // namespace touchstone::hil
