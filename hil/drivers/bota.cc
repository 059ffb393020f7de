#include "drivers/bota.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "drivers/byte_reader.h"
#include "drivers/record_count.h"
#include "drivers/serial_port.h"

namespace touchstone::hil {

namespace bota {

std::uint16_t crc_x25(std::span<const unsigned char> bytes) {
  constexpr std::uint16_t reflected_polynomial = 0x8408;
  std::uint16_t crc = 0xffff;
  for (const unsigned char byte : bytes) {
    crc = static_cast<std::uint16_t>(crc ^ byte);
    for (int bit = 0; bit < 8; ++bit)
      crc = static_cast<std::uint16_t>((crc & 1U) != 0 ? (crc >> 1U) ^ reflected_polynomial : crc >> 1U);
  }
  return static_cast<std::uint16_t>(~crc);
}

std::optional<Frame> decode(std::span<const unsigned char, frame_bytes> bytes) {
  if (bytes[0] != header) return std::nullopt;
  const auto data = bytes.subspan<1, frame_bytes - 3>();
  ByteReader reader(bytes);
  reader.skip(1);
  Frame frame;
  frame.status = reader.little<std::uint16_t>();
  for (int k = 0; k < 3; ++k) frame.wrench.f_N[k] = reader.little<float>();
  for (int k = 0; k < 3; ++k) frame.wrench.torque_Nm[k] = reader.little<float>();
  frame.time = reader.little<std::uint32_t>();
  frame.temperature_C = reader.little<float>();
  if (reader.little<std::uint16_t>() != crc_x25(data)) return std::nullopt;
  // In a table such a number would spoil all others.
  if (!frame.wrench.f_N.allFinite() || !frame.wrench.torque_Nm.allFinite()) return std::nullopt;
  return frame;
}

}  // namespace bota

namespace {

constexpr double seconds_per_sinc = 19.53125e-6;
// Bits of the status that make a measurement useless: any, as Bota's own drivers take it.
constexpr std::uint16_t no_error = 0;

// A stream that is silent for so long has stopped long before.
constexpr double longest_gap_s = 10.0;

// How the sensor calls a speed.
std::optional<std::size_t> speed_code(int baud) {
  constexpr std::array speeds{9600, 57600, 115200, 230400, 460800};
  const auto* const found = std::find(speeds.begin(), speeds.end(), baud);
  if (found == speeds.end()) return std::nullopt;
  return static_cast<std::size_t>(found - speeds.begin());
}

class BotaSource final : public WrenchSource {
 public:
  explicit BotaSource(const BotaOptions& options)
      : options_(options), line_("Bota sensor", options.node, options.baud) {
    if (options.sinc_length < 51 || options.sinc_length > 512)
      throw DeviceError(DeviceStatus::failed,
                        fmt::format("{}: a sinc length of {}", line_.place(), options.sinc_length),
                        "51 to 512 are possible");
    identity_ = {std::string(bota_device.id), "", "serial frames, calibrated by the sensor", "in the sensor",
                 line_.emulated()};
    const auto speed = speed_code(options.baud);
    if (!speed)
      throw DeviceError(DeviceStatus::failed,
                        fmt::format("{}: {} baud is no speed of the sensor", line_.place(), options.baud),
                        "9600, 57600, 115200, 230400 and 460800 are");
    if (bota::frame_bytes * bits_per_byte / options.baud > seconds_per_sinc * options.sinc_length)
      throw DeviceError(DeviceStatus::failed,
                        fmt::format("{}: {} baud carry fewer than the {:.0f} frames a second of a sinc length of {}",
                                    line_.place(), options.baud, nominal_rate_Hz(), options.sinc_length),
                        "set the sensor to a higher speed");
    command("C", "C");
    command(fmt::format("c,0,1,0,{}", *speed), "c");
    command(fmt::format("f,{},0,0,1", options.sinc_length), "f");
    command("R", "R");
  }

  [[nodiscard]] const DeviceIdentity& identity() const override { return identity_; }
  [[nodiscard]] double nominal_rate_Hz() const override { return 1.0 / (seconds_per_sinc * options_.sinc_length); }

  void start() override {
    counters_ = {};
    count_ = {};
    steps_ = {};
    held_.clear();
    line_.flush();
  }
  void stop() noexcept override {}

  std::size_t read(std::span<WrenchSample> out, double deadline_s) override {
    for (;;) {
      unsigned char bytes[4096];
      double t_s = 0.0;
      const std::size_t n = line_.read(bytes, deadline_s, t_s);
      held_.insert(held_.end(), bytes, bytes + n);
      const std::size_t filled = take(out, t_s);
      if (filled > 0 || n == 0) return filled;
    }
  }

  [[nodiscard]] StreamCounters counters() const override { return counters_; }

 private:
  // Its answer stands between measurements, which may still come.
  void command(const std::string& text, const std::string& name) {
    MonotonicClock clock;
    const std::string good = fmt::format("r,0,{},0", name), bad = fmt::format("r,0,{},", name);
    std::string came;
    const double until = clock.now_s() + options_.timeout_s;
    line_.write(text);
    while (clock.now_s() < until) {
      unsigned char bytes[512];
      double t_s = 0.0;
      const auto n = line_.read(bytes, until, t_s);
      came.append(reinterpret_cast<const char*>(bytes), n);
      if (came.find(good) != std::string::npos) return;
      if (const auto at = came.find(bad); at != std::string::npos && came.size() > at + bad.size())
        throw DeviceError(DeviceStatus::failed, fmt::format("{}: it refuses \"{}\"", line_.place(), text));
    }
    throw DeviceError(
        DeviceStatus::timed_out,
        fmt::format("{}: no answer to \"{}\" within {} s", line_.place(), text, options_.timeout_s),
        fmt::format("is it this line, at {} baud? Switch the sensor off and on and try again", options_.baud));
  }

  std::size_t take(std::span<WrenchSample> out, double t_s) {
    std::size_t filled = 0, at = 0;
    while (filled < out.size() && held_.size() - at >= bota::frame_bytes) {
      const auto frame =
          bota::decode(std::span<const unsigned char, bota::frame_bytes>(held_.data() + at, bota::frame_bytes));
      if (!frame) {
        // To the next byte that could begin one; a run of such bytes is one malformed frame.
        counters_.malformed += in_step_ ? 1 : 0;
        in_step_ = false;
        ++at;
        continue;
      }
      in_step_ = true;
      at += bota::frame_bytes;
      out[filled++] = sample_of(*frame, t_s);
    }
    held_.erase(held_.begin(), held_.begin() + static_cast<std::ptrdiff_t>(at));
    return filled;
  }

  WrenchSample sample_of(const bota::Frame& frame, double t_s) {
    WrenchSample sample;
    std::uint64_t ahead = 1;
    if (count_.started()) {
      const std::uint32_t step = frame.time - time_;  // modulo 2^32
      // The clock of a sensor that was reset begins again, which says nothing of what is missing.
      if (steps_.shortest() > 0 && step / steps_.shortest() > longest_gap_s * nominal_rate_Hz()) {
        sample.flags |= recording::sample_after_gap;
      } else {
        ahead = steps_.ahead(step);
      }
    }
    sample.flags |= count_.take(ahead, counters_);
    time_ = frame.time;
    sample.t_s = t_s;
    sample.sequence = count_.sequence();
    sample.wrench = frame.wrench;
    sample.device_status = frame.status;
    if (frame.status != no_error) {
      sample.flags |= recording::sample_device_error;
      ++counters_.device_errors;
    }
    return sample;
  }

  BotaOptions options_;
  SerialPort line_;
  DeviceIdentity identity_;
  StreamCounters counters_;
  std::vector<unsigned char> held_;
  bool in_step_ = true;
  RecordCount count_;
  CountedSteps steps_;
  std::uint32_t time_ = 0;
};

}  // namespace

std::unique_ptr<WrenchSource> open_bota(const BotaOptions& options) { return std::make_unique<BotaSource>(options); }

constexpr KnownDevice bota_device{
    .id = "bota-serial",
    .name = "Bota Systems force sensor with a serial line",
    .role = DeviceRole::wrench_source,
    .bus = Bus::serial,
    .source = "Bota's Python interface and MATLAB example",
    .confidence = Confidence::reported,
    .note = "its node is in the hardware map",
    .address_example = "/dev/ttyUSB0",
    .open_force = [](const MappedDevice& device, double) -> std::unique_ptr<WrenchSource> {
      BotaOptions options;
      options.node = device.address;
      if (device.baud != 0) options.baud = device.baud;
      return open_bota(options);
    }};

}  // namespace touchstone::hil
