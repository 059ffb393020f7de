#include "drivers/load_cell.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <utility>

#include "drivers/serial_port.h"
#include "harness/base/error.h"

namespace touchstone::hil {
namespace {

// No sketch prints so much in a line.
constexpr std::size_t longest_line = 1024;

// For the first readings: a microcontroller that the opening of its line reset starts again, and settles.
constexpr double ready_s = 10.0;
// What a table of nine decimals still tells apart.
constexpr double least_step_s = 1e-6;

// A line without its numbers.
std::string words_of(std::string_view line) {
  std::string words;
  for (const char c : line) {
    if (std::isdigit(static_cast<unsigned char>(c)) == 0 && c != '-' && c != '+' && c != '.') words += c;
  }
  return words;
}

class LoadCellSource final : public WrenchSource {
 public:
  explicit LoadCellSource(const LoadCellOptions& options)
      : options_(options), line_("load cell", options.node, options.baud) {
    identity_ = {std::string(load_cell_device.id), "", "lines of numbers",
                 fmt::format("{:.9g} N per unit", options.newtons_per_unit), line_.emulated()};
    std::array<WrenchSample, 1> first;
    if (read(first, MonotonicClock().now_s() + ready_s) > 0) return;
    throw DeviceError(
        DeviceStatus::timed_out, fmt::format("{}: no readings within {} s", line_.place(), ready_s),
        fmt::format("does its sketch print at {} baud, at least twice in that time, lines that differ in their numbers "
                    "alone? (HX711's full example waits 5 s between readings: take its delay out.)",
                    options.baud));
  }

  [[nodiscard]] const DeviceIdentity& identity() const override { return identity_; }
  [[nodiscard]] double nominal_rate_Hz() const override { return options_.rate_Hz; }
  [[nodiscard]] bool numbers_records() const override { return false; }
  void start() override {
    counters_ = {};
    sequence_ = 0;
    line_.flush();
    held_.clear();
    whole_ = false;
  }
  void stop() noexcept override {}

  std::size_t read(std::span<WrenchSample> out, double deadline_s) override {
    if (out.empty()) return 0;
    for (;;) {
      // First the lines that found no room last time.
      if (const std::size_t filled = take(out); filled > 0) return filled;
      unsigned char bytes[1024];
      const std::size_t n = line_.read(bytes, deadline_s, arrived_s_);
      if (n == 0) return 0;
      held_.append(reinterpret_cast<const char*>(bytes), n);
    }
  }

  [[nodiscard]] StreamCounters counters() const override { return counters_; }

 private:
  std::size_t take(std::span<WrenchSample> out) {
    std::size_t filled = 0, begin = 0;
    while (filled < out.size()) {
      const auto end = held_.find('\n', begin);
      if (end == std::string::npos) break;
      const std::string_view text = std::string_view(held_).substr(begin, end - begin);
      begin = end + 1;
      // The first line may be the end of one.
      if (!std::exchange(whole_, true)) continue;
      const auto value = reading(text);
      if (!value) {
        ++counters_.malformed;
        continue;
      }
      WrenchSample& sample = out[filled++];
      sample = {};
      // What came with it and after it was on the wire meanwhile. An adapter hands on several lines at once.
      const double behind_s = bits_per_byte * static_cast<double>(held_.size() - begin) / options_.baud;
      last_s_ = std::max(arrived_s_ - behind_s, last_s_ + least_step_s);
      sample.t_s = last_s_;
      sample.sequence = sequence_++;
      sample.wrench.f_N[options_.axis - 'x'] = options_.newtons_per_unit * *value;
      ++counters_.received;
    }
    held_.erase(0, begin);
    if (held_.size() > longest_line && held_.find('\n') == std::string::npos) {
      // No sketch's line: what follows is the rest of it.
      held_.clear();
      whole_ = false;
      ++counters_.malformed;
    }
    return filled;
  }

  // The number of a line that is a reading.
  std::optional<double> reading(std::string_view text) {
    const auto value = number_in_line(text, options_.value);
    if (!value) return std::nullopt;
    auto words = words_of(text);
    if (words == before_) words_ = words;
    before_ = std::move(words);
    return words_ == before_ ? value : std::nullopt;
  }

  LoadCellOptions options_;
  SerialPort line_;
  DeviceIdentity identity_;
  StreamCounters counters_;
  std::string held_;
  std::optional<std::string> before_, words_;  // of the last line with a number, and of readings
  std::uint64_t sequence_ = 0;
  double arrived_s_ = 0.0, last_s_ = 0.0;
  bool whole_ = false;
};

}  // namespace

std::optional<double> number_in_line(std::string_view line, int n) {
  const auto letter = [&](std::size_t i) {
    return i < line.size() && (std::isalnum(static_cast<unsigned char>(line[i])) != 0 || line[i] == '_');
  };
  const auto digit = [&](std::size_t i) {
    return i < line.size() && std::isdigit(static_cast<unsigned char>(line[i])) != 0;
  };
  for (std::size_t i = 0; i < line.size();) {
    const std::size_t at = i + (line[i] == '-' || line[i] == '+' ? 1 : 0);
    // A digit inside a word ("HX711") is no number.
    const bool in_word = i > 0 && letter(i - 1);
    const std::string_view word = at < line.size() ? line.substr(at, 3) : std::string_view();
    if (!in_word && (word == "nan" || word == "inf" || word == "ovf") && !letter(at + 3)) {
      if (--n == 0) return std::nullopt;
      i = at + 3;
      continue;
    }
    if (in_word || !(digit(at) || (at < line.size() && line[at] == '.' && digit(at + 1)))) {
      ++i;
      continue;
    }
    double value = 0.0;
    const char* const begin = line.data() + (line[i] == '+' ? i + 1 : i);
    const auto [end, error] = std::from_chars(begin, line.data() + line.size(), value);
    if (error != std::errc() || !std::isfinite(value)) return std::nullopt;
    if (--n == 0) return value;
    i = static_cast<std::size_t>(end - line.data());
  }
  return std::nullopt;
}

std::unique_ptr<WrenchSource> open_load_cell(const LoadCellOptions& options) {
  if (options.newtons_per_unit == 0.0 || !std::isfinite(options.newtons_per_unit))
    throw UsageError(
        fmt::format("{}: its \"newtons_per_unit\" must be in the hardware map: what it prints has no unit (0.00980665 "
                    "for grams)",
                    load_cell_device.id));
  return std::make_unique<LoadCellSource>(options);
}

constexpr KnownDevice load_cell_device{
    .id = "hx711-serial",
    .name = "Load cell behind an HX711 and a microcontroller that prints numbers",
    .role = DeviceRole::wrench_source,
    .bus = Bus::serial,
    .source = "example sketches of the Arduino libraries HX711 and HX711_ADC",
    .confidence = Confidence::reported,
    .note = "one axis; says neither its unit nor its rate: the hardware map must",
    .address_example = "/dev/ttyUSB0",
    .one_axis = true,
    .open_force = [](const MappedDevice& device, double) -> std::unique_ptr<WrenchSource> {
      LoadCellOptions options;
      options.node = device.address;
      if (device.baud != 0) options.baud = device.baud;
      options.newtons_per_unit = device.newtons_per_unit;
      options.value = device.value;
      options.axis = device.axis;
      options.rate_Hz = device.rate_Hz;
      return open_load_cell(options);
    }};

}  // namespace touchstone::hil
