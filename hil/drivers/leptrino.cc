#include "drivers/leptrino.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <utility>
#include <vector>

#include "drivers/byte_reader.h"
#include "drivers/record_count.h"
#include "drivers/serial_port.h"

namespace touchstone::hil {

namespace leptrino {
namespace {

constexpr unsigned char dle = 0x10, stx = 0x02, etx = 0x03, nak = 0x15, any_sensor = 0xff;
constexpr std::size_t header_bytes = 4, command_at = 2, result_at = 3;
constexpr std::size_t product_bytes = 32, product_with_rate_bytes = 38, rated_bytes = 28, sample_bytes = 20;
constexpr std::uint8_t defined_status = 0x07;

bool answers(std::string_view content, Command command, std::size_t bytes) {
  return content.size() == bytes &&
         static_cast<std::uint8_t>(content[command_at]) == static_cast<std::uint8_t>(command) &&
         content[result_at] == 0;
}

ByteReader data_of(std::string_view content) {
  ByteReader reader({reinterpret_cast<const unsigned char*>(content.data()), content.size()});
  reader.skip(header_bytes);
  return reader;
}

// A field of fixed width, without what fills it up.
std::string field(std::string_view content, std::size_t at, std::size_t width) {
  std::string text(content.substr(at, width));
  text.resize(std::min(text.size(), text.find('\0')));
  text.erase(text.find_last_not_of(' ') + 1);
  return text;
}

// A message from its DLE STX on.
Next whole_message(std::span<const unsigned char> bytes) {
  Next next;
  unsigned char sum = etx;
  for (std::size_t i = 2; i < bytes.size(); ++i) {
    if (next.content.size() > longest_content) return {Piece::noise, i, {}};
    if (bytes[i] == dle) {
      if (++i == bytes.size()) return {};
      if (bytes[i] == etx) {
        if (++i == bytes.size()) return {};
        const bool sound = bytes[i] == sum && next.content.size() >= header_bytes &&
                           static_cast<unsigned char>(next.content[0]) == next.content.size();
        return {sound ? Piece::content : Piece::damaged, i + 1, std::move(next.content)};
      }
      // The next message begins within this one, or may.
      if (bytes[i] != dle) return {Piece::noise, i - 1, {}};
    }
    next.content += static_cast<char>(bytes[i]);
    sum = static_cast<unsigned char>(sum ^ bytes[i]);
  }
  return {};
}

}  // namespace

std::string message(Command command) {
  const std::array<unsigned char, header_bytes> content{header_bytes, any_sensor, static_cast<unsigned char>(command),
                                                        0};
  std::string bytes{static_cast<char>(dle), static_cast<char>(stx)};
  unsigned char sum = etx;
  for (const unsigned char byte : content) {  // none of them is a DLE
    bytes += static_cast<char>(byte);
    sum = static_cast<unsigned char>(sum ^ byte);
  }
  return bytes + static_cast<char>(dle) + static_cast<char>(etx) + static_cast<char>(sum);
}

Next next_piece(std::span<const unsigned char> bytes) {
  if (bytes.size() < 2) return {};
  if (bytes[0] == dle && bytes[1] == stx) return whole_message(bytes);
  if (bytes[0] == dle && bytes[1] == nak) return {Piece::refused, 2, {}};
  std::size_t begin = 1;
  while (begin < bytes.size() && bytes[begin] != dle) ++begin;
  return {Piece::noise, begin, {}};
}

std::optional<Product> parse_product(std::string_view content) {
  const bool with_rate = answers(content, Command::product, product_with_rate_bytes);
  if (!with_rate && !answers(content, Command::product, product_bytes)) return std::nullopt;
  Product product{field(content, 4, 16), field(content, 20, 8), field(content, 28, 4), 0.0};
  if (!with_rate) return product;
  const std::string rate = field(content, 32, 6);
  int rate_Hz = 0;
  const auto [end, error] = std::from_chars(rate.data(), rate.data() + rate.size(), rate_Hz);
  if (error == std::errc() && end == rate.data() + rate.size() && rate_Hz > 0) product.rate_Hz = rate_Hz;
  return product;
}

std::optional<std::array<double, 6>> parse_rated_values(std::string_view content) {
  if (!answers(content, Command::rated_values, rated_bytes)) return std::nullopt;
  ByteReader reader = data_of(content);
  std::array<double, 6> rated{};
  for (double& value : rated) {
    value = reader.little<float>();
    if (!(value > 0.0) || !std::isfinite(value)) return std::nullopt;
  }
  return rated;
}

std::optional<Sample> parse_sample(std::string_view content) {
  if (!answers(content, Command::start, sample_bytes)) return std::nullopt;
  ByteReader reader = data_of(content);
  Sample sample;
  for (std::int16_t& count : sample.counts) count = reader.little<std::int16_t>();
  reader.skip(2);
  sample.status = reader.little<std::uint8_t>() & defined_status;
  return sample;
}

}  // namespace leptrino

namespace {

using leptrino::Command;
using leptrino::Piece;

constexpr double counts_of_rated = 10000.0;
constexpr int last_count = 32000;
constexpr std::uint8_t beyond_rated = 0x04;
constexpr std::size_t message_bytes = 25;  // of a sample in which nothing is doubled

std::string_view meaning(unsigned char result) {
  constexpr std::array<std::string_view, 5> meanings{"none", "the length is wrong", "the command is not known",
                                                     "the value is wrong", "the sensor's state does not allow it"};
  return result < meanings.size() ? meanings[result] : "a result that its specification does not have";
}

// Which sample an arrival belongs to at an even rate. Arrivals are late, so that the earliest of the last second or two
// count.
class ArrivalNumbers {
 public:
  explicit ArrivalNumbers(double rate_Hz = 1.0) : rate_Hz_(rate_Hz) {}

  void note(std::uint64_t number, double arrived_s) {
    constexpr double span_s = 1.0;
    if (arrived_s > began_s_ + span_s) before_s_ = std::exchange(earliest_s_, unknown), began_s_ = arrived_s;
    earliest_s_ = std::min(earliest_s_, arrived_s - static_cast<double>(number) / rate_Hz_);
  }
  // After a first one was noted.
  [[nodiscard]] double number_at(double arrived_s) const {
    return (arrived_s - std::min(earliest_s_, before_s_)) * rate_Hz_;
  }

 private:
  static constexpr double unknown = std::numeric_limits<double>::infinity();
  double rate_Hz_, began_s_ = -unknown, earliest_s_ = unknown, before_s_ = unknown;  // when number 0 would have come
};

class LeptrinoSource final : public WrenchSource {
 public:
  explicit LeptrinoSource(const LeptrinoOptions& options)
      : options_(options), line_("Leptrino sensor", options.node, options.baud) {
    // Another program may have left it sending.
    ask(Command::stop, [](std::string_view) { return true; });
    leptrino::Product product;
    ask(Command::product, [&](std::string_view content) {
      const auto parsed = leptrino::parse_product(content);
      if (parsed) product = *parsed;
      return parsed.has_value();
    });
    ask(Command::rated_values, [&](std::string_view content) {
      const auto parsed = leptrino::parse_rated_values(content);
      if (parsed) rated_ = *parsed;
      return parsed.has_value();
    });
    rate_Hz_ = product.rate_Hz > 0.0 ? product.rate_Hz : options.rate_Hz;
    if (!(rate_Hz_ > 0.0))
      throw DeviceError(DeviceStatus::failed,
                        fmt::format("{}: firmware {} does not say how many samples it sends a second", line_.place(),
                                    product.firmware),
                        "its \"rate_Hz\" must be in the hardware map; its data sheet has it");
    identity_ = {std::string(leptrino_device.id), product.serial,
                 fmt::format("{}, firmware {}", product.model, product.firmware),
                 fmt::format("in the sensor, rated {:.6g} {:.6g} {:.6g} N, {:.6g} {:.6g} {:.6g} N m", rated_[0],
                             rated_[1], rated_[2], rated_[3], rated_[4], rated_[5]),
                 line_.emulated()};
  }
  ~LeptrinoSource() override { stop(); }
  LeptrinoSource(const LeptrinoSource&) = delete;
  LeptrinoSource& operator=(const LeptrinoSource&) = delete;

  [[nodiscard]] const DeviceIdentity& identity() const override { return identity_; }
  [[nodiscard]] double nominal_rate_Hz() const override { return rate_Hz_; }

  void start() override {
    stop();
    line_.flush();
    held_.clear();
    counters_ = {};
    count_ = {};
    in_step_ = overflowed_ = false;
    damaged_ = 0;
    arrivals_ = ArrivalNumbers(rate_Hz_);
    line_.write(leptrino::message(Command::start));
    running_ = true;
  }
  void stop() noexcept override {
    if (!running_) return;
    running_ = false;
    try {
      line_.write(leptrino::message(Command::stop));
    } catch (const DeviceError&) {
      // It is gone.
    }
  }

  std::size_t read(std::span<WrenchSample> out, double deadline_s) override {
    if (out.empty()) return 0;
    for (;;) {
      // First what found no room last time.
      if (const std::size_t filled = take(out); filled > 0) return filled;
      if (!receive(deadline_s)) return 0;
    }
  }

  [[nodiscard]] StreamCounters counters() const override { return counters_; }

 private:
  bool receive(double deadline_s) {
    unsigned char bytes[4096];
    const std::size_t n = line_.read(bytes, deadline_s, arrived_s_);
    held_.insert(held_.end(), bytes, bytes + n);
    return n > 0;
  }

  leptrino::Next next() {
    auto piece = leptrino::next_piece(held_);
    held_.erase(held_.begin(), held_.begin() + static_cast<std::ptrdiff_t>(piece.used));
    return piece;
  }

  // Sends the command until an answer to it is taken; what else comes is left out.
  template <class Take>
  void ask(Command command, Take take) {
    constexpr int attempts = 3;
    const std::string name = fmt::format("command 0x{:02x}", static_cast<unsigned>(command));
    std::string why;
    for (int i = 0; i < attempts; ++i) {
      const double until_s = clock_.now_s() + options_.timeout_s / attempts;
      line_.flush();
      held_.clear();
      line_.write(leptrino::message(command));
      bool again = false;
      while (!again && clock_.now_s() < until_s && receive(until_s)) {
        for (auto piece = next(); piece.piece != Piece::incomplete && !again; piece = next()) {
          again = piece.piece == Piece::refused;
          if (again) why = fmt::format("{} came to it damaged, as it says (NAK)", name);
          if (piece.piece != Piece::content ||
              static_cast<std::uint8_t>(piece.content[2]) != static_cast<std::uint8_t>(command))
            continue;
          if (const auto result = static_cast<unsigned char>(piece.content[3]); result != 0) {
            throw DeviceError(DeviceStatus::failed,
                              fmt::format("{}: it refuses {}: {}", line_.place(), name, meaning(result)),
                              "switch the sensor off and on and try again");
          }
          if (take(piece.content)) return;
          why =
              fmt::format("{} bytes came as the answer to {}, which are none of its forms", piece.content.size(), name);
        }
      }
    }
    throw DeviceError(
        why.empty() ? DeviceStatus::timed_out : DeviceStatus::failed,
        fmt::format("{}: {}", line_.place(),
                    why.empty() ? fmt::format("no answer to {} within {} s", name, options_.timeout_s) : why),
        fmt::format("is it this line, at {} baud? Switch the sensor off and on and try again", options_.baud));
  }

  std::size_t take(std::span<WrenchSample> out) {
    std::size_t filled = 0;
    while (filled < out.size()) {
      const auto piece = next();
      switch (piece.piece) {
        case Piece::incomplete:
          return filled;
        case Piece::refused:
          line_.write(leptrino::message(Command::start));
          break;
        case Piece::damaged:
          count_damage();
          in_step_ = true;  // its end was seen: what follows is whole
          break;
        case Piece::noise:
          count_damage();
          overflowed_ = true;
          in_step_ = false;
          break;
        case Piece::content:
          if (const auto sample = leptrino::parse_sample(piece.content)) out[filled++] = sample_of(*sample);
          in_step_ = true;
          check_result(piece.content);
          break;
      }
    }
    return filled;
  }

  // Samples between the last and this one.
  std::uint64_t missing() {
    const std::uint64_t damaged = std::exchange(damaged_, 0);
    if (!std::exchange(overflowed_, false) || !count_.started()) return damaged;
    // Those that came with it and wait behind it are later.
    const std::uint64_t behind = held_.size() / message_bytes;
    const double ahead = arrivals_.number_at(arrived_s_) - static_cast<double>(behind + count_.sequence());
    return std::max(damaged, static_cast<std::uint64_t>(std::max(0.0, std::round(ahead) - 1.0)));
  }

  // A run of bytes that are no message is one that is damaged; the first after start() may be the end of one.
  void count_damage() {
    if (!in_step_) return;
    ++counters_.malformed;
    ++damaged_;
  }

  void check_result(std::string_view content) const {
    const auto result = static_cast<unsigned char>(content[3]);
    if (result != 0 && static_cast<std::uint8_t>(content[2]) == static_cast<std::uint8_t>(Command::start))
      throw DeviceError(DeviceStatus::failed, fmt::format("{}: it does not start: {}", line_.place(), meaning(result)));
  }

  WrenchSample sample_of(const leptrino::Sample& read) {
    WrenchSample sample;
    sample.flags |= count_.take(1 + missing(), counters_);
    sample.sequence = count_.sequence();
    sample.t_s = arrived_s_;
    arrivals_.note(sample.sequence, arrived_s_);
    for (std::size_t k = 0; k < 3; ++k) {
      sample.wrench.f_N[static_cast<int>(k)] = read.counts[k] * rated_[k] / counts_of_rated;
      sample.wrench.torque_Nm[static_cast<int>(k)] = read.counts[k + 3] * rated_[k + 3] / counts_of_rated;
    }
    sample.device_status = read.status;
    if (std::any_of(read.counts.begin(), read.counts.end(), [](int c) { return std::abs(c) >= last_count; }))
      sample.flags |= recording::sample_saturated;
    if ((read.status & beyond_rated) != 0) sample.flags |= recording::sample_out_of_range;
    if ((read.status & ~beyond_rated) != 0) sample.flags |= recording::sample_device_error;
    if (read.status != 0) ++counters_.device_errors;
    return sample;
  }

  LeptrinoOptions options_;
  SerialPort line_;
  MonotonicClock clock_;
  DeviceIdentity identity_;
  StreamCounters counters_;
  std::array<double, 6> rated_{};
  double rate_Hz_ = 0.0, arrived_s_ = 0.0;
  std::vector<unsigned char> held_;
  RecordCount count_;
  std::uint64_t damaged_ = 0;  // messages since the last sample
  ArrivalNumbers arrivals_;
  bool in_step_ = false, overflowed_ = false, running_ = false;
};

}  // namespace

std::unique_ptr<WrenchSource> open_leptrino(const LeptrinoOptions& options) {
  return std::make_unique<LeptrinoSource>(options);
}

constexpr KnownDevice leptrino_device{
    .id = "leptrino-serial",
    .name = "Leptrino force sensor with a serial line or USB",
    .role = DeviceRole::wrench_source,
    .bus = Bus::serial,
    .source = "Leptrino's communication format specification 1.13; a public driver for 1.31",
    .confidence = Confidence::confirmed,
    .note = "its node is in the hardware map",
    .address_example = "/dev/ttyUSB0",
    .open_force = [](const MappedDevice& device, double) -> std::unique_ptr<WrenchSource> {
      LeptrinoOptions options;
      options.node = device.address;
      if (device.baud != 0) options.baud = device.baud;
      options.rate_Hz = device.rate_Hz;
      return open_leptrino(options);
    }};

}  // namespace touchstone::hil
