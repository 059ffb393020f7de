// When contact begins and ends, measured against rendered. The same rule for both: contact begins where the force's
// magnitude rises to the force floor, and ends where it falls to half of it (so that noise at the floor makes no
// events); the instants are interpolated linearly between samples. An onset of one is the same event as the earliest
// unmatched onset of the other within the match window; what finds no partner is missed (measured only) or spurious
// (rendered only). Contact that is there at the first sample has no onset.
// Results, for onset and release: mean_onset_shift, max_onset_shift [s, rendered minus measured: above 0 is late],
// onsets, missed_onsets, spurious_onsets [1].
#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

#include "harness/metrics/metric.h"
#include "harness/metrics/moments.h"

namespace touchstone::metrics {

// Turns a force magnitude over time into onsets and releases.
class ContactDetector {
 public:
  explicit ContactDetector(double floor_N) : on_N_(floor_N), off_N_(0.5 * floor_N) {}

  struct Event {
    double t_s;
    bool onset;
  };
  // An event between the previous sample and this one.
  std::optional<Event> add(double t_s, double force_N);

 private:
  double on_N_;
  double off_N_;
  bool started_ = false;
  bool contact_ = false;
  double last_t_s_ = 0.0;
  double last_N_ = 0.0;
};

// Pairs the events of two streams that arrive in order of time.
class EventMatcher {
 public:
  explicit EventMatcher(double window_s) : window_s_(window_s) {}

  void measured(double t_s);
  void rendered(double t_s);
  // No event before this time will come: what waited longer than the window has no partner.
  void advance(double t_s);
  void finish();

  [[nodiscard]] const Moments& shift() const { return shift_; }
  [[nodiscard]] std::uint64_t events() const { return measured_events_; }
  [[nodiscard]] std::uint64_t missed() const { return missed_; }
  [[nodiscard]] std::uint64_t spurious() const { return spurious_; }

 private:
  void match();

  double window_s_;
  std::deque<double> waiting_measured_;
  std::deque<double> waiting_rendered_;
  Moments shift_;
  std::uint64_t measured_events_ = 0;
  std::uint64_t missed_ = 0;
  std::uint64_t spurious_ = 0;
};

class ContactTiming final : public Metric {
 public:
  explicit ContactTiming(const MetricOptions& options);
  void add(const MetricSample& sample) override;
  [[nodiscard]] std::vector<MetricResult> results() override;

 private:
  double floor_N_;
  double window_s_;
  ContactDetector measured_;
  ContactDetector rendered_;
  EventMatcher onsets_;
  EventMatcher releases_;
  Moments input_;
};

}  // namespace touchstone::metrics
