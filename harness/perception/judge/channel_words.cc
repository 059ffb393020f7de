#include "harness/perception/judge/channel_words.h"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

namespace touchstone::perception {

void describe_slow(ChannelEvidence& evidence, const SlowEvidence& found, const Thresholds& thresholds) {
  const double depth_mm = 1e3 * found.depth_m;
  const double change = found.real > 0.0 ? 100.0 * (found.rendered / found.real - 1.0) : 0.0;
  switch (evidence.channel) {
    case Channel::force:
      evidence.what = fmt::format("{:.3g} N instead of {:.3g} N at {:.3g} mm ({:+.3g} %)", found.rendered, found.real,
                                  depth_mm, change);
      evidence.remedy = fmt::format("bring the force at {:.3g} mm to within {:.2g} N of {:.3g} N", depth_mm,
                                    std::abs(found.rendered - found.real) / std::max(1e-12, found.jnd), found.real);
      break;
    case Channel::stiffness:
      evidence.what = fmt::format("{:.4g} N/m instead of {:.4g} N/m ({:+.3g} %)", found.rendered, found.real, change);
      evidence.remedy = fmt::format("choose a stiffness between {:.4g} and {:.4g} N/m",
                                    found.real / (1.0 + thresholds.stiffness_fraction),
                                    found.real * (1.0 + thresholds.stiffness_fraction));
      break;
    case Channel::rate:
      if (found.delay) {
        evidence.what = fmt::format("the force comes {:.3g} ms after the motion instead of {:.3g} ms",
                                    1e3 * found.rendered, 1e3 * found.real);
        evidence.remedy =
            fmt::format("bring the delay to within {:.3g} ms of {:.3g} ms", 1e3 * thresholds.delay_s, 1e3 * found.real);
        break;
      }
      evidence.what = fmt::format(
          "{:+.3g} N with the speed of pressing instead of {:+.3g} N at {:.3g} mm: {}", found.rendered, found.real,
          depth_mm, found.rendered < found.real ? "force behind motion, or too little damping" : "too much damping");
      evidence.remedy = fmt::format("lower the delay, or match the damping, by a factor of {:.2g}", evidence.jnd);
      break;
    case Channel::direction:
      evidence.what = fmt::format("the force points {:.3g} degrees away", 180.0 / std::numbers::pi * found.rendered);
      evidence.remedy =
          fmt::format("turn the force to within {:.3g} degrees", 180.0 / std::numbers::pi * thresholds.direction_rad);
      break;
    case Channel::friction:
      evidence.what =
          fmt::format("friction of {:.3g} N instead of {:.3g} N at {:.3g} mm", found.rendered, found.real, depth_mm);
      evidence.remedy = fmt::format("bring friction to within {:.2g} N of {:.3g} N",
                                    std::abs(found.rendered - found.real) / std::max(1e-12, found.jnd), found.real);
      break;
    case Channel::vibration:
    case Channel::transient:
    case Channel::position:
    case Channel::air:
      break;
  }
}

void describe_vibration(ChannelEvidence& evidence, const VibrationDifference& found, const Thresholds& thresholds) {
  const bool burst = evidence.channel == Channel::transient;
  const char* const which = burst          ? "burst after contact"
                            : found.in_air ? "vibration in free air"
                                           : "vibration in contact";
  constexpr double another_pitch = 0.1;  // of the fraction that is noticed
  if (found.pitch && std::abs(std::log(found.pitch->rendered_Hz / found.pitch->real_Hz)) >
                         another_pitch * std::log1p(thresholds.frequency_fraction)) {
    evidence.what =
        fmt::format("{} of {:.2g} N near {:.3g} Hz instead of {:.2g} N near {:.3g} Hz", which, found.pitch->rendered_N,
                    found.pitch->rendered_Hz, found.pitch->real_N, found.pitch->real_Hz);
    evidence.remedy = fmt::format("bring the frequency of the {} to within {:.2g} % of {:.3g} Hz", which,
                                  100.0 * thresholds.frequency_fraction, found.pitch->real_Hz);
    return;
  }
  evidence.what = fmt::format("{} near {:.3g} Hz: {:.2g} N instead of {:.2g} N (felt from {:.2g} N on)", which,
                              found.frequency_Hz, found.rendered_N, found.real_N, found.threshold_N);
  evidence.remedy = fmt::format("bring the {} near {:.3g} Hz to within {:.2g} N of {:.2g} N", which, found.frequency_Hz,
                                found.allowed_N, found.real_N);
}

void describe_air(ChannelEvidence& evidence, const AirDifference& found, const Thresholds& thresholds) {
  if (found.cue == AirCue::drag || found.cue == AirCue::mass) {
    const bool drag = found.cue == AirCue::drag;
    evidence.what = fmt::format("{} of {:.2g} {} instead of {:.2g} {} in free air", drag ? "a drag" : "a mass",
                                found.rendered, drag ? "N s/m" : "kg", found.real, drag ? "N s/m" : "kg");
    evidence.remedy = fmt::format("bring it to within {:.0f} % of {:.2g} {}", 100.0 * thresholds.stiffness_fraction,
                                  found.real, drag ? "N s/m" : "kg");
    return;
  }
  evidence.what = fmt::format("{} {:.2g} N instead of {:.2g} N (felt from {:.2g} N on)",
                              found.cue == AirCue::release ? "leaving contact pulls with" : "a force in free air of",
                              found.rendered, found.real, thresholds.force.absolute_threshold);
  evidence.remedy = fmt::format("bring it to within {:.2g} N of {:.2g} N",
                                thresholds.force.just_noticeable_difference(found.real), found.real);
}

std::string why_unknown(Channel channel) {
  switch (channel) {
    case Channel::force:
    case Channel::rate:
      return "the two recordings press to no common depth";
    case Channel::stiffness:
      return "the force does not grow with depth over the common depths";
    case Channel::direction:
      return "the force is too small to have a direction";
    case Channel::friction:
      return "at no common depth do both recordings slide to and fro, or both one way";
    case Channel::vibration:
      return "a recording stays in contact for less than 64 ms at a time, or is too slow";
    case Channel::transient:
      return "a recording begins contact from free air fewer than three times";
    case Channel::position:
      return "a recording shows no first contact";
    case Channel::air:
      return "a recording shows less than 0.2 s of free air and fewer than two releases";
  }
  return {};
}

}  // namespace touchstone::perception
