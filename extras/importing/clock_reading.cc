#include "clock_reading.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "harness/stats/quantile.h"

namespace touchstone::importing {
namespace {

constexpr double slowest_Hz = 1.0, fastest_Hz = 1e6;
// Of the seconds since 1970 that this program may see: 2001 to 2096.
constexpr double earliest_s = 1e9, latest_s = 4e9;
constexpr std::array<std::pair<double, const char*>, 4> scales{{{1.0, "s"}, {1e-3, "ms"}, {1e-6, "us"}, {1e-9, "ns"}}};

// The middle of the steps that go forward; zero where none does.
double usual_step(const std::vector<double>& values) {
  std::vector<double> steps;
  for (std::size_t i = 1; i < values.size(); ++i) {
    if (values[i] > values[i - 1]) steps.push_back(values[i] - values[i - 1]);
  }
  return steps.empty() ? 0.0 : stats::upper_median(steps);
}

// Whether it goes back in more than a few places, as where a recording was begun anew.
bool goes_back(const std::vector<double>& values) {
  std::size_t back = 0;
  for (std::size_t i = 1; i < values.size(); ++i) back += values[i] < values[i - 1] ? 1 : 0;
  constexpr std::size_t one_in = 10;
  return one_in * back > values.size();
}

double first_number(const std::vector<double>& values) {
  const auto found = std::ranges::find_if(values, [](double v) { return std::isfinite(v); });
  return found == values.end() ? 0.0 : *found;
}

std::optional<double> scale_since_1970(double first) {
  for (const auto& [scale, unit] : scales) {
    if (first * scale >= earliest_s && first * scale < latest_s) return scale;
  }
  return std::nullopt;
}

const char* unit_of_scale(double scale) {
  for (const auto& [known, unit] : scales) {
    if (known == scale) return unit;
  }
  return "another unit";
}

bool agrees(double rate_Hz, double stated_Hz) {
  constexpr double near = 0.1;
  return std::abs(rate_Hz - stated_Hz) <= near * stated_Hz;
}

}  // namespace

bool counts_rows(const std::vector<double>& values) {
  for (std::size_t i = 1; i < values.size(); ++i) {
    if (values[i] != values[i - 1] + 1.0) return false;
  }
  return values.size() > 1;
}

bool is_since_1970(const std::vector<double>& values) {
  const double first = first_number(values), step = usual_step(values);
  const auto scale = scale_since_1970(first);
  return scale && step > 0.0 && step * *scale <= 1.0 / slowest_Hz && step * *scale >= 1.0 / fastest_Hz;
}

ClockReading read_clock(const std::vector<double>& values, const ColumnName& name, const HeadFacts& head) {
  const double step = usual_step(values);
  if (!(step > 0.0)) return {std::nullopt, "its numbers do not increase", true};
  if (goes_back(values)) return {std::nullopt, "its numbers go back", true};
  const auto rate = [&](double scale) { return 1.0 / (step * scale); };
  const auto sensible = [&](double scale) {
    constexpr double rounding = 1e-9;
    return rate(scale) >= slowest_Hz * (1.0 - rounding) && rate(scale) <= fastest_Hz * (1.0 + rounding);
  };
  std::optional<double> scale = name.factor;
  std::string reason = scale ? fmt::format("by its name, in {}", name.unit) : "";
  if (!scale) {
    scale = scale_since_1970(first_number(values));
    if (scale) reason = fmt::format("its numbers are {} since 1970", unit_of_scale(*scale));
  }
  std::string possible;
  if (!scale && head.rate_Hz) {
    for (const auto& [one, unit] : scales) {
      if (!scale && agrees(rate(one), *head.rate_Hz)) scale = one;
    }
    if (scale) reason = fmt::format("in {}, for '{}' stands above it", unit_of_scale(*scale), head.rate_line);
  }
  if (!scale) {
    // Steps of whole numbers are of any unit; those of a fraction of a second are of seconds, down to the slowest rate
    // at which half milliseconds are not likelier.
    constexpr double longest_step_s = 0.25;
    if (step <= longest_step_s && sensible(1.0)) {
      scale = 1.0;
      reason = fmt::format("no unit is named; s is assumed, for it steps as a clock in s does: {:.4g} Hz", rate(1.0));
    }
    for (const auto& [one, unit] : scales) {
      if (sensible(one)) possible += fmt::format("{}{} ({:.4g} Hz)", possible.empty() ? "" : ", ", unit, rate(one));
    }
  }
  if (!scale) {
    return {std::nullopt,
            fmt::format("the file names no unit, and it steps by {:.6g}: {}", step,
                        possible.empty() ? "no unit gives a rate between 1 Hz and 1 MHz" : "it may be in " + possible)};
  }
  if (head.rate_Hz && !agrees(rate(*scale), *head.rate_Hz)) {
    return {std::nullopt,
            fmt::format("{}, which is {:.6g} Hz, but '{}' stands above it", reason, rate(*scale), head.rate_line)};
  }
  if (!sensible(*scale)) {
    return {std::nullopt,
            fmt::format("{}, its rate would be {:.6g} Hz, which is not between 1 Hz and 1 MHz", reason, rate(*scale))};
  }
  return {scale, reason};
}

}  // namespace touchstone::importing
