#include "harness/renderer_faults/sliding_timing.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "harness/base/random.h"
#include "harness/renderer_faults/probe.h"

namespace touchstone::renderer_faults {
namespace {

constexpr std::size_t slid_from = 64;  // samples that are only remembered
constexpr std::size_t longest_lag = 24;

struct Phases {
  std::size_t period = 0;
  std::size_t late = 0;  // of so many samples
};

Timing late_contact_point(const Engine& engine, const Phases& phases, double more_N, const std::string& how) {
  Timing timing;
  timing.period_samples = static_cast<double>(phases.period);
  timing.settle_samples = static_cast<int>(phases.period) + 1;
  const std::string pull = fmt::format("pulls sideways by {:.3g} N {}, and not once the tip rests", more_N, how);
  if (phases.period > 2 && 2 * phases.late > phases.period) {
    timing.kind = TimingKind::held;
    const std::size_t updates = phases.period - phases.late;
    timing.period_samples /= static_cast<double>(updates);
    timing.lag_samples = std::ceil(timing.period_samples);
    timing.what = fmt::format(
        "the contact point is held: it is another one at every {:.4g}th sample only, {:.4g} Hz in a loop of {:g} Hz, "
        "and {}",
        timing.period_samples, engine.rate_Hz / timing.period_samples, engine.rate_Hz, pull);
    return timing;
  }
  timing.kind = TimingKind::alternate;
  timing.lag_samples = 1.0;
  const std::string which = phases.period == 2 ? "every second answer is"
                                               : fmt::format("of every {} answers {} {}", phases.period, phases.late,
                                                             phases.late == 1 ? "is" : "are");
  timing.what = which + " late while the tip slides: its contact point is that of an earlier sample, which " + pull;
  return timing;
}

// With friction, which takes what is sideways up to its cone: the contact point of the sample before pulls beyond the
// cone, if the steps are as long as twice what the cone holds.
std::optional<Timing> with_friction(const Engine& engine) {
  const double step_m = std::max(2.0 * engine.friction * probe_depth_m, 3.0 * engine.epsilon_m);
  constexpr double way_m = 0.03;
  constexpr int least_steps = 20;
  const int steps = static_cast<int>(way_m / step_m);
  if (steps < least_steps) return std::nullopt;
  Probe probe(engine, level_block());
  const Vec3 start = place - Vec3(0.5 * way_m, 0.0, 0.0);
  probe.approach(start, Vec3::UnitZ(), probe_depth_m);
  std::array<double, 2> share{};  // of the load, in the even and the odd samples of the second half
  const int counted = steps / 4;
  for (int i = 0; i < steps; ++i) {
    const Vec3 now_N = probe.press(start + Vec3(i * step_m, 0.0, 0.0), Vec3::UnitZ(), probe_depth_m).f_W_N;
    if (i >= steps - 2 * counted) share[static_cast<std::size_t>(i % 2)] += std::abs(now_N.x()) / now_N.z() / counted;
  }
  const auto [low, high] = std::minmax(share[0], share[1]);
  if (!(high > 1.5 * engine.friction && low < 1.1 * engine.friction)) return std::nullopt;
  return late_contact_point(engine, {.period = 2, .late = 1},
                            (high - engine.friction) * engine.stiffness_N_per_m * probe_depth_m, "beyond its friction");
}

// The shortest period in which some samples have nearly none of the sideways force of others; nothing where there is
// none.
std::optional<Timing> by_phases(const Engine& engine, const std::vector<double>& sideways_N) {
  constexpr std::size_t longest = 64;
  const double least_force_N = engine.stiffness_N_per_m * 2e-3 * probe_depth_m;
  for (std::size_t period = 2; period <= longest; ++period) {
    // An epsilon is the same in every second sample; of the few of a longer period it may move some more than others.
    const double clearly = period == 2 ? 3.0 : 10.0;
    const double allowed_N = period == 2 ? least_force_N : least_force_N + engine.stiffness_N_per_m * engine.epsilon_m;
    std::vector<double> rms_N(period, 0.0);
    std::vector<double> samples(period, 0.0);
    for (std::size_t i = slid_from; i < sideways_N.size(); ++i) {
      rms_N[i % period] += sideways_N[i] * sideways_N[i];
      samples[i % period] += 1.0;
    }
    for (std::size_t phase = 0; phase < period; ++phase) rms_N[phase] = std::sqrt(rms_N[phase] / samples[phase]);
    const auto [least_N, most_N] = std::ranges::minmax(rms_N);
    if (!(most_N > allowed_N && most_N > clearly * least_N)) continue;
    // The nearer a held point's update is, the less it pulls: none at all just then.
    const double right_N = clearly * std::max(least_N, 0.01 * most_N);
    const auto late = std::ranges::count_if(rms_N, [&](double one_N) { return one_N > right_N; });
    return late_contact_point(engine, {period, static_cast<std::size_t>(late)}, most_N,
                              fmt::format("rms ({:.2g} N in the others)", least_N));
  }
  return std::nullopt;
}

}  // namespace

Timing timing_of_slides(const Engine& engine) {
  constexpr std::size_t steps = 1200;
  // Moves of less than its epsilon are none to the engine.
  const double largest_step_m = std::max(4e-5, 3.0 * engine.epsilon_m);
  const double reach_m = 25.0 * largest_step_m;
  Probe probe(engine, level_block());
  probe.approach(place, Vec3::UnitZ(), probe_depth_m);
  Random random(212);
  std::vector<double> x_m{0.0};
  std::vector<double> sideways_N{0.0};
  for (std::size_t i = 1; i < steps; ++i) {
    x_m.push_back(std::clamp(x_m.back() + largest_step_m * random.uniform(-1.0, 1.0), -reach_m, reach_m));
    sideways_N.push_back(probe.press(place + Vec3(x_m.back(), 0.0, 0.0), Vec3::UnitZ(), probe_depth_m).f_W_N.x());
  }
  if (auto late = by_phases(engine, sideways_N)) return *late;
  if (engine.friction > 0.0) return with_friction(engine).value_or(Timing{});
  double most_N = 0.0;
  for (std::size_t i = slid_from; i < steps; ++i) most_N += sideways_N[i] * sideways_N[i];
  most_N = std::sqrt(most_N / static_cast<double>(steps - slid_from));
  if (most_N <= engine.stiffness_N_per_m * (2e-3 * probe_depth_m + engine.epsilon_m)) return {};
  for (std::size_t lag = 1; lag < longest_lag; ++lag) {
    double off = 0.0, all = 0.0;
    for (std::size_t i = slid_from; i < steps; ++i) {
      const double late_N = engine.stiffness_N_per_m * (x_m[i - lag] - x_m[i]);
      off += (sideways_N[i] - late_N) * (sideways_N[i] - late_N);
      all += sideways_N[i] * sideways_N[i];
    }
    if (off <= 0.02 * all)
      return delayed(engine, static_cast<double>(lag), " while the tip slides: it springs to an earlier place");
  }
  return {};
}

}  // namespace touchstone::renderer_faults
