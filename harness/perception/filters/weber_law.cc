#include "harness/perception/filters/weber_law.h"

#include <algorithm>
#include <cmath>

namespace touchstone::perception {

double WeberLaw::fraction(double intensity) const noexcept {
  return std::abs(intensity) > breakpoint ? fraction_above : fraction_below;
}

double WeberLaw::just_noticeable_difference(double intensity) const noexcept {
  const double magnitude = std::abs(intensity);
  return magnitude < absolute_threshold ? absolute_threshold : fraction(intensity) * magnitude;
}

double WeberLaw::steps(double intensity) const noexcept { return NoticeableSteps(*this)(intensity); }

NoticeableSteps::NoticeableSteps(const WeberLaw& law) noexcept
    : threshold_(law.absolute_threshold),
      breakpoint_(law.breakpoint),
      per_log_below_(1.0 / std::log1p(law.fraction_below)),
      per_log_above_(1.0 / std::log1p(law.fraction_above)),
      log_threshold_(std::log(law.absolute_threshold)),
      at_breakpoint_(1.0 + std::log(law.breakpoint / law.absolute_threshold) * per_log_below_ -
                     std::log(law.breakpoint) * per_log_above_) {}

double NoticeableSteps::operator()(double intensity) const noexcept {
  const double magnitude = std::abs(intensity);
  if (magnitude <= threshold_) return intensity / threshold_;
  const double log_magnitude = std::log(magnitude);
  const double steps = magnitude <= breakpoint_ ? 1.0 + (log_magnitude - log_threshold_) * per_log_below_
                                                : at_breakpoint_ + log_magnitude * per_log_above_;
  return std::copysign(steps, intensity);
}

}  // namespace touchstone::perception
