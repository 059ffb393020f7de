#include "record/envelope_clock.h"

namespace touchstone::hil {

void EnvelopeClock::add(std::uint64_t number, double arrival_s) {
  if (samples_++ == 0) first_ = number;
  const auto from_first = static_cast<double>(number - first_);
  mean_from_first_ += (from_first - mean_from_first_) / static_cast<double>(samples_);
  // Andrew's monotone chain: corners that lie on or above the line to the new point are none any more.
  while (hull_.size() >= 2) {
    const Corner &a = hull_[hull_.size() - 2], &b = hull_.back();
    const double before = (b.arrival_s - a.arrival_s) * static_cast<double>(number - b.number),
                 after = (arrival_s - b.arrival_s) * static_cast<double>(b.number - a.number);
    if (before < after) break;
    hull_.pop_back();
  }
  hull_.push_back({number, arrival_s});
}

EnvelopeClock::Line EnvelopeClock::line() const {
  // The edge above the mean; corners are never all on one side of it.
  std::size_t right = 1;
  while (right + 1 < hull_.size() && static_cast<double>(hull_[right].number - first_) < mean_from_first_) ++right;
  const Corner &a = hull_[right - 1], &b = hull_[right];
  return {(b.arrival_s - a.arrival_s) / static_cast<double>(b.number - a.number), a.number, a.arrival_s};
}

}  // namespace touchstone::hil
