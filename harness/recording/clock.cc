#include "harness/recording/clock.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "harness/base/error.h"

namespace touchstone::recording {
namespace {

constexpr std::size_t most_gaps = 1024;
constexpr double bins_per_octave = 512.0;

bool longer(const Gap& a, const Gap& b) { return a.length_s > b.length_s; }

}  // namespace

OnDuplicate parse_on_duplicate(std::string_view text) {
  if (text == "refuse") return OnDuplicate::refuse;
  if (text == "first") return OnDuplicate::first;
  if (text == "mean") return OnDuplicate::mean;
  throw UsageError(fmt::format("'{}' is no way to treat repeated times: use refuse, first or mean", text));
}

OnGap parse_on_gap(std::string_view text) {
  if (text == "refuse") return OnGap::refuse;
  if (text == "split") return OnGap::split;
  if (text == "keep") return OnGap::keep;
  throw UsageError(fmt::format("'{}' is no way to treat gaps: use refuse, split or keep", text));
}

std::string ClockReport::summary() const {
  return fmt::format("{} samples in {:.6g} s at {:.6g} Hz (median interval {:.6g} ms), jitter {:.3g} ms RMS, {} gap{}",
                     samples, duration_s(), nominal_rate_Hz, median_interval_s * 1e3, jitter_rms_s * 1e3, gap_count,
                     gap_count == 1 ? "" : "s");
}

void ClockMonitor::add(double t_s) {
  if (samples_++ == 0) {
    first_s_ = last_s_ = t_s;
    return;
  }
  const double interval = t_s - last_s_;
  shortest_s_ = samples_ == 2 ? interval : std::min(shortest_s_, interval);
  longest_s_ = std::max(longest_s_, interval);
  const int index = static_cast<int>(std::floor(std::log2(interval) * bins_per_octave));
  if (current_ == nullptr || index != current_index_) {
    current_ = &bins_[index];
    current_index_ = index;
  }
  Bin& bin = *current_;
  ++bin.count;
  const double difference = interval - bin.mean;
  bin.mean += difference / static_cast<double>(bin.count);
  bin.m2 += difference * (interval - bin.mean);
  keep_longest({samples_ - 2, last_s_, interval});
  last_s_ = t_s;
}

void ClockMonitor::keep_longest(const Gap& interval) {
  if (longest_.size() == most_gaps) {
    if (interval.length_s <= longest_.front().length_s) return;
    std::ranges::pop_heap(longest_, longer);
    longest_.pop_back();
  }
  longest_.push_back(interval);
  std::ranges::push_heap(longest_, longer);
}

ClockReport ClockMonitor::report(double gap_factor) const {
  ClockReport report;
  report.samples = samples_;
  report.start_s = first_s_;
  report.end_s = last_s_;
  report.gap_factor = gap_factor;
  report.duplicates = duplicates_;
  if (samples_ < 2) return report;
  const std::uint64_t intervals = samples_ - 1;
  std::uint64_t below = 0;
  for (const auto& [index, bin] : bins_) {
    below += bin.count;
    if (2 * below < intervals) continue;
    report.median_interval_s = bin.mean;
    break;
  }
  report.shortest_s = shortest_s_;
  report.longest_s = longest_s_;
  report.nominal_rate_Hz = 1.0 / report.median_interval_s;
  report.mean_rate_Hz = static_cast<double>(intervals) / (last_s_ - first_s_);
  const double limit = gap_factor * report.median_interval_s;
  double squares = 0.0;
  std::uint64_t counted = 0;
  for (const auto& [index, bin] : bins_) {
    if (bin.mean > limit) continue;
    const double offset = bin.mean - report.median_interval_s;
    squares += bin.m2 + static_cast<double>(bin.count) * offset * offset;
    counted += bin.count;
  }
  report.jitter_rms_s = counted > 0 ? std::sqrt(squares / static_cast<double>(counted)) : 0.0;
  for (const Gap& gap : longest_) {
    if (gap.length_s > limit) report.gaps.push_back(gap);
  }
  std::ranges::sort(report.gaps, {}, &Gap::after_sample);
  // Where the list is full, gaps are counted by the bins.
  report.gap_count = report.gaps.size() < most_gaps ? report.gaps.size() : intervals - counted;
  return report;
}

ClockReport examine_clock(const std::vector<double>& t_s, double gap_factor) {
  ClockMonitor monitor;
  for (std::size_t i = 0; i < t_s.size(); ++i) {
    if (!std::isfinite(t_s[i]) || (i > 0 && !(t_s[i] > t_s[i - 1]))) {
      throw BadData(fmt::format("time does not increase at sample {}: {} s", i, t_s[i]));
    }
    monitor.add(t_s[i]);
  }
  return monitor.report(gap_factor);
}

}  // namespace touchstone::recording
