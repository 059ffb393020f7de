#include "emulators/netft_emulator.h"

#include <fmt/format.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cmath>
#include <cstring>
#include <map>
#include <optional>
#include <vector>

#include "emulators/loopback_socket.h"
#include "emulators/netft_answers.h"

namespace touchstone::hil {
namespace {

constexpr double counts_per_newton = 1e6, counts_per_newton_metre = 1e6;  // as the answer says: cfgcpf, cfgcpt
constexpr std::size_t request_bytes = 8, record_bytes = 36;
using Record = std::array<unsigned char, record_bytes>;

void put_big_endian(Record& record, std::size_t word, std::uint32_t value) {
  for (std::size_t i = 0; i < 4; ++i) record[4 * word + i] = static_cast<unsigned char>(value >> (24 - 8 * i));
}

// The text of an element exchanged.
std::string with_element(std::string xml, const std::string& name, const std::string& text) {
  const auto begin = xml.find("<" + name + ">") + name.size() + 2, end = xml.find("</" + name + ">");
  return xml.replace(begin, end - begin, text);
}

}  // namespace

NetFtEmulator::NetFtEmulator(double rate_Hz, NetFtFaults faults, std::function<Wrench(double)> wrench)
    : rate_Hz_(rate_Hz), faults_(faults), wrench_(std::move(wrench)) {
  const LoopbackSocket http = listen_on_loopback(), udp = datagrams_on_loopback();
  http_socket_ = http.fd, http_port_ = http.port;
  udp_socket_ = udp.fd, udp_port_ = udp.port;
  http_thread_ = std::thread([this] { serve_http(); });
  rdt_thread_ = std::thread([this] { serve_rdt(); });
}

NetFtEmulator::~NetFtEmulator() { unplug(); }

void NetFtEmulator::unplug() {
  stop_ = true;
  if (http_thread_.joinable()) http_thread_.join();
  if (rdt_thread_.joinable()) rdt_thread_.join();
  for (int* fd : {&http_socket_, &udp_socket_}) {
    if (*fd >= 0) ::close(*fd);
    *fd = -1;
  }
}

NetFtAddress NetFtEmulator::address() const { return {"127.0.0.1", http_port_, udp_port_}; }

void NetFtEmulator::serve_http() {
  std::vector<int> kept;  // of clients that never get an answer
  while (!stop_) {
    pollfd ready{http_socket_, POLLIN, 0};
    if (::poll(&ready, 1, 20) <= 0) continue;
    const int client = ::accept4(http_socket_, nullptr, nullptr, SOCK_CLOEXEC);
    if (client < 0) continue;
    if (faults_.http_silent) {
      kept.push_back(client);
      continue;
    }
    char request[2048];
    pollfd data{client, POLLIN, 0};
    if (::poll(&data, 1, 1000) > 0) [[maybe_unused]]
      const auto n = ::recv(client, request, sizeof request, 0);
    const std::string body =
        faults_.http_garbage
            ? "<html>not a sensor</html>"
            : with_element(with_element(std::string(netft_gamma_answer), "comrdtrate", fmt::format("{}", rate_Hz_)),
                           "cfgnam", faults_.names_itself_a_sensor ? "empty" : "emulated");
    const auto answer =
        fmt::format("HTTP/1.0 200 OK\r\nContent-Type: text/xml\r\nContent-Length: {}\r\n\r\n{}", body.size(), body);
    [[maybe_unused]] const auto n = ::send(client, answer.data(), answer.size(), MSG_NOSIGNAL);
    ::close(client);
  }
  for (const int client : kept) ::close(client);
}

void NetFtEmulator::serve_rdt() {
  MonotonicClock clock;
  std::map<std::pair<std::uint32_t, std::uint16_t>, sockaddr_in> clients;
  std::uint32_t sequence = faults_.first_sequence;
  std::uint64_t count = 0;
  double start = 0.0;
  std::optional<Record> held;
  const auto due = [&](std::uint32_t every) { return every != 0 && count % every == 0; };
  const auto send = [&](const unsigned char* bytes, std::size_t size) {
    for (const auto& [key, address] : clients) {
      ::sendto(udp_socket_, bytes, size, MSG_NOSIGNAL, reinterpret_cast<const sockaddr*>(&address), sizeof address);
    }
    ++sent_;
  };
  while (!stop_) {
    unsigned char request[64];
    sockaddr_in from{};
    socklen_t size = sizeof from;
    while (::recvfrom(udp_socket_, request, sizeof request, MSG_DONTWAIT, reinterpret_cast<sockaddr*>(&from), &size) ==
           static_cast<ssize_t>(request_bytes)) {
      if (request[0] != 0x12 || request[1] != 0x34) continue;
      const int command = request[2] << 8 | request[3];  // 0: stop, 2: send at full rate
      const std::pair key(from.sin_addr.s_addr, from.sin_port);
      if (command == 0) clients.erase(key);
      if (command == 2) {
        if (clients.empty()) start = clock.now_s(), started_s_ = start, count = 0, sequence = faults_.first_sequence;
        if (faults_.newest_client_wins) clients.clear();
        clients[key] = from;
      }
    }
    const bool silent = faults_.silent_after != 0 && count >= faults_.silent_after;
    if (clients.empty() || silent) {
      clock.sleep_until(clock.now_s() + 1e-3);
      continue;
    }
    // What is due by now, so that a late wake-up loses nothing.
    while (!stop_ &&
           static_cast<double>(count) < (clock.now_s() - start) * rate_Hz_ * (1.0 + 1e-6 * faults_.clock_ppm) &&
           !(faults_.silent_after != 0 && count >= faults_.silent_after)) {
      ++count;
      const Wrench w = wrench_(static_cast<double>(count) / rate_Hz_);
      Record bytes{};
      put_big_endian(bytes, 0, sequence);
      put_big_endian(bytes, 1, sequence++);
      put_big_endian(bytes, 2, due(faults_.error_bit_every) ? 1U << 31U : 0U);
      for (int k = 0; k < 3; ++k) {
        const auto force = static_cast<std::int32_t>(std::lround(w.f_N[k] * counts_per_newton)),
                   torque = static_cast<std::int32_t>(std::lround(w.torque_Nm[k] * counts_per_newton_metre));
        put_big_endian(bytes, static_cast<std::size_t>(3 + k), static_cast<std::uint32_t>(force));
        put_big_endian(bytes, static_cast<std::size_t>(6 + k), static_cast<std::uint32_t>(torque));
      }
      if (due(faults_.drop_every)) continue;
      if (due(faults_.swap_every) && !held) {
        held = bytes;
        continue;
      }
      send(bytes.data(), due(faults_.short_every) ? 20 : bytes.size());
      if (due(faults_.repeat_every)) send(bytes.data(), bytes.size());
      if (held) send(held->data(), held->size()), held.reset();
    }
    clock.sleep_until(clock.now_s() + std::min(1e-3, 1.0 / rate_Hz_));
  }
}

}  // namespace touchstone::hil
