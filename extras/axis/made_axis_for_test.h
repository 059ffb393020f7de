// Axes with known terms, for the tests of the fit.
#pragma once

#include <algorithm>
#include <cmath>
#include <map>
#include <string>

#include "axis_fit.h"
#include "harness/base/random.h"

namespace touchstone::axis::made {

struct AxisTruth {
  double dry = 0.0, viscous = 0.0, inertia = 0.0, cable = 0.0;
  double width = 0.0, slope = 0.0;     // of a reversal; of the dry friction over the place
  double relaxing = 0.0, tau_s = 1.0;  // a Maxwell arm
  bool one_speed = false;
  bool backlash = false;  // within the width of a reversal no dry friction
};

// 60 s at 200 Hz: swings of several speeds, or there and back at one speed.
inline AxisRun made_axis(const AxisTruth& truth, double unit, double noise, Random& random) {
  AxisRun run;
  run.source = "axis.csv";
  double z = 1.0, slow = 0.0, last = 0.0;
  for (int i = 0; i < 12000; ++i) {
    const double t = i / 200.0;
    double q = std::sin(0.6 * t) + 0.3 * std::sin(2.3 * t);
    double v = 0.6 * std::cos(0.6 * t) + 0.69 * std::cos(2.3 * t);
    double a = -0.36 * std::sin(0.6 * t) - 1.587 * std::sin(2.3 * t);
    if (truth.one_speed) {
      const double phase = std::fmod(t, 10.0);
      q = phase < 5.0 ? 0.1 * phase : 1.0 - 0.1 * phase;
      v = phase < 5.0 ? 0.1 : -0.1;
      a = 0.0;
    }
    if (i == 0) last = slow = q;
    z = truth.width > 0.0 ? std::clamp(z + 2.0 * (q - last) / truth.width, -1.0, 1.0) : (v > 0 ? 1.0 : -1.0);
    last = q;
    // The exact step of a first-order lag towards a place that stands still within a sample.
    slow += (q - slow) * (1.0 - std::exp(-1.0 / 200.0 / truth.tau_s));
    const double turned = truth.backlash && std::abs(z) < 1.0 ? 0.0 : z;
    const double f = (truth.dry + truth.slope * q) * turned + truth.viscous * v + truth.inertia * a +
                     truth.cable * (std::sin(1.5 * q) + 0.5 * q * q) + truth.relaxing * (q - slow);
    run.t_s.push_back(t);
    run.place.push_back(q);
    run.rate.push_back(v);
    run.load.push_back(unit * (f + noise * random.normal()));
  }
  return run;
}

inline std::map<std::string, double> terms_of(const AxisFit& fit) {
  std::map<std::string, double> terms;
  for (const AxisTerm& term : fit.terms) terms[to_string(term.kind)] = term.value;
  return terms;
}

inline std::string names_of(const AxisFit& fit) {
  std::string names;
  for (const AxisTerm& term : fit.terms) names += (names.empty() ? "" : ", ") + std::string(to_string(term.kind));
  return names;
}

}  // namespace touchstone::axis::made
