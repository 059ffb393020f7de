#include "drivers/netft.h"

#include <fmt/format.h>

#include <utility>

#include "drivers/rdt_source.h"
#include "harness/base/web_request.h"

namespace touchstone::hil {
namespace {

constexpr std::size_t largest_document = 1U << 20U;
constexpr long first_error_status = 400;

std::string fetch(const std::string& url, double timeout_s) {
  // The sensor is on the bench's network, never behind a proxy.
  const auto timeout_ms = static_cast<long>(timeout_s * 1e3);
  WebAnswer answer = web_request({.url = url,
                                  .headers = {},
                                  .body = std::nullopt,
                                  .connect_timeout_ms = timeout_ms,
                                  .timeout_ms = timeout_ms,
                                  .encrypted_too = false,
                                  .use_proxy = false,
                                  .largest_answer_bytes = largest_document});
  if (answer.outcome == WebOutcome::answered && answer.status < first_error_status) return std::move(answer.text);
  const auto status = answer.outcome == WebOutcome::unreachable ? DeviceStatus::absent
                      : answer.outcome == WebOutcome::timed_out ? DeviceStatus::timed_out
                                                                : DeviceStatus::failed;
  throw DeviceError(
      status, fmt::format("Net F/T at {}: {}", url,
                          answer.problem.empty() ? fmt::format("HTTP status {}", answer.status) : answer.problem));
}

}  // namespace

NetFtConfiguration read_netft_configuration(const NetFtAddress& address, double timeout_s) {
  const auto url = fmt::format("http://{}:{}/netftapi2.xml", address.host, address.http_port);
  return parse_netft_configuration(fetch(url, timeout_s), url);
}

std::unique_ptr<WrenchSource> open_netft(const NetFtAddress& address, double timeout_s, bool emulated) {
  const NetFtConfiguration c = read_netft_configuration(address, timeout_s);
  RdtSensor sensor;
  sensor.called = "Net F/T";
  sensor.identity = {
      std::string(netft_device.id), c.serial, c.product,
      fmt::format("netftapi2.xml: {:.9g} N and {:.9g} N m per count", c.newtons_per_count, c.newton_metres_per_count),
      // An emulator says so itself, also where somebody's hardware map gives its address.
      emulated || c.product.find("emulated") != std::string::npos};
  sensor.newtons_per_count = c.newtons_per_count;
  sensor.newton_metres_per_count = c.newton_metres_per_count;
  sensor.rate_Hz = c.rate_Hz;
  return open_rdt(address.host, address.udp_port, std::move(sensor));
}

constexpr KnownDevice netft_device{
    .id = "ati-netft",
    .name = "ATI Net F/T",
    .role = DeviceRole::wrench_source,
    .bus = Bus::network,
    .source = "ATI Net F/T manual: RDT on UDP 49152, HTTP configuration",
    .confidence = Confidence::confirmed,
    .note = "looked for at the addresses in the hardware map only",
    .address_example = "192.168.1.1",
    .open_force = [](const MappedDevice& device, double) -> std::unique_ptr<WrenchSource> {
      return open_netft({device.address, device.http_port, device.udp_port}, open_timeout_s, false);
    },
    .look = [](const MappedDevice& device, double timeout_s) -> DeviceSeen {
      const auto found = read_netft_configuration({device.address, device.http_port, device.udp_port}, timeout_s);
      return {found.serial, fmt::format("{} at {}", found.product, device.address), true};
    }};

}  // namespace touchstone::hil
