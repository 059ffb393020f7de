#include "harness/metrics/time_ranges.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>

#include "harness/base/error.h"

namespace touchstone::metrics {
namespace {

[[noreturn]] void refuse(std::string_view option, std::string_view text, std::string_view why) {
  throw UsageError(fmt::format("{}: \"{}\" {}; expected ranges of seconds such as 0:6,12:18, or even:6s or odd:6s",
                               option, text, why));
}

double seconds(std::string_view text, std::string_view option, std::string_view whole) {
  if (text.ends_with('s')) text.remove_suffix(1);
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size() || !std::isfinite(value)) {
    refuse(option, whole, fmt::format("has \"{}\" where a number of seconds was expected", text));
  }
  return value;
}

}  // namespace

TimeRanges TimeRanges::parse(std::string_view text, std::string_view option) {
  TimeRanges out;
  if (text == "all") return out;
  out.text_ = text;
  for (const auto& [word, odd] :
       {std::pair{std::string_view("even:"), false}, std::pair{std::string_view("odd:"), true}}) {
    if (!text.starts_with(word)) continue;
    out.block_s_ = seconds(text.substr(word.size()), option, text);
    out.odd_ = odd;
    if (out.block_s_ <= 0.0) refuse(option, text, "has blocks of no length");
    return out;
  }
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t end = std::min(text.find(',', begin), text.size());
    const std::string_view one = text.substr(begin, end - begin);
    const std::size_t colon = one.find(':');
    if (colon == std::string_view::npos) refuse(option, text, fmt::format("has \"{}\" without a colon", one));
    const double from = seconds(one.substr(0, colon), option, text);
    const double to = seconds(one.substr(colon + 1), option, text);
    if (!(from < to)) refuse(option, text, fmt::format("has \"{}\", which does not end after it starts", one));
    out.ranges_.emplace_back(from, to);
    begin = end + 1;
  }
  return out;
}

bool TimeRanges::contains(double t_s, double first_t_s) const {
  if (block_s_ > 0.0) {
    const double block = std::floor((t_s - first_t_s) / block_s_);
    return (std::fmod(block, 2.0) != 0.0) == odd_;
  }
  if (ranges_.empty()) return true;
  return std::ranges::any_of(ranges_, [t_s](const auto& range) { return range.first <= t_s && t_s < range.second; });
}

}  // namespace touchstone::metrics
