#include "harness/renderer_faults/timing.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <vector>

#include "harness/base/random.h"
#include "harness/renderer_faults/arx.h"
#include "harness/renderer_faults/other_engines.h"
#include "harness/renderer_faults/probe.h"
#include "harness/renderer_faults/sliding_timing.h"
#include "harness/stats/quantile.h"

namespace touchstone::renderer_faults {
namespace {

constexpr std::size_t level_count = 32;
constexpr std::size_t memory = 24;  // samples within which no depth comes twice: lags up to there can be told apart
constexpr std::size_t step_count = 1600;
constexpr std::size_t longest_period = 200;  // of lags that repeat themselves
constexpr std::size_t from = 64;             // samples that are only remembered
constexpr double shallow_press_m = 2e-4;
constexpr double deep_press_m = 1e-3;

// Longer lags are one number of samples for all, up to this time.
constexpr double longest_lag_s = 0.04;

// The normal force once it no longer changes: over 128 samples, or the longest lag, by less than a ten thousandth of
// the load. What never comes to rest is read as the median of the last ones.
double settled_N(Probe& probe, double depth_m, const Vec3& along, double load_N, double rate_Hz) {
  const auto window = std::max<std::size_t>(128, static_cast<std::size_t>(longest_lag_s * rate_Hz) + 1);
  constexpr int most_windows = 24;
  std::vector<double> last(window);
  for (int i = 0; i < most_windows; ++i) {
    for (double& force : last) force = probe.press(place, Vec3::UnitZ(), depth_m).f_W_N.dot(along);
    const auto [low, high] = std::ranges::minmax(last);
    if (high - low <= 1e-4 * load_N) break;
  }
  return stats::upper_median(last);
}

// Where the force grows to with the depth, once it has settled: along the normal, if nothing is wrong with the frame.
Vec3 direction_of_force(const Engine& engine, double shallow_m, double deep_m) {
  Probe probe(engine, level_block());
  constexpr int rest = 600;
  const auto at = [&](double depth_m) {
    probe.approach(place, Vec3::UnitZ(), depth_m);
    Vec3 last = Vec3::Zero();
    for (int i = 0; i < rest; ++i) last = probe.press(place, Vec3::UnitZ(), depth_m).f_W_N;
    return last;
  };
  const Vec3 shallow = at(shallow_m);
  const Vec3 more = at(deep_m) - shallow;
  constexpr double least = 0.05;  // of what is right
  if (!(more.norm() > least * engine.stiffness_N_per_m * (deep_m - shallow_m))) return Vec3::UnitZ();
  return more.normalized();
}

// F and S of the header, one for each sample.
struct Response {
  std::vector<double> force_N, settled_N;
  double spacing_N = 0.0;  // of S from depth to depth
};

Response response_to_jumps(const Engine& engine) {
  Probe probe(engine, level_block());
  const double load_N = engine.stiffness_N_per_m * deep_press_m;
  const Vec3 along = direction_of_force(engine, shallow_press_m, deep_press_m);
  const auto depth_m = [](std::size_t level) {
    return shallow_press_m + (deep_press_m - shallow_press_m) * static_cast<double>(level) / (level_count - 1);
  };
  probe.approach(place, Vec3::UnitZ(), shallow_press_m);
  std::vector<double> settled(level_count);
  for (std::size_t level = 0; level < level_count; ++level)
    settled[level] = settled_N(probe, depth_m(level), along, load_N, engine.rate_Hz);
  Response response;
  const auto [low, high] = std::ranges::minmax(settled);
  response.spacing_N = (high - low) / (level_count - 1);
  Random random(211);
  std::vector<std::size_t> levels;
  for (std::size_t i = 0; i < step_count; ++i) {
    const std::size_t remembered = std::min(memory, levels.size());
    std::size_t level = random.below(level_count);
    while (std::find(levels.end() - static_cast<std::ptrdiff_t>(remembered), levels.end(), level) != levels.end())
      level = (level + 1) % level_count;
    levels.push_back(level);
    response.settled_N.push_back(settled[level]);
    response.force_N.push_back(probe.press(place, Vec3::UnitZ(), depth_m(level)).f_W_N.dot(along));
  }
  return response;
}

// Held answers: the samples of an update, and the period if they have one.
std::optional<Timing> find_hold(const Engine& engine, const Response& response) {
  const auto& f = response.force_N;
  const auto& s = response.settled_N;
  std::vector<std::size_t> updates;
  std::size_t repeated = 0;
  for (std::size_t i = from; i < f.size(); ++i) {
    const bool same = std::abs(f[i] - f[i - 1]) <= 1e-9 * std::abs(f[i]);
    if (same && std::abs(s[i] - s[i - 1]) > 0.5 * response.spacing_N) {
      ++repeated;
    } else if (!same) {
      updates.push_back(i);
    }
  }
  constexpr double least_share = 0.4;  // every second answer is new at least
  if (updates.size() < 3 || static_cast<double>(repeated) < least_share * static_cast<double>(f.size() - from))
    return std::nullopt;
  std::vector<double> gaps;
  for (std::size_t i = 1; i < updates.size(); ++i) gaps.push_back(static_cast<double>(updates[i] - updates[i - 1]));
  // An update to a depth of the same force is not seen: its gap is of two periods.
  const double usual = stats::upper_median(gaps);
  double periods = 0.0;
  double sum = 0.0;
  for (const double gap : gaps) {
    periods += std::max(1.0, std::round(gap / usual));
    sum += gap;
  }
  Timing timing;
  timing.period_samples = sum / periods;
  const auto irregular = std::ranges::count_if(gaps, [&](double gap) {
    return std::abs(gap - std::max(1.0, std::round(gap / usual)) * timing.period_samples) > 1.0;
  });
  const double longest = std::ranges::max(gaps);
  // An update may be late itself.
  std::array<double, memory> off{};
  for (std::size_t lag = 0; lag < memory; ++lag) {
    for (const std::size_t i : updates) off[lag] += std::abs(f[i] - s[i - lag]);
  }
  const auto late = std::ranges::min_element(off) - off.begin();
  timing.settle_samples = static_cast<int>(longest) + static_cast<int>(late) + 1;
  timing.lag_samples = longest;
  if (10 * irregular > std::ssize(gaps)) {
    timing.kind = TimingKind::jitter;
    timing.what =
        fmt::format("an answer is held for {:g} to {:g} samples, without a period", std::ranges::min(gaps), longest);
    return timing;
  }
  timing.kind = TimingKind::held;
  timing.what = fmt::format(
      "each answer is held: the force changes at every {:.4g}th sample only, {:.4g} Hz in a loop of "
      "{:g} Hz",
      timing.period_samples, engine.rate_Hz / timing.period_samples, engine.rate_Hz);
  if (late > 0) timing.what += fmt::format(", and {} samples late then", late);
  return timing;
}

// Of each sample the fewest samples ago at which its force was right; -1 where it never was.
std::vector<int> lags_of(const Response& response) {
  std::vector<int> lags;
  for (std::size_t i = from; i < response.force_N.size(); ++i) {
    int lag = -1;
    for (std::size_t back = 0; back < memory && lag < 0; ++back) {
      if (std::abs(response.force_N[i] - response.settled_N[i - back]) <= 0.25 * response.spacing_N)
        lag = static_cast<int>(back);
    }
    lags.push_back(lag);
  }
  return lags;
}

double share_of(const std::vector<int>& lags, int lag) {
  return static_cast<double>(std::ranges::count(lags, lag)) / static_cast<double>(lags.size());
}

// The shortest period after which 98 % of the late samples are as late again; 0: there is none.
std::size_t period_of(const std::vector<int>& lags) {
  for (std::size_t period = 2; period <= longest_period; ++period) {
    std::size_t late = 0, again = 0;
    for (std::size_t i = period; i < lags.size(); ++i) {
      if (lags[i] <= 0) continue;
      ++late;
      again += lags[i] == lags[i - period] ? 1U : 0U;
    }
    if (late > 2 && 50 * again >= 49 * late) return period;
  }
  return 0;
}

// What the lags say; nothing if too many samples have none.
std::optional<Timing> by_lags(const Engine& engine, const std::vector<int>& lags) {
  Timing timing;
  if (share_of(lags, -1) > 0.05) return std::nullopt;
  const int largest = std::ranges::max(lags);
  timing.lag_samples = largest;
  timing.settle_samples = 2 * largest + 1;
  if (largest <= 0) return timing;
  for (int lag = 1; lag <= largest; ++lag) {
    if (share_of(lags, lag) >= 0.98) return delayed(engine, lag);
  }
  const double late = 1.0 - share_of(lags, 0) - share_of(lags, -1);
  if (const std::size_t period = period_of(lags); period > 0) {
    timing.kind = TimingKind::alternate;
    timing.period_samples = static_cast<double>(period);
    timing.settle_samples += static_cast<int>(period);
    timing.what = fmt::format("of every {} samples {:.2g} are late, by up to {} sample{}", period,
                              late * static_cast<double>(period), largest, largest == 1 ? "" : "s");
    return timing;
  }
  timing.kind = TimingKind::jitter;
  timing.what = fmt::format("{:.2g} % of the samples are late, by up to {} sample{}, without a period", 100.0 * late,
                            largest, largest == 1 ? "" : "s");
  return timing;
}

// One lag beyond those within which no depth comes twice: another one is right by chance in every thirtieth sample.
std::optional<Timing> by_long_lag(const Engine& engine, const Response& response) {
  constexpr std::size_t compared = 1000;
  const auto longest = std::max<std::size_t>(128, static_cast<std::size_t>(longest_lag_s * engine.rate_Hz));
  for (std::size_t lag = memory; lag <= std::min(longest, step_count - compared); ++lag) {
    std::size_t right = 0;
    for (std::size_t i = step_count - compared; i < step_count; ++i)
      right += std::abs(response.force_N[i] - response.settled_N[i - lag]) <= 0.25 * response.spacing_N ? 1U : 0U;
    if (50 * right >= 49 * compared) return delayed(engine, static_cast<double>(lag));
  }
  return std::nullopt;
}

std::optional<Timing> find_clipped(const std::vector<double>& change_N, double load_N) {
  double most_N = 0.0;
  for (const double change : change_N) most_N = std::max(most_N, std::abs(change));
  if (!(most_N > 1e-3 * load_N)) return std::nullopt;
  const auto at_most =
      std::ranges::count_if(change_N, [&](double change) { return std::abs(change) > (1.0 - 1e-6) * most_N; });
  if (5 * at_most < std::ssize(change_N) || at_most < 4) return std::nullopt;
  Timing timing;
  timing.kind = TimingKind::clipped;
  timing.per_sample_N = most_N;
  constexpr double largest_load_N = 10.0;
  timing.settle_samples = static_cast<int>(std::min(1e3, 1.0 + largest_load_N / most_N));
  timing.what = fmt::format("the force changes by no more than {:.3g} N from sample to sample", most_N);
  return timing;
}

// The samples after which a tip that jumped by 2 mm and rests has its force; 0: it never rests.
int measured_settling_samples(const Engine& engine) {
  constexpr int jumps = 16;
  constexpr double jump_m = 2e-3;
  constexpr double longest_s = 0.5;
  const int least = std::max(1500, static_cast<int>(longest_s * engine.rate_Hz));
  Probe probe(engine, level_block());
  probe.approach(place, Vec3::UnitZ(), shallow_press_m);
  int longest = 0;
  for (int jump = 0; jump < jumps; ++jump) {
    // Each at another place of whatever comes again and again.
    constexpr int more = 37;
    const int rest = least + more * jump;
    const double depth_m = shallow_press_m + (jump % 2 == 0 ? jump_m : 0.0);
    std::vector<double> force_N;
    force_N.reserve(static_cast<std::size_t>(rest));
    for (int i = 0; i < rest; ++i) force_N.push_back(probe.press(place, Vec3::UnitZ(), depth_m).f_W_N.z());
    const double off_N = 1e-4 * engine.stiffness_N_per_m * jump_m;
    const auto last = std::find_if(force_N.rbegin(), force_N.rend(),
                                   [&](double now_N) { return !(std::abs(now_N - force_N.back()) <= off_N); });
    const auto samples = static_cast<int>(force_N.rend() - last);
    if (samples > rest - rest / 10) return 0;
    longest = std::max(longest, samples);
  }
  return longest;
}

// By an ARX model; unclear if none explains the force.
Timing by_filter(const Engine& engine, const Response& response) {
  Timing timing;
  timing.kind = TimingKind::unclear;
  const auto arx = simplest_arx(response.force_N, response.settled_N, from);
  if (!arx) return timing;
  // At once at least the settled force: damping, relaxation.
  constexpr double at_once = 0.95;
  if (arx->b[0] >= at_once) {
    if (arx->dead > 0) return delayed(engine, arx->dead, ", and damped or relaxing then");
    timing.kind = TimingKind::viscous;
    timing.settle_samples = 2;
    return timing;
  }
  // Above what other detectors count as no memory.
  timing.settle_samples = 3 + arx->settling_samples();
  timing.kind = TimingKind::filter;
  timing.lag_samples = arx->delay_samples();
  timing.time_constant_s = timing.lag_samples / engine.rate_Hz;
  if (arx->a.size() == 1 && arx->a[0] > 1e-3 && std::abs(arx->b[1]) < 0.1 * arx->b[0])
    timing.time_constant_s = -1.0 / (engine.rate_Hz * std::log(std::min(arx->a[0], 1.0 - 1e-6)));
  timing.what =
      fmt::format("the force is low-pass filtered: a time constant of {:.3g} ms, {:.3g} samples late in the mean",
                  1e3 * timing.time_constant_s, timing.lag_samples);
  return timing;
}

// The lag that leaves least of the force's variance, where no model says more: with damping or relaxation the depth of
// now does not say everything, but that of another sample must not say it better.
void by_variance(const Engine& engine, const Response& response, Timing& timing) {
  std::vector<double> left(memory + 1, 0.0);
  for (std::size_t lag = 0; lag <= memory; ++lag) {
    for (std::size_t i = from; i < response.force_N.size(); ++i) {
      const double off = response.force_N[i] - response.settled_N[i - lag];
      left[lag] += off * off;
    }
  }
  const auto least = static_cast<std::size_t>(std::ranges::min_element(left) - left.begin());
  if (least == 0 || !(left[least] < 0.5 * left[0])) return;
  timing = delayed(engine, static_cast<double>(least),
                   fmt::format(", and not by this alone: {:.2g} of the error is left", left[least] / left[0]));
  timing.settle_samples += static_cast<int>(memory);
}

// Up and down at 2 m/s, and by 2 mm a sample at least, up to 10 N.
std::optional<Timing> with_large_jumps(const Engine& engine) {
  const double jump_m = std::max(2e-3, 2.0 / engine.rate_Hz);
  constexpr double most_N = 10.0;
  constexpr double deepest_m = 0.05;
  const double deep_m = std::min(deepest_m, most_N / engine.stiffness_N_per_m);
  const double half_m = std::max(0.1, 5.0 * deep_m);
  Probe probe(engine, surface::box_mesh({-half_m, -half_m, -2.0 * half_m}, {half_m, half_m, 0.0}));
  probe.approach(place, Vec3::UnitZ(), shallow_press_m);
  std::vector<double> change_N;
  const Vec3 along = direction_of_force(engine, shallow_press_m, deep_press_m);
  double last_N = probe.press(place, Vec3::UnitZ(), shallow_press_m).f_W_N.dot(along);
  double worst_N = 0.0;
  constexpr int strokes = 6;
  for (int stroke = 0; stroke < strokes; ++stroke) {
    const int steps = std::max(1, static_cast<int>(deep_m / jump_m));
    const auto depth_at = [&](int i) {
      const double share = static_cast<double>(stroke % 2 == 0 ? i : steps - i) / steps;
      return shallow_press_m + share * (deep_m - shallow_press_m);
    };
    for (int i = 1; i <= steps; ++i) {
      const double now_N = probe.press(place, Vec3::UnitZ(), depth_at(i)).f_W_N.dot(along);
      change_N.push_back(now_N - last_N);
      last_N = now_N;
    }
    // Here it comes to rest.
    constexpr int rest = 400;
    const double first_N = last_N;
    for (int i = 0; i < rest; ++i) {
      const double now_N = probe.press(place, Vec3::UnitZ(), depth_at(steps)).f_W_N.dot(along);
      // Here, too, it changes by no more than the figure, as often as the way is long.
      if (std::abs(now_N - last_N) > 0.0) change_N.push_back(now_N - last_N);
      last_N = now_N;
    }
    worst_N = std::max(worst_N, std::abs(last_N - first_N));
  }
  if (worst_N < 0.01 * most_N) return std::nullopt;
  return find_clipped(change_N, engine.stiffness_N_per_m * deep_m);
}

// How much each kind that is not this one says of the force; nothing where the force over one place is not late, and
// what is late shows in a slide alone.
std::vector<std::pair<std::string, std::string>> other_kinds(const Response& response, const std::string& fault) {
  const auto& f = response.force_N;
  const auto& s = response.settled_N;
  double sum_N = 0.0, squares = 0.0, most_N = 0.0;
  std::size_t again = 0, at_most = 0;
  std::array<double, memory> late{};
  for (std::size_t i = from; i < f.size(); ++i) {
    sum_N += f[i];
    squares += f[i] * f[i];
    for (std::size_t lag = 0; lag < memory; ++lag) late[lag] += (f[i] - s[i - lag]) * (f[i] - s[i - lag]);
    most_N = std::max(most_N, std::abs(f[i] - f[i - 1]));
    again += f[i] == f[i - 1] ? 1 : 0;
  }
  for (std::size_t i = from; i < f.size(); ++i) at_most += std::abs(f[i] - f[i - 1]) > (1.0 - 1e-6) * most_N ? 1 : 0;
  const auto count = static_cast<double>(f.size() - from);
  const double variance = squares - sum_N * sum_N / count;
  constexpr double exact = 1e-3;
  if (!(late[0] > exact * variance)) return {};
  const auto lag = std::ranges::min_element(late) - late.begin();
  double filtered = variance;
  constexpr int tried = 20;
  for (int k = 1; k < tried; ++k) {
    const double a = static_cast<double>(k) / tried;
    double left = 0.0, output_N = f[from - 1];
    for (std::size_t i = from; i < f.size(); ++i) {
      output_N = a * output_N + (1.0 - a) * s[i];
      left += (f[i] - output_N) * (f[i] - output_N);
    }
    filtered = std::min(filtered, left);
  }
  const auto per_cent = [](double part, double whole) { return std::min(100.0, 100.0 * part / whole); };
  std::vector<std::pair<std::string, std::string>> all{
      {"delay", fmt::format("a lag of {} samples leaves {:.3g} % of the force's variance", lag,
                            per_cent(late[static_cast<std::size_t>(lag)], variance))},
      {"held-answer", fmt::format("{:.3g} % of the answers are those of the sample before",
                                  per_cent(static_cast<double>(again), count))},
      {"filter", fmt::format("a low-pass filter of first order leaves {:.3g} % of the force's variance",
                             per_cent(filtered, variance))},
      {"clipped-rate",
       fmt::format("{:.3g} % of the changes are the largest one", per_cent(static_cast<double>(at_most), count))}};
  std::erase_if(all, [&](const auto& kind) { return kind.first == fault; });
  return all;
}

Timing timing_of(const Engine& engine, const Response& response) {
  if (auto held = find_hold(engine, response)) return *held;
  Timing timing;
  if (auto late = by_lags(engine, lags_of(response))) {
    timing = *late;
  } else if (auto later = by_long_lag(engine, response)) {
    return *later;
  } else {
    std::vector<double> change_N;
    for (std::size_t i = from; i < step_count; ++i) change_N.push_back(response.force_N[i] - response.force_N[i - 1]);
    if (auto clipped = find_clipped(change_N, engine.stiffness_N_per_m * deep_press_m)) return *clipped;
    timing = by_filter(engine, response);
  }
  if (timing.kind == TimingKind::exact || timing.kind == TimingKind::unclear) {
    if (auto clipped = with_large_jumps(engine)) return *clipped;
  }
  if (timing.kind == TimingKind::exact) timing = timing_of_slides(engine);
  if (timing.kind == TimingKind::unclear) by_variance(engine, response, timing);
  return timing;
}

}  // namespace

Timing delayed(const Engine& engine, double lag, const std::string& more) {
  Timing timing;
  timing.kind = TimingKind::delay;
  timing.lag_samples = lag;
  timing.settle_samples = static_cast<int>(2.0 * lag) + 1;
  timing.what = fmt::format("the force is {:g} sample{} late ({:.3g} ms){}", lag, lag == 1.0 ? "" : "s",
                            1e3 * lag / engine.rate_Hz, more);
  return timing;
}

std::string Timing::fault() const {
  if (declared) return "";
  switch (kind) {
    case TimingKind::delay:
      return "delay";
    case TimingKind::alternate:
      return "alternate-lag";
    case TimingKind::held:
      return "held-answer";
    case TimingKind::jitter:
      return "jitter";
    case TimingKind::filter:
      return "filter";
    case TimingKind::clipped:
      return "clipped-rate";
    case TimingKind::exact:
    case TimingKind::viscous:
    case TimingKind::unclear:
      break;
  }
  return "";
}

Timing identify_timing(const Engine& engine) {
  Response response = response_to_jumps(engine);
  // What has no force upwards may have one along another axis.
  const bool leans = !(response.spacing_N > 0.0);
  const Engine probed = leans ? leaning(engine) : engine;
  if (leans) response = response_to_jumps(probed);
  // The force is the same at every depth: nothing can be told from it.
  if (!(response.spacing_N > 0.0)) return {};
  Timing timing = timing_of(probed, response);
  // Of two faults the one behind may take longer.
  if (timing.kind != TimingKind::exact)
    timing.settle_samples = std::max(timing.settle_samples, measured_settling_samples(probed));
  timing.declared = timing.kind == TimingKind::delay && timing.lag_samples <= engine.lag_samples;
  if (const std::string fault = timing.fault(); !fault.empty()) timing.considered = other_kinds(response, fault);
  return timing;
}

}  // namespace touchstone::renderer_faults
