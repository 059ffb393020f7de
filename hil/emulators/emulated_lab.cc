// touchstone-emulated-lab MAP SECONDS: a force sensor (5 kHz) and a tracker (60 Hz) on the loopback interface, for
// practice and for the documents' tests. A ball of 1 mm presses twice a second into a plate of 800 N/m while it moves
// along x. The hardware map MAP says where they are.
#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <cstring>

#include "emulators/natnet_emulator.h"
#include "emulators/netft_emulator.h"
#include "harness/base/atomic_file.h"

int main(int argc, char** argv) {
  using namespace touchstone;
  using namespace touchstone::hil;
  double seconds = 0.0;
  const char* const end = argc == 3 ? argv[2] + std::strlen(argv[2]) : nullptr;
  if (argc != 3 || std::from_chars(argv[2], end, seconds).ptr != end || !(seconds > 0.0)) {
    fmt::print(stderr, "usage: touchstone-emulated-lab MAP SECONDS, a number above 0\n");
    return 2;
  }
  constexpr double force_rate_Hz = 5000.0, tracker_rate_Hz = 60.0, stiffness_N_per_m = 800.0, radius_m = 1e-3;
  touchstone::hil::MonotonicClock clock;
  const double began = clock.now_s();
  const auto tip = [](double t) {
    return Vec3(0.002 * t, 0.01 * std::sin(0.4 * t), 0.001 + 0.003 * std::cos(4.0 * 3.141592653589793 * t));
  };
  touchstone::hil::NetFtEmulator sensor(force_rate_Hz, {}, [&](double) {
    const double depth = radius_m - tip(clock.now_s() - began).z();
    return Wrench{Vec3(0.0, 0.0, stiffness_N_per_m * std::max(0.0, depth)), Vec3::Zero()};
  });
  touchstone::hil::NatNetEmulator motive(tracker_rate_Hz, {}, [&](double t) {
    return touchstone::hil::EmulatedPose{tip(t + motive.began_s() - began), Quat::Identity(), true};
  });
  write_file(argv[1],
             fmt::format(
                 R"({{"schema": "touchstone-hardware/1",
 "devices": [
  {{"id": "ati-netft", "connected": true, "address": "127.0.0.1", "http_port": {}, "udp_port": {}}},
  {{"id": "optitrack", "connected": true, "address": "127.0.0.1", "port": {}, "body": "probe", "rate_Hz": {}}}]}}
)",
                 sensor.address().http_port, sensor.address().udp_port, motive.command_port(), tracker_rate_Hz));
  clock.sleep_until(began + seconds);
  return 0;
}
