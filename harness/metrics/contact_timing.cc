#include "harness/metrics/contact_timing.h"

#include <fmt/format.h>

#include <cmath>

#include "harness/metrics/result.h"

namespace touchstone::metrics {

std::optional<ContactDetector::Event> ContactDetector::add(double t_s, double force_N) {
  std::optional<Event> event;
  const bool next = contact_ ? force_N > off_N_ : force_N >= on_N_;
  if (started_ && next != contact_) {
    const double level = next ? on_N_ : off_N_;
    const double fraction = force_N == last_N_ ? 1.0 : (level - last_N_) / (force_N - last_N_);
    event = Event{last_t_s_ + fraction * (t_s - last_t_s_), next};
  }
  contact_ = next;
  started_ = true;
  last_t_s_ = t_s;
  last_N_ = force_N;
  return event;
}

void EventMatcher::measured(double t_s) {
  ++measured_events_;
  waiting_measured_.push_back(t_s);
  match();
}

void EventMatcher::rendered(double t_s) {
  waiting_rendered_.push_back(t_s);
  match();
}

void EventMatcher::match() {
  while (!waiting_measured_.empty() && !waiting_rendered_.empty()) {
    const double shift = waiting_rendered_.front() - waiting_measured_.front();
    if (std::abs(shift) <= window_s_) {
      shift_.add(waiting_measured_.front(), shift);
      waiting_measured_.pop_front();
      waiting_rendered_.pop_front();
    } else if (shift > 0.0) {
      ++missed_;
      waiting_measured_.pop_front();
    } else {
      ++spurious_;
      waiting_rendered_.pop_front();
    }
  }
}

void EventMatcher::advance(double t_s) {
  for (; !waiting_measured_.empty() && waiting_measured_.front() < t_s - window_s_; waiting_measured_.pop_front())
    ++missed_;
  for (; !waiting_rendered_.empty() && waiting_rendered_.front() < t_s - window_s_; waiting_rendered_.pop_front())
    ++spurious_;
}

void EventMatcher::finish() {
  missed_ += waiting_measured_.size();
  spurious_ += waiting_rendered_.size();
  waiting_measured_.clear();
  waiting_rendered_.clear();
}

ContactTiming::ContactTiming(const MetricOptions& options)
    : floor_N_(options.force_floor_N),
      window_s_(options.match_window_s),
      measured_(options.force_floor_N),
      rendered_(options.force_floor_N),
      onsets_(options.match_window_s),
      releases_(options.match_window_s) {}

void ContactTiming::add(const MetricSample& sample) {
  const double measured_N = sample.f_measured_W_N.norm();
  const double rendered_N = sample.f_rendered_W_N.norm();
  input_.add(sample.t_s, measured_N + rendered_N);
  if (!std::isfinite(measured_N + rendered_N)) return;
  // An event lies between the previous sample and this one, so until this sample is in nothing may expire.
  if (const auto event = measured_.add(sample.t_s, measured_N)) {
    (event->onset ? onsets_ : releases_).measured(event->t_s);
  }
  if (const auto event = rendered_.add(sample.t_s, rendered_N)) {
    (event->onset ? onsets_ : releases_).rendered(event->t_s);
  }
  onsets_.advance(sample.t_s);
  releases_.advance(sample.t_s);
}

std::vector<MetricResult> ContactTiming::results() {
  std::vector<MetricResult> out;
  const std::string rule =
      fmt::format("force through {:.4g} N rising, {:.4g} N falling; events within {:.4g} s are the same", floor_N_,
                  0.5 * floor_N_, window_s_);
  const auto group = [&](EventMatcher& events, const std::string& one, const std::string& verb) {
    events.finish();
    const Moments& shift = events.shift();
    const auto add = [&](std::string name, std::string unit, std::string meaning, double value, const Moments& from) {
      // Without a matched event there is no shift; one bad sample makes every answer here invalid.
      const Moments& basis = input_.bad() > 0 ? input_ : from;
      out.push_back(make_result(std::move(name), std::move(unit), std::move(meaning), value, basis));
      if (out.back().status == MetricStatus::ok) out.back().note = rule;
      if (out.back().status == MetricStatus::missing) out.back().note = fmt::format("no {} was matched; {}", one, rule);
    };
    add(fmt::format("mean_{}_shift", one), "s",
        fmt::format("Mean of rendered minus measured {} of contact: above 0 the renderer {} late.", one, verb),
        shift.mean(), shift);
    add(fmt::format("max_{}_shift", one), "s", fmt::format("The shift of largest magnitude among the {}s.", one),
        shift.peak(), shift);
    if (out.back().status == MetricStatus::ok) out.back().t_s = shift.peak_t_s();
    add(fmt::format("{}s", one), "1", fmt::format("Measured {}s of contact.", one),
        static_cast<double>(events.events()), input_);
    add(fmt::format("missed_{}s", one), "1", fmt::format("Measured {}s that the renderer does not show.", one),
        static_cast<double>(events.missed()), input_);
    add(fmt::format("spurious_{}s", one), "1", fmt::format("Rendered {}s that were not measured.", one),
        static_cast<double>(events.spurious()), input_);
  };
  group(onsets_, "onset", "begins");
  group(releases_, "release", "ends");
  return out;
}

}  // namespace touchstone::metrics
