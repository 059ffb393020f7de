#include "drivers/onrobot.h"

#include <fmt/format.h>

#include <array>
#include <utility>

#include "drivers/rdt_source.h"
#include "harness/base/error.h"

namespace touchstone::hil {
namespace {

constexpr double counts_per_newton = 1e4, counts_per_newton_metre = 1e5;
constexpr int longest_period_ms = 250, last_filter = 6;
constexpr std::uint32_t bias_off = 0;

RdtSensor sensor_of(const OnRobotOptions& options, bool emulated) {
  RdtSensor sensor;
  sensor.called = "OnRobot";
  sensor.identity = {std::string(onrobot_device.id), "", fmt::format("OnRobot HEX, filter {}", options.filter),
                     fmt::format("by convention: {:.9g} N and {:.9g} N m per count", 1.0 / counts_per_newton,
                                 1.0 / counts_per_newton_metre),
                     emulated};
  sensor.newtons_per_count = 1.0 / counts_per_newton;
  sensor.newton_metres_per_count = 1.0 / counts_per_newton_metre;
  sensor.rate_Hz = 1e3 / options.period_ms;
  return sensor;
}

// UDP says nothing of who is there: one record must come. A packet may get lost, so we ask more than once.
void expect_record(WrenchSource& source, const OnRobotOptions& options, double timeout_s) {
  constexpr int attempts = 3;
  std::array<WrenchSample, 1> first;
  const MonotonicClock clock;
  for (int i = 0; i < attempts; ++i) {
    try {
      source.start();
      if (source.read(first, clock.now_s() + timeout_s / attempts) > 0) return;
    } catch (const DeviceError&) {
      break;  // nothing listens there
    }
  }
  throw DeviceError(
      DeviceStatus::absent,
      fmt::format("OnRobot at {}:{}: no record came within {:.3g} s", options.host, options.udp_port, timeout_s),
      "is it the Compute Box's address, and does no other program read from it?");
}

}  // namespace

std::unique_ptr<WrenchSource> open_onrobot(const OnRobotOptions& options, double timeout_s, bool emulated) {
  if (options.period_ms < 1 || options.period_ms > longest_period_ms)
    throw UsageError(
        fmt::format("OnRobot: a period of {} ms; 1 to {} were expected", options.period_ms, longest_period_ms));
  if (options.filter < 0 || options.filter > last_filter)
    throw UsageError(fmt::format("OnRobot: filter {}; 0 (none) to {} were expected", options.filter, last_filter));
  RdtSensor sensor = sensor_of(options, emulated);
  sensor.before_start = {{RdtCommand::onrobot_period, static_cast<std::uint32_t>(options.period_ms)},
                         {RdtCommand::onrobot_filter, static_cast<std::uint32_t>(options.filter)},
                         {RdtCommand::set_bias, bias_off}};
  auto source = open_rdt(options.host, options.udp_port, std::move(sensor));
  expect_record(*source, options, timeout_s);
  source->stop();
  return source;
}

constexpr KnownDevice onrobot_device{
    .id = "onrobot-hex",
    .name = "OnRobot HEX-E or HEX-H behind its Compute Box",
    .role = DeviceRole::wrench_source,
    .bus = Bus::network,
    .source = "OnRobot's example highspeed_udp.c; OptoForce's ROS driver",
    .confidence = Confidence::reported,
    .note = "looked for at the addresses in the hardware map only; says no serial",
    .address_example = "192.168.1.1",
    .connected_when_named = true,
    .open_force = [](const MappedDevice& device, double) -> std::unique_ptr<WrenchSource> {
      return open_onrobot({device.address, device.udp_port}, open_timeout_s, false);
    },
    .look = [](const MappedDevice& device, double timeout_s) -> DeviceSeen {
      // One record, with the period, filter and bias that it has: they are another program's.
      const OnRobotOptions options{device.address, device.udp_port};
      RdtSensor sensor = sensor_of(options, false);
      sensor.records = 1;
      expect_record(*open_rdt(options.host, options.udp_port, std::move(sensor)), options, timeout_s);
      return {"", fmt::format("OnRobot HEX at {}", device.address)};
    }};

}  // namespace touchstone::hil
