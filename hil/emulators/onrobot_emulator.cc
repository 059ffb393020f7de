#include "emulators/onrobot_emulator.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cmath>

#include "emulators/loopback_socket.h"

namespace touchstone::hil {
namespace {

constexpr int command_stop = 0x0000, command_start = 0x0002, command_bias = 0x0042, command_filter = 0x0081,
              command_speed = 0x0082;
constexpr double force_div = 10000.0, torque_div = 100000.0;

std::uint32_t big_endian(const unsigned char* bytes, int count) {
  std::uint32_t value = 0;
  for (int i = 0; i < count; ++i) value = value << 8 | bytes[i];
  return value;
}

}  // namespace

OnRobotEmulator::OnRobotEmulator(std::function<Wrench(double)> wrench) : wrench_(std::move(wrench)) {
  const LoopbackSocket opened = datagrams_on_loopback();
  socket_ = opened.fd;
  port_ = opened.port;
  thread_ = std::thread([this] { serve(); });
}

OnRobotEmulator::~OnRobotEmulator() {
  stop_ = true;
  thread_.join();
  ::close(socket_);
}

void OnRobotEmulator::serve() {
  MonotonicClock clock;
  sockaddr_in client{};
  double period_s = 0.01, start_s = 0.0;
  std::uint32_t sent = 0, wanted = 0;
  Wrench bias;
  while (!stop_) {
    unsigned char request[8];
    sockaddr_in from{};
    socklen_t size = sizeof from;
    while (::recvfrom(socket_, request, sizeof request, MSG_DONTWAIT, reinterpret_cast<sockaddr*>(&from), &size) == 8) {
      if (big_endian(request, 2) != 0x1234) continue;
      const auto command = static_cast<int>(big_endian(request + 2, 2));
      const std::uint32_t data = big_endian(request + 4, 4);
      settings_ += command == command_speed || command == command_filter || command == command_bias ? 1 : 0;
      if (command == command_speed && data > 0) period_s = 1e-3 * data;
      if (command == command_filter) filter_ = static_cast<int>(data);
      if (command == command_bias) bias = data == 0 ? Wrench{} : wrench_(clock.now_s() - start_s);
      if (command == command_stop) streams_ = false;
      if (command == command_start) client = from, streams_ = true, sent = 0, wanted = data, start_s = clock.now_s();
    }
    while (streams_ && sent * period_s < clock.now_s() - start_s) {
      const Wrench w = wrench_(sent * period_s);
      std::array<std::uint32_t, 9> words{sent, sent, 0};
      for (int k = 0; k < 3; ++k) {
        words[static_cast<std::size_t>(3 + k)] =
            static_cast<std::uint32_t>(static_cast<std::int32_t>(std::lround((w.f_N[k] - bias.f_N[k]) * force_div)));
        words[static_cast<std::size_t>(6 + k)] = static_cast<std::uint32_t>(
            static_cast<std::int32_t>(std::lround((w.torque_Nm[k] - bias.torque_Nm[k]) * torque_div)));
      }
      for (auto& word : words) word = htonl(word);
      ::sendto(socket_, words.data(), sizeof words, MSG_NOSIGNAL, reinterpret_cast<const sockaddr*>(&client),
               sizeof client);
      if (++sent == wanted) streams_ = false;
    }
    clock.sleep_until(clock.now_s() + 5e-4);
  }
}

}  // namespace touchstone::hil
