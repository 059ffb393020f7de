// A renderer, a path and a setup (setup.h) as one answer: verdict, margin, and the runs behind it.
#pragma once

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "servo/setup.h"
#include "servo/verdict.h"

namespace touchstone::servo {

// With one mass of the device.
struct MassRun {
  double device_mass_kg = 0.0;
  LoopTrace run, ideal, open;
  Judgement judgement;
  // The renderer's force may become this many times as large before the verdict is no longer stable; of one that is
  // not stable, what it must be multiplied with to become so. To 3 %, between 1/1024 and 1024; 0: below that.
  double stable_margin = 0.0;
};

struct LoopEvaluation {
  std::vector<MassRun> runs;  // ascending mass
  Verdict verdict = Verdict::cannot_tell;
  std::string sentence;
  double stable_margin = 0.0;     // the smallest of the runs'
  double real_time_factor = 0.0;  // simulated over elapsed time of the loops alone, on one core

  // The run with the worst judgement, which a report shows.
  [[nodiscard]] const MassRun& worst() const;
};

LoopEvaluation evaluate_loop(rendering::Renderer& renderer, const MotionColumns& path, const LoopSetup& setup,
                             const perception::Thresholds& thresholds);

// The judgement alone, of one loop. What the encoder's steps shake is told from a buzz only where there is one.
Judgement judge_loop(rendering::Renderer& renderer, const MotionColumns& path, const LoopParameters& parameters,
                     const perception::Thresholds& thresholds);

// The largest value from `low` to `high` for which `stable` holds, to 3 %, sought from above in factors of 2; 0: none.
template <class Stable>
double largest_stable(double low, double high, const Stable& stable) {
  constexpr double ratio = 1.03;
  if (stable(high)) return high;
  double below = high;
  do {
    if (below <= low) return 0.0;
    high = below;
    below = std::max(low, 0.5 * below);
  } while (!stable(below));
  while (high > ratio * below) {
    const double middle = std::sqrt(below * high);
    (stable(middle) ? below : high) = middle;
  }
  return below;
}

}  // namespace touchstone::servo
