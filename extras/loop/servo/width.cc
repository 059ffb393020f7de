#include "servo/width.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "harness/base/error.h"
#include "servo/evaluation.h"
#include "servo/flat_wall.h"
#include "servo/limits.h"
#include "synthetic/trajectories/tremor.h"

namespace touchstone::servo {
namespace {

constexpr std::array speeds_m_per_s{0.03, 0.3};
constexpr double hold_s = 1.5;
constexpr double tremor_m = 5e-5;
constexpr double away_s = 0.2;  // way up, and rest there
constexpr double above_m = 2e-3;
constexpr double press_N = 1.0;

LoopParameters with(LoopParameters own, WidthOver over, double value) {
  switch (over) {
    case WidthOver::virtual_damping:
      own.virtual_damping_N_s_per_m = value;
      break;
    case WidthOver::latency:
      own.latency_s = value;
      break;
    case WidthOver::period:
      own.period_s = value;
      break;
  }
  return own;
}

// Whether a wall of that stiffness is judged so.
template <class Accepted>
bool wall_is(const LoopParameters& own, double stiffness, const perception::Thresholds& thresholds,
             const Accepted& accepted) {
  FlatWall wall(stiffness);
  return std::ranges::all_of(speeds_m_per_s, [&](double speed) {
    return accepted(judge_loop(wall, hit(own, speed), own, thresholds).verdict);
  });
}

template <class Accepted>
double largest_wall(const LoopParameters& own, const perception::Thresholds& thresholds, const Accepted& accepted) {
  return largest_stable(least_wall_N_per_m, stiffest_wall_N_per_m,
                        [&](double stiffness) { return wall_is(own, stiffness, thresholds, accepted); });
}

bool is_stable(Verdict verdict) { return verdict == Verdict::stable; }
bool is_held(Verdict verdict) { return verdict == Verdict::stable || verdict == Verdict::buzzes; }

}  // namespace

MotionColumns hit(const LoopParameters& parameters, double speed_m_per_s) {
  const double stiffness = parameters.axis.hand_stiffness_N_per_m;
  if (!(stiffness > 0.0))
    throw UsageError("a hand without stiffness presses on nothing: hand_stiffness_N_per_m above 0");
  const double deep_m = press_N / stiffness;
  const double down_s = (above_m + deep_m) / speed_m_per_s;
  const synthetic::Tremor tremor(1, tremor_m);
  MotionColumns path;
  constexpr double step_s = 1e-3;
  for (int k = 0; k * step_s <= down_s + hold_s; ++k) {
    const double t_s = k * step_s;
    path.t_s.push_back(t_s);
    path.p_W_m.push_back(tremor.at(t_s));
    path.p_W_m.back().z() += above_m - std::min(1.0, t_s / down_s) * (above_m + deep_m);
  }
  return path;
}

std::vector<WidthPoint> stable_width(const LoopSetup& setup, WidthOver over, const std::vector<double>& at,
                                     const perception::Thresholds& thresholds) {
  std::vector<WidthPoint> out;
  for (const double value : at) {
    WidthPoint point;
    point.at = value;
    point.unfelt_N_per_m = point.held_N_per_m = point.linear_N_per_m = std::numeric_limits<double>::infinity();
    for (const double mass_kg : setup.device_masses_kg) {
      const LoopParameters own = with(setup.with_mass(mass_kg), over, value);
      point.unfelt_N_per_m = std::min(point.unfelt_N_per_m, largest_wall(own, thresholds, is_stable));
      point.held_N_per_m = std::min(point.held_N_per_m, largest_wall(own, thresholds, is_held));
      const auto critical = critical_gain(own);
      point.linear_N_per_m = std::min(
          point.linear_N_per_m, critical ? critical->stiffness_N_per_m : std::numeric_limits<double>::quiet_NaN());
      point.passive_N_per_m =
          passive_stiffness_N_per_m(own.axis.damping_N_s_per_m, own.virtual_damping_N_s_per_m, own.period_s);
    }
    out.push_back(point);
  }
  return out;
}

TunedWall tune(const std::vector<LoopSetup>& setups, double margin, const perception::Thresholds& thresholds) {
  std::vector<LoopParameters> all;
  for (const LoopSetup& setup : setups) {
    for (const double mass_kg : setup.device_masses_kg) all.push_back(setup.with_mass(mass_kg));
  }
  const auto stiffest = [&](double virtual_damping) {
    double least = stiffest_wall_N_per_m;
    for (const LoopParameters& own : all) {
      least = std::min(
          least, largest_wall(with(own, WidthOver::virtual_damping, virtual_damping), thresholds, is_stable) / margin);
    }
    return least;
  };
  TunedWall best;
  best.undamped_N_per_m = best.stiffness_N_per_m = stiffest(0.0);
  constexpr double worth_it = 1.03;
  for (const double virtual_damping : {1.0, 2.0, 4.0, 7.0, 12.0, 20.0, 40.0}) {
    const double worth = std::max(least_wall_N_per_m, worth_it * margin * best.stiffness_N_per_m);
    const bool gains = std::ranges::all_of(all, [&](const LoopParameters& own) {
      return wall_is(with(own, WidthOver::virtual_damping, virtual_damping), worth, thresholds, is_stable);
    });
    if (!gains) continue;
    const double here = stiffest(virtual_damping);
    if (here <= worth_it * best.stiffness_N_per_m) continue;
    best.stiffness_N_per_m = here;
    best.virtual_damping_N_s_per_m = virtual_damping;
  }
  return best;
}

}  // namespace touchstone::servo
