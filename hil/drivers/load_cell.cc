#include "hil/drivers/load_cell.h"

#include <fmt/format.h>

#include <cctype>
#include <charconv>
#include <cmath>
#include <utility>

#include "harness/base/error.h"
#include "hil/drivers/serial_port.h"

namespace touchstone::hil {
namespace {

// No sketch prints so much in a line.
constexpr std::size_t longest_line = 1024;

class LoadCellSource final : public WrenchSource {
 public:
  explicit LoadCellSource(const LoadCellOptions& options)
      : options_(options), line_("load cell", options.node, options.baud) {
    identity_ = {"hx711-serial", "", "lines of numbers", fmt::format("{:.9g} N per unit", options.newtons_per_unit),
                 line_.emulated()};
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
    for (;;) {
      unsigned char bytes[1024];
      double t_s = 0.0;
      const std::size_t n = line_.read(bytes, deadline_s, t_s);
      held_.append(reinterpret_cast<const char*>(bytes), n);
      const std::size_t filled = take(out, t_s);
      if (filled > 0 || n == 0) return filled;
    }
  }

  [[nodiscard]] StreamCounters counters() const override { return counters_; }

 private:
  std::size_t take(std::span<WrenchSample> out, double t_s) {
    std::size_t filled = 0, begin = 0;
    while (filled < out.size()) {
      const auto end = held_.find('\n', begin);
      if (end == std::string::npos) break;
      const std::string_view text = std::string_view(held_).substr(begin, end - begin);
      begin = end + 1;
      // The first line may be the end of one.
      if (!std::exchange(whole_, true)) continue;
      const auto value = number_in_line(text, options_.value);
      if (!value) {
        ++counters_.malformed;
        continue;
      }
      WrenchSample& sample = out[filled++];
      sample = {};
      sample.t_s = t_s;
      sample.sequence = sequence_++;
      sample.wrench.f_N[options_.axis - 'x'] = options_.newtons_per_unit * *value;
      ++counters_.received;
    }
    held_.erase(0, begin);
    if (held_.size() > longest_line) held_.clear();
    return filled;
  }

  LoadCellOptions options_;
  SerialPort line_;
  DeviceIdentity identity_;
  StreamCounters counters_;
  std::string held_;
  std::uint64_t sequence_ = 0;
  bool whole_ = false;
};

}  // namespace

std::optional<double> number_in_line(std::string_view line, int n) {
  for (std::size_t i = 0; i < line.size();) {
    const bool sign = (line[i] == '-' || line[i] == '+') && i + 1 < line.size();
    const std::size_t digits = i + (sign ? 1 : 0);
    // A digit inside a word ("HX711") is no number.
    const bool in_word = i > 0 && (std::isalnum(static_cast<unsigned char>(line[i - 1])) != 0 || line[i - 1] == '_');
    if (in_word || std::isdigit(static_cast<unsigned char>(line[digits])) == 0) {
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
        "hx711-serial: its \"newtons_per_unit\" must be in the hardware map: what it prints has no unit (0.00980665 "
        "for "
        "grams)");
  return std::make_unique<LoadCellSource>(options);
}

}  // namespace touchstone::hil
