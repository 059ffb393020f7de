#include "emulators/haply_emulator.h"

#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/websocket.hpp>
#include <chrono>
#include <nlohmann/json.hpp>

#include "emulators/loopback_socket.h"

namespace touchstone::hil {
namespace {

nlohmann::json as_xyz(const Vec3& v) { return {{"x", v.x()}, {"y", v.y()}, {"z", v.z()}}; }

nlohmann::json as_transform(double scale) {
  return {{"position", as_xyz(Vec3::Zero())},
          {"rotation", {{"w", 1.0}, {"x", 0.0}, {"y", 0.0}, {"z", 0.0}}},
          {"scale", as_xyz(Vec3::Constant(scale))}};
}

}  // namespace

HaplyEmulator::HaplyEmulator(HaplyFaults faults, std::function<Vec3(double)> cursor)
    : faults_(faults), cursor_(std::move(cursor)) {
  force_[0] = faults.force_before_N;
  const LoopbackSocket opened = listen_on_loopback();
  listener_ = opened.fd;
  port_ = opened.port;
  thread_ = std::thread([this] { serve(); });
}

HaplyEmulator::~HaplyEmulator() {
  stop_ = true;
  thread_.join();
  ::close(listener_);
}

// One client after the other, as long as each stays.
void HaplyEmulator::serve() {
  namespace beast = boost::beast;
  const auto began = std::chrono::steady_clock::now();
  const auto device = [&](bool first) {
    const double t = std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
    const double step = 1e-4;
    nlohmann::json one{{"device_id", "049D"},
                       {"state",
                        {{"cursor_position", as_xyz(cursor_(t))},
                         {"cursor_velocity", as_xyz((cursor_(t + step) - cursor_(t)) / step)},
                         {"control_domain", "cartesian"},
                         {"control_mode", "idle"}}}};
    if (!faults_.before_3_5) {
      one["state"]["current_cursor_force"] = as_xyz(applied_N());
      one["state"]["transform"] = as_transform(1.0);
    }
    if (!faults_.no_status)
      one["status"] = {{"calibrated", !faults_.not_calibrated},
                       {"ready", true},
                       {"started", true},
                       {"in_use", false},
                       {"power_supply", true}};
    if (first)
      one["config"] = {{"type", "emulated"}, {"handedness", "right"}, {"extended_firmware_version", "emulated"}};
    if (first && !faults_.before_3_5) {
      one["config"]["basis"] = {{"permutation", faults_.axes}};
      one["config"]["mount"] = as_transform(faults_.mount_scale);
      one["config"]["filters"] = {{"force_gate", {{"gain", 0.3}}}, {"damping", {{"scalar", 0.0}}}};
    }
    return one;
  };
  const auto message = [&](bool first, bool listed) {
    nlohmann::json json{{"inverse3", nlohmann::json::array()},
                        {"wireless_verse_grip",
                         {{{"device_id", "VG01"},
                           {"state",
                            {{"orientation", {{"w", 1.0}, {"x", 0.0}, {"y", 0.0}, {"z", 0.0}}},
                             {"buttons", {{"a", false}, {"b", true}, {"c", false}}}}}}}}};
    if (first) json["session_id"] = 7;
    if (listed && !faults_.no_device) json["inverse3"].push_back(device(first));
    if (faults_.strange_inventory) json["inverse3"] = {7};
    return json.dump();
  };
  while (!stop_) {
    pollfd ready{listener_, POLLIN, 0};
    if (::poll(&ready, 1, 20) <= 0) continue;
    const int client = ::accept4(listener_, nullptr, nullptr, SOCK_CLOEXEC);
    if (client < 0) continue;
    const int on = 1;
    ::setsockopt(client, IPPROTO_TCP, 1 /* TCP_NODELAY */, &on, sizeof on);
    boost::asio::io_context io;
    beast::websocket::stream<boost::asio::ip::tcp::socket> stream(
        boost::asio::ip::tcp::socket(io, boost::asio::ip::tcp::v4(), client));
    beast::error_code error;
    stream.accept(error);
    stream.text(true);
    if (!error) stream.write(boost::asio::buffer(message(true, true)), error);
    while (!stop_ && !error) {
      pollfd data{client, POLLIN, 0};
      if (::poll(&data, 1, 20) <= 0) continue;
      beast::flat_buffer buffer;
      stream.read(buffer, error);
      if (error) break;
      const std::uint64_t n = ++messages_;
      const auto json = nlohmann::json::parse(beast::buffers_to_string(buffer.data()), nullptr, false);
      const auto values = json.is_object()
                              ? json.value(nlohmann::json::json_pointer("/inverse3/0/commands/set_cursor_force") /
                                               (faults_.before_3_5 ? "values" : "vector"),
                                           nlohmann::json())
                              : nlohmann::json();
      if (values.is_object() && !faults_.ignores_commands) {
        force_[0] = values.value("x", 0.0), force_[1] = values.value("y", 0.0), force_[2] = values.value("z", 0.0);
      }
      if (faults_.silent_after != 0 && n >= faults_.silent_after) continue;
      const bool listed = faults_.gone_after == 0 || n < faults_.gone_after;
      stream.write(boost::asio::buffer(faults_.garbage_at == n ? std::string("<html>") : message(false, listed)),
                   error);
    }
  }
}

}  // namespace touchstone::hil
