#include "harness/perception/judge/judge.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "harness/base/error.h"
#include "harness/perception/judge/channel_words.h"
#include "harness/perception/judge/moments.h"
#include "harness/perception/judge/slow_channels.h"
#include "harness/stats/distributions.h"
#include "harness/stats/quantile.h"

namespace touchstone::perception {

std::string_view name_of(Channel channel) {
  constexpr std::string_view names[channel_count] = {"force",     "stiffness", "rate",     "direction", "friction",
                                                     "vibration", "transient", "position", "air"};
  return names[static_cast<std::size_t>(channel)];
}

std::string_view name_of(Verdict verdict) {
  switch (verdict) {
    case Verdict::noticed:
      return "noticed";
    case Verdict::not_noticed:
      return "not-noticed";
    case Verdict::cannot_tell:
      break;
  }
  return "cannot-tell";
}

std::string told_share(const Judgement& judgement) {
  return judgement.verdict == Verdict::cannot_tell ? "-"
                                                   : fmt::format("{:.0f} %", 100.0 * judgement.noticed_probability);
}

namespace {

constexpr double same_motion_m = 1e-12;
// What straight lines between knots, smoothed positions and bands leave without any noise: standard error as a share
// and in JND, as `touchstone experiment perception` shows it of cases whose answer is exact.
constexpr double method_share = 0.03;
constexpr double method_jnd = 0.02;
constexpr double worth_naming_jnd = 0.5;  // less is guessed in two of three trials

bool moves_alike(const JudgedProcess& a, const JudgedProcess& b) {
  if (a.felt.size() != b.felt.size() || a.felt.rate_Hz != b.felt.rate_Hz) return false;
  for (std::size_t i = 0; i < a.felt.size(); ++i) {
    if (!(std::abs(a.prompt_depth_m[i] - b.prompt_depth_m[i]) <= same_motion_m)) return false;
  }
  return a.prompt_slide_x == b.prompt_slide_x;
}

ChannelEvidence& of(Judgement& judgement, Channel channel) {
  return judgement.channels[static_cast<std::size_t>(channel)];
}

// What the declared instrument may do to the force and to the depth that goes with it, in JND of the channel.
double declared_jnd(const SlowEvidences& slow, const Response& real, const DeclaredNoise& declared,
                    const std::vector<double>& depths_m, const Thresholds& thresholds) {
  if (depths_m.empty()) return 0.0;
  const auto& stiffness = slow[static_cast<std::size_t>(SlowChannel::stiffness)];
  if (!stiffness.known) return 0.0;
  const double force_N = at_depth(real.curves.normal_N, depths_m.front(), real.grid);
  const double error_N = stiffness.real * declared.geometry_m;
  if (!(force_N > 0.0)) return 0.0;
  const NoticeableSteps steps(thresholds.force);
  return steps(force_N + error_N) - steps(force_N);
}

Response scaled(Response response, double factor) {
  const auto scale = [factor](ResponseCurves& curves) {
    for (auto* curve :
         {&curves.normal_N, &curves.normal_N_s_per_m, &curves.side_N[0], &curves.side_N[1], &curves.friction_N}) {
      for (double& value : *curve) value *= factor;
    }
  };
  scale(response.curves);
  for (auto& without : response.without) scale(without);
  return response;
}

void tell_unexplored(Judgement& judgement, const PlaceMap& map) {
  if (!map.uneven) return;
  const auto unknown = std::count_if(map.cells.begin(), map.cells.end(), [](const auto& cell) { return !cell.known; });
  if (unknown == 0) return;
  const auto first = std::find_if(map.cells.begin(), map.cells.end(), [](const auto& cell) { return !cell.known; });
  const Vec3 at_mm = 1e3 * first->centre_m;
  const bool friction = &map == &judgement.places.friction;
  judgement.remarks.push_back(
      fmt::format("the {} differs from place to place, and at {} of {} places these recordings cannot tell: one of "
                  "them {} for less than 0.06 s; slide {} them in both, the first lies near ({:.3g}, {:.3g}, "
                  "{:.3g}) mm",
                  map.quantity, unknown, map.cells.size(), friction ? "slid one way only there, or" : "was there",
                  friction ? "to and fro over" : "over", at_mm.x(), at_mm.y(), at_mm.z()));
}

// What differs from place to place cancels in a curve over depth.
void name_place(ChannelEvidence& evidence, const PlaceMap& map, double other_error) {
  const PlaceDifference* const place = map.strongest();
  if (place == nullptr || !evidence.known) return;
  const double reach = map.reach(*place);
  // Of two that differ evenly, the curve over depth says it best.
  const double curve_jnd = evidence.jnd - (map.uneven ? normal95 * evidence.standard_error : 0.0);
  if (!(place->jnd - reach > curve_jnd)) return;
  evidence.jnd = place->jnd;
  evidence.standard_error = std::hypot(reach / normal95, other_error);
  evidence.what = describe_place(map, *place);
  evidence.remedy = evidence.what;
  evidence.depth_m = place->depth_m;
}

void fill_slow(Judgement& judgement, const JudgedProcess& real, const JudgedProcess& rendered,
               const JudgeOptions& options) {
  judgement.places = place_maps(real, rendered, judgement.same_motion, options.thresholds);
  // Of an object that differs from place to place, what both explored is compared.
  const PlaceMap& places = judgement.places.force;
  const Response r = places.uneven ? scaled(*real.response, places.real_mean) : *real.response;
  const Response c = places.uneven ? scaled(*rendered.response, places.rendered_mean) : *rendered.response;
  tell_unexplored(judgement, places);
  tell_unexplored(judgement, judgement.places.friction);
  const auto depths = common_depths_m(r, c);
  const auto slow = slow_evidence(r, r.curves, c, c.curves, judgement.same_motion, depths, options.thresholds);
  const auto errors = slow_errors(r, c, judgement.same_motion, depths, options.thresholds);
  constexpr Channel order[slow_channels] = {Channel::force, Channel::stiffness, Channel::rate, Channel::direction,
                                            Channel::friction};
  for (std::size_t e = 0; e < slow_channels; ++e) {
    ChannelEvidence& own = of(judgement, order[e]);
    own.known = slow[e].known;
    own.jnd = slow[e].jnd;
    own.standard_error = std::hypot(errors[e], slow[e].by_hand);
    own.depth_m = slow[e].depth_m;
    if (own.known) describe_slow(own, slow[e], options.thresholds);
    if (!own.known) own.why = why_unknown(own.channel);
  }
  ChannelEvidence& force = of(judgement, Channel::force);
  const double declared = declared_jnd(slow, r, options.declared, depths, options.thresholds);
  force.standard_error = std::hypot(force.standard_error, declared);
  name_place(force, places, declared);
  name_place(of(judgement, Channel::friction), judgement.places.friction, 0.0);
}

void fill_fast(Judgement& judgement, const JudgedProcess& real, const JudgedProcess& rendered,
               const JudgeOptions& options) {
  // White over all axes unless a time constant limits its band: then its power lies below 1 / (4 tau).
  const double band_Hz = options.declared.force_time_constant_s > 0.0
                             ? std::min(0.5 * real.felt.rate_Hz, 0.25 / options.declared.force_time_constant_s)
                             : 0.5 * real.felt.rate_Hz;
  const double noise = 3.0 * options.declared.force_N * options.declared.force_N / band_Hz;
  const auto fill = [&](Channel channel, const VibrationDifference& found) {
    ChannelEvidence& own = of(judgement, channel);
    own.known = found.known;
    own.depth_m = std::numeric_limits<double>::quiet_NaN();
    if (!found.known) {
      own.why = why_unknown(channel);
      return;
    }
    own.jnd = found.jnd;
    own.measured_jnd = found.measured_jnd;
    own.standard_error = found.standard_error;
    describe_vibration(own, found, options.thresholds);
    if (found.by_hand) {
      own.would_tell = fmt::format(
          "contact begins at {:.2g} m/s in the real recording and {:.2g} m/s in the other: meet "
          "the object at like speeds",
          real.fast.onset_speed_m_per_s, rendered.fast.onset_speed_m_per_s);
    }
    if (found.by_sliding) {
      const auto typical = [](const std::vector<double>& x) { return x.empty() ? 0.0 : stats::median(x); };
      own.would_tell = fmt::format(
          "the tip slides at {:.2g} m/s under {:.2g} N in the real recording, at {:.2g} m/s under {:.2g} N "
          "in the other: slide at like speeds and loads",
          typical(real.fast.contact.slide_m_per_s), typical(real.fast.contact.load_N),
          typical(rendered.fast.contact.slide_m_per_s), typical(rendered.fast.contact.load_N));
    }
  };
  fill(Channel::vibration, vibration_difference(real.fast, rendered.fast, noise, options.thresholds));
  fill(Channel::transient, transient_difference(real.fast, rendered.fast, options.thresholds));
}

void fill_position(Judgement& judgement, const JudgedProcess& real, const JudgedProcess& rendered,
                   const JudgeOptions& options) {
  ChannelEvidence& own = of(judgement, Channel::position);
  own.depth_m = 0.0;
  own.known = real.contact.begins_free && rendered.contact.begins_free;
  if (!own.known) {
    own.why = why_unknown(Channel::position);
    return;
  }
  const double apart_m = rendered.contact.depth_m - real.contact.depth_m;
  own.jnd = std::abs(apart_m) / options.thresholds.position_m;
  own.standard_error = options.declared.geometry_m / options.thresholds.position_m;
  own.what = fmt::format("contact begins {:.3g} mm {}", 1e3 * std::abs(apart_m), apart_m > 0.0 ? "deeper" : "earlier");
  if (own.jnd > 1.0)
    own.remedy = fmt::format("bring first contact to within {:.3g} mm", 1e3 * options.thresholds.position_m);
}

void fill_air(Judgement& judgement, const JudgedProcess& real, const JudgedProcess& rendered,
              const JudgeOptions& options) {
  ChannelEvidence& own = of(judgement, Channel::air);
  const AirDifference found = air_difference(real.air, rendered.air, judgement.same_motion, options.thresholds);
  own.known = found.known;
  own.depth_m = std::numeric_limits<double>::quiet_NaN();
  if (!own.known) {
    own.why = why_unknown(Channel::air);
    return;
  }
  own.jnd = found.jnd;
  own.standard_error = found.standard_error;
  describe_air(own, found, options.thresholds);
}

bool is_fast(Channel channel) { return channel == Channel::vibration || channel == Channel::transient; }

// Noise alone makes a magnitude: its square is larger by the variance, which is taken off.
void take_noise_off(ChannelEvidence& own, const NoiseFloor& floor) {
  const auto index = static_cast<std::size_t>(own.channel);
  const double repeats_jnd = index < floor.jnd.size() ? floor.jnd[index] : 0.0;
  if (!is_fast(own.channel) || repeats_jnd > own.standard_error) {
    own.standard_error = std::max(own.standard_error, repeats_jnd);
    own.jnd = std::sqrt(std::max(0.0, own.jnd * own.jnd - own.standard_error * own.standard_error));
  }
  own.standard_error = std::hypot(own.standard_error, method_share * own.jnd + method_jnd);
  own.probability = forced_choice_probability(own.jnd);
  if (own.jnd <= 1.0) own.remedy.clear();
}

// Few repeats, and few blocks, leave the spread itself uncertain.
double quantile_of(const NoiseFloor& floor) {
  return stats::student_t_975(static_cast<double>(floor.repeats + jackknife_blocks - 1));
}

// d' of everything and its interval, on the scale of the square, where the parts add up: how far the square of each
// part reaches if the part itself is off by its quantile.
void combine(Judgement& judgement, const NoiseFloor& floor, const std::vector<Channel>& without) {
  const ChannelEvidence& force = of(judgement, Channel::force);
  const ChannelEvidence& stiffness = of(judgement, Channel::stiffness);
  const double quantile = quantile_of(floor);
  judgement.above_noise = false;
  judgement.gives_away.reset();
  double square = 0.0;
  double certain = 0.0;  // of what is above noise: the rest may be nothing
  double below = 0.0;
  double above = 0.0;
  double strongest = 0.0;
  for (const auto& own : judgement.channels) {
    if (!own.known || std::find(without.begin(), without.end(), own.channel) != without.end()) continue;
    if (own.jnd > std::max(strongest, worth_naming_jnd) && own.measured_jnd > quantile * own.standard_error) {
      strongest = own.jnd;
      judgement.gives_away = own.channel;
    }
    const bool weaker_cue = (own.channel == Channel::force && stiffness.known && stiffness.jnd > force.jnd) ||
                            (own.channel == Channel::stiffness && force.known && force.jnd >= stiffness.jnd);
    if (weaker_cue) continue;
    square += own.jnd * own.jnd;
    const double reach = quantile * own.standard_error;
    above += std::pow(std::pow(own.measured_jnd + reach, 2) - own.jnd * own.jnd, 2);
    const double least = own.measured_jnd - reach;
    if (!(least > 0.0)) continue;
    judgement.above_noise = true;
    certain += own.jnd * own.jnd;
    below += std::pow(own.jnd * own.jnd - least * least, 2);
  }
  judgement.d_prime = std::sqrt(square);
  judgement.d_prime_low95 = std::sqrt(std::max(0.0, certain - std::sqrt(below)));
  judgement.d_prime_high95 = std::sqrt(square + std::sqrt(above));
  judgement.noticed_probability = forced_choice_probability(judgement.d_prime);
  judgement.noticed_low95 = forced_choice_probability(judgement.d_prime_low95);
  judgement.noticed_high95 = forced_choice_probability(judgement.d_prime_high95);
  if (judgement.d_prime_low95 > 1.0) {
    judgement.verdict = Verdict::noticed;
  } else if (judgement.d_prime_high95 < 1.0) {
    judgement.verdict = Verdict::not_noticed;
  } else {
    judgement.verdict = Verdict::cannot_tell;
  }
}

// Where these recordings cannot tell: the channels that may differ by more than one JND, each with what would tell.
void tell_what_is_open(Judgement& judgement, const NoiseFloor& floor, const JudgeOptions& options) {
  constexpr double decides_jnd = 0.7;  // an interval that leaves room for the other channels
  if (judgement.verdict != Verdict::cannot_tell) return;
  std::vector<Channel> without = options.without;
  std::string text;
  for (const auto& own : judgement.channels) {
    if (!own.known || std::find(without.begin(), without.end(), own.channel) != without.end()) continue;
    const double reach = quantile_of(floor) * own.standard_error;
    if (own.measured_jnd + reach < 1.0) continue;
    std::string would_tell = own.would_tell;
    if (would_tell.empty() && reach > decides_jnd) {
      const double longer = std::pow(reach / decides_jnd, 2);
      would_tell =
          fmt::format("about {:.0f} times as much recording of both would tell", std::max(2.0, std::round(longer)));
    }
    text += fmt::format("{}{} may differ by up to {:.2g} JND{}", text.empty() ? "" : "; ", name_of(own.channel),
                        own.measured_jnd + reach, would_tell.empty() ? "" : fmt::format(" ({})", would_tell));
    without.push_back(own.channel);
  }
  if (text.empty()) return;
  Judgement rest = judgement;
  combine(rest, floor, without);
  judgement.open =
      fmt::format("these recordings cannot tell: {}. By the other channels: {}", text, name_of(rest.verdict));
}

// All but the combination: what noise_floor() needs.
Judgement compare(const JudgedProcess& real, const JudgedProcess& rendered, const JudgeOptions& options) {
  Judgement judgement;
  for (std::size_t c = 0; c < channel_count; ++c) {
    judgement.channels.emplace_back();
    judgement.channels.back().channel = static_cast<Channel>(c);
  }
  judgement.same_motion = moves_alike(real, rendered);
  if (options.keep_moments || judgement.same_motion)
    judgement.moments = felt_moments(real, rendered, judgement.same_motion, options.thresholds);
  fill_slow(judgement, real, rendered, options);
  fill_fast(judgement, real, rendered, options);
  fill_position(judgement, real, rendered, options);
  fill_air(judgement, real, rendered, options);
  for (auto& own : judgement.channels) {
    if (!is_fast(own.channel)) own.measured_jnd = own.jnd;
  }
  return judgement;
}

void check_processes(const JudgedProcess& real, const JudgedProcess& rendered) {
  for (const auto* process : {&real, &rendered}) {
    if (!process->response) {
      throw BadData(
          fmt::format("{}: never presses into anything along the direction of pressing; give the direction "
                      "(--direction), or check the sign of the force",
                      process->felt.name));
    }
  }
  if (real.response->grid.spacing_m != rendered.response->grid.spacing_m)
    throw UsageError("the responses of a pair need one grid of depths");
}

}  // namespace

NoiseFloor noise_floor(const JudgedProcess& real, const std::vector<JudgedProcess>& repeats,
                       const JudgeOptions& options) {
  NoiseFloor floor;
  floor.repeats = repeats.size();
  if (repeats.empty()) return floor;
  floor.jnd.assign(channel_count, 0.0);
  std::vector<double> seen(channel_count, 0.0);
  for (const auto& repeat : repeats) {
    check_processes(real, repeat);
    const auto compared = compare(real, repeat, options);
    for (std::size_t c = 0; c < channel_count; ++c) {
      if (!compared.channels[c].known) continue;
      floor.jnd[c] += compared.channels[c].measured_jnd * compared.channels[c].measured_jnd;
      seen[c] += 1.0;
    }
  }
  for (std::size_t c = 0; c < channel_count; ++c)
    floor.jnd[c] = seen[c] > 0.0 ? std::sqrt(floor.jnd[c] / seen[c]) : 0.0;
  return floor;
}

Judgement judge(const JudgedProcess& real, const JudgedProcess& rendered, const NoiseFloor& floor,
                const JudgeOptions& options) {
  check_processes(real, rendered);
  Judgement judgement = compare(real, rendered, options);
  for (auto& own : judgement.channels) {
    if (own.known) take_noise_off(own, floor);
  }
  combine(judgement, floor, options.without);
  tell_what_is_open(judgement, floor, options);
  judgement.noticed_share = noticed_share(judgement.moments);
  if (!options.keep_moments) judgement.moments.clear();
  if (real.shape) {
    judgement.remarks.emplace_back(
        "the object is curved or slopes against the direction of pressing: depth is measured from the paraboloid that "
        "its forces show, where the real recording explored it");
  }
  const double nyquist = std::min(real.fast.nyquist_Hz, rendered.fast.nyquist_Hz);
  if (nyquist < 1000.0) {
    const auto& centres = band_centres_Hz();
    const auto beyond = std::find_if(centres.begin(), centres.end(),
                                     [nyquist](double centre) { return centre * half_band_ratio > nyquist; });
    judgement.remarks.push_back(
        fmt::format("vibration is judged up to {:.4g} Hz, in whole third octaves below half the rate of the slower "
                    "recording; it is felt up to 1000 Hz",
                    (beyond == centres.end() ? 1000.0 : *beyond / half_band_ratio)));
  }
  if (real.fast.air.segments == 0 && options.declared.force_N == 0.0) {
    judgement.remarks.emplace_back(
        "the real recording shows no free air and no instrument is declared: the sensor's noise counts as vibration");
  }
  std::string unseen;
  for (const auto& own : judgement.channels) {
    if (!own.known) unseen += fmt::format("{}{} ({})", unseen.empty() ? "" : ", ", name_of(own.channel), own.why);
  }
  if (!unseen.empty())
    judgement.remarks.push_back(fmt::format("not judged, the verdict says nothing about it: {}", unseen));
  if (floor.repeats == 0) {
    judgement.remarks.emplace_back(
        "no repeats: intervals hold the noise within each recording, not how one session differs from the next");
  }
  return judgement;
}

}  // namespace touchstone::perception
