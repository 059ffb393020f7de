#include "script.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "harness/base/error.h"
#include "harness/base/random.h"
#include "synthetic/trajectories/path.h"

namespace touchstone::datasets {
using synthetic::minimum_jerk;

namespace {

std::uint64_t seed_of(std::uint64_t seed, std::uint64_t part) { return Random(seed).stream(part).next_u64(); }

// The path of least jerk between two states of no acceleration: Flash and Hogan 1985 with speeds given at both ends.
Vec3 quintic(const Vec3& p0, const Vec3& v0, const Vec3& p1, const Vec3& v1, double length_s, double s) {
  const double s3 = s * s * s;
  return p0 + minimum_jerk(s) * (p1 - p0) + length_s * (s + s3 * (-6.0 + s * (8.0 - 3.0 * s))) * v0 +
         length_s * (s3 * (-4.0 + s * (7.0 - 3.0 * s))) * v1;
}

}  // namespace

ScanScript::ScanScript(const Vec3& start, std::vector<Leg> legs, HandModel hand, std::uint64_t seed)
    : places_{start},
      starts_s_{0.0},
      hand_(hand),
      tremor_(seed_of(seed, 0), hand.tremor),
      slow_force_(seed_of(seed, 1), hand.pressing_variation, 0.05, 0.6),
      fast_force_(seed_of(seed, 2), hand.force_tremor) {
  if (legs.empty() || legs.front().touch != Touch::free || legs.back().touch != Touch::free) {
    throw UsageError("a scan begins and ends off the surface: its first and its last leg must be free");
  }
  for (const Leg& leg : legs) {
    if (!(leg.duration_s > 0.0))
      throw UsageError(fmt::format("a leg of a scan takes {} s; it must take some time", leg.duration_s));
    const double from = starts_s_.back();
    const double to = from + leg.duration_s;
    const bool joins = !windows_.empty() && windows_.back().touch == leg.touch && leg.touch != Touch::tap;
    if (joins) {
      windows_.back().to_s = to;
    } else {
      windows_.push_back({from, to, leg.touch});
    }
    starts_s_.push_back(to);
    places_.push_back(leg.touch == Touch::tap ? places_.back() : leg.target);
  }
  velocities_.assign(places_.size(), Vec3::Zero());
  for (std::size_t i = 1; i < legs.size(); ++i) {
    const bool passing = legs[i - 1].touch == Touch::slide && legs[i].touch == Touch::slide;
    if (passing) velocities_[i] = (places_[i + 1] - places_[i - 1]) / (starts_s_[i + 1] - starts_s_[i - 1]);
  }
}

ScanScript::Within ScanScript::within(double t_s) const {
  const auto window = std::find_if(windows_.begin(), windows_.end() - 1, [&](const Window& w) { return t_s < w.to_s; });
  const double length = window->to_s - window->from_s;
  const double in = t_s - window->from_s;
  const double ramp_s = std::min(hand_.ramp_s, 0.5 * length);
  return {&*window, in, minimum_jerk(in / ramp_s) * minimum_jerk((length - in) / ramp_s)};
}

Vec3 ScanScript::target(double t_s) const {
  const double t = std::clamp(t_s, 0.0, duration_s());
  const auto after = std::upper_bound(starts_s_.begin() + 1, starts_s_.end() - 1, t);
  const auto leg = static_cast<std::size_t>(after - starts_s_.begin()) - 1;
  const double length_s = starts_s_[leg + 1] - starts_s_[leg];
  Vec3 place = quintic(places_[leg], velocities_[leg], places_[leg + 1], velocities_[leg + 1], length_s,
                       (t - starts_s_[leg]) / length_s);
  // A tap is held still; elsewhere tremor lives between the windows' ends.
  const Within now = within(t);
  if (now.window->touch == Touch::tap) return place;
  return place + now.ramp * tremor_.at(t);
}

ScanScript::Press ScanScript::press(double t_s) const {
  const double t = std::clamp(t_s, 0.0, duration_s());
  const Within now = within(t);
  const double fraction = now.in_s / (now.window->to_s - now.window->from_s);
  if (now.window->touch == Touch::tap) {
    return {0.0, hand_.tap_N * std::pow(std::sin(std::numbers::pi * fraction), 2)};
  }
  if (now.window->touch == Touch::slide) {
    // An exponential keeps the force positive whatever the variation.
    return {0.0, now.ramp * hand_.pressing_N * std::exp(slow_force_.first_at(t) + fast_force_.first_at(t))};
  }
  // Down from the hover at the start, up to it at the end, an arc between contacts; meets the surface at some speed.
  const bool first = now.window == &windows_.front();
  const bool last = now.window == &windows_.back();
  if (first && last) return {hand_.hover_m, 0.0};
  const double phase = (first ? 0.5 : 0.0) + (first || last ? 0.5 : 1.0) * fraction;
  return {std::max(0.0, hand_.hover_m * std::sin(std::numbers::pi * phase)), 0.0};
}

}  // namespace touchstone::datasets
