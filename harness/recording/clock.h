// The sampling clock of a recording: its rate, jitter, gaps and repeated times, and what to do about them. Nothing is
// done silently: what was done is said in notes that reports print.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace touchstone::recording {

// Samples that repeat the time of the one before. Time that goes back is always refused.
enum class OnDuplicate : std::uint8_t {
  refuse,
  first,  // the first sample of each time stays
  mean,   // one sample with the mean position, force and torque, the mean direction of the quaternions
};

enum class OnGap : std::uint8_t {
  refuse,
  split,  // the samples stay, and each gap starts a segment: renderers are reset there
  keep,   // the samples stay; the gaps are reported
};

struct ClockPolicy {
  OnDuplicate on_duplicate = OnDuplicate::refuse;
  OnGap on_gap = OnGap::keep;
  double gap_factor = 5.0;  // an interval longer than this many median intervals is a gap; > 1
};

// "refuse", "first", "mean" and "refuse", "split", "keep"; throw UsageError listing them.
OnDuplicate parse_on_duplicate(std::string_view text);
OnGap parse_on_gap(std::string_view text);

struct Gap {
  std::uint64_t after_sample;  // the gap lies between this sample and the next
  double from_s;               // time of that sample
  double length_s;
};

struct ClockReport {
  std::uint64_t samples = 0;
  double start_s = 0.0;
  double end_s = 0.0;
  double median_interval_s = 0.0;  // within 0.1 %; exact to rounding for a steady clock
  double nominal_rate_Hz = 0.0;    // 1 / median interval
  double mean_rate_Hz = 0.0;       // intervals / duration, gaps included
  double shortest_s = 0.0;
  double longest_s = 0.0;
  double jitter_rms_s = 0.0;  // RMS deviation of the intervals from their median, gaps left out
  double gap_factor = 0.0;
  std::uint64_t gap_count = 0;
  std::vector<Gap> gaps;         // in order of time; the longest 1024 where there are more
  std::uint64_t duplicates = 0;  // samples left out or merged because their time was repeated

  [[nodiscard]] double duration_s() const noexcept { return end_s - start_s; }
  // "10001 samples in 10 s at 1000 Hz (median), jitter 0.0 us RMS, 0 gaps"
  [[nodiscard]] std::string summary() const;
};

// Builds the report sample by sample in bounded memory: intervals are counted in logarithmic bins 0.14 % wide that keep
// their mean and variance (Welford 1962).
class ClockMonitor {
 public:
  // Times must be strictly increasing.
  void add(double t_s);
  void count_duplicate() noexcept { ++duplicates_; }
  [[nodiscard]] ClockReport report(double gap_factor) const;

 private:
  struct Bin {
    std::uint64_t count = 0;
    double mean = 0.0;
    double m2 = 0.0;  // sum of squared deviations from the mean
  };
  void keep_longest(const Gap& interval);

  std::uint64_t samples_ = 0;
  double first_s_ = 0.0;
  double last_s_ = 0.0;
  double shortest_s_ = 0.0;
  double longest_s_ = 0.0;
  std::map<int, Bin> bins_;
  int current_index_ = 0;
  Bin* current_ = nullptr;
  std::vector<Gap> longest_;  // a heap, shortest first, of bounded size
  std::uint64_t duplicates_ = 0;
};

// The report of times that are in memory already. Throws BadData when they do not increase strictly.
ClockReport examine_clock(const std::vector<double>& t_s, double gap_factor = ClockPolicy{}.gap_factor);

}  // namespace touchstone::recording
