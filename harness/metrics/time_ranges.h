// Parts of a recording by time: "0:6,12:18", or alternating blocks "even:6s" and "odd:6s", which count from the first
// sample's time (even: the first block, the third, ...). Ranges are half open, [start, end).
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace touchstone::metrics {

class TimeRanges {
 public:
  // Everything.
  TimeRanges() = default;
  // Throws UsageError naming `option` when the text makes no sense: a range that ends before it starts, a block of no
  // length, a number that is not finite.
  static TimeRanges parse(std::string_view text, std::string_view option);

  // `first_t_s`: time of the recording's first sample.
  [[nodiscard]] bool contains(double t_s, double first_t_s) const;
  [[nodiscard]] bool everything() const { return ranges_.empty() && block_s_ == 0.0; }
  // As parse() takes it; "all" for everything.
  [[nodiscard]] const std::string& text() const { return text_; }

 private:
  std::vector<std::pair<double, double>> ranges_;
  double block_s_ = 0.0;
  bool odd_ = false;
  std::string text_ = "all";
};

}  // namespace touchstone::metrics
