// Experiment 2 of Ruffaldi et al. 2006 (section 4.2, table 2): friction identified from a scan. The force error of the
// friction cone as a function of its coefficient, the minimum, and the error without friction beside it.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "experiments/body_scan.h"

namespace touchstone::experiments {

// Of the virtual probes: the paper's 0.5 N/mm, and ten times that: the god-object lags by mu times the depth, which is
// a tenth then.
inline constexpr double soft_probe_N_per_m = 500.0;
inline constexpr double stiff_probe_N_per_m = 5000.0;

// By a virtual probe of one stiffness.
struct FrictionAtStiffness {
  double stiffness_N_per_m = 0.0;
  std::vector<double> mu;  // of the curve
  std::vector<double> mean_error_N;
  double fitted_mu = 0.0;    // on the first half of the scan
  ForceError without, with;  // on the second
};

// What the two fits and the instruments' known errors say together.
//  - A probe of stiffness k is held back by mu F / k, so that what it finds is off by a part that goes with 1 / k: of
//    two probes the linear extrapolation to 1 / k = 0 (Richardson 1911) is free of it.
//  - Errors of positions turn the direction of motion, and friction along a wrong direction looks like less of it. The
//    scan is measured again and again with the instruments' errors added a second time; the mean of what is found then
//    is off twice as far, and the line through both is followed back to no errors: simulation extrapolation (Cook and
//    Stefanski 1994).
//  - The spread of those is that of the estimate as far as the instruments make it (parametric bootstrap: Efron and
//    Tibshirani 1993, section 6.5); the mean of that many scans adds its own.
struct FrictionEstimate {
  double rigid_mu = 0.0;     // extrapolated to a rigid probe
  double again_mu = 0.0;     // the same, on average over the scans measured again
  std::size_t measured = 0;  // how many they are
  double mu = 0.0;           // 2 rigid_mu - again_mu
  double standard_error = 0.0;
};

struct FrictionFit {
  std::uint64_t seed = 0;
  double true_mu = 0.0;
  FrictionAtStiffness soft, stiff;
  FrictionEstimate estimate;
};

// The same on a recording of a soft real object, pressed at its measured positions: stiffness and coefficient fitted on
// even blocks of time, errors on the odd ones.
struct RealFrictionFit {
  double extended_m = 0.0;  // how far the surface is continued beyond the mesh
  double block_s = 0.0;
  double fitted_mu = 0.0;
  double stiffness_N_per_m = 0.0;  // with friction
  double rms_without_N = 0.0;
  double rms_with_N = 0.0;
  std::size_t fitted_samples = 0, held_out_samples = 0;
};

struct FrictionExperiment {
  std::vector<FrictionFit> fits;
  std::vector<RealFrictionFit> real;  // of one recording, over the surface continued by different lengths
};

// The published numbers (table 2).
struct PublishedFriction {
  static constexpr double without_N = 0.132;
  static constexpr double with_N = 0.067;
  static constexpr double without_flops = 10.4e6;
  static constexpr double with_flops = 10.8e6;
};

inline constexpr std::size_t measurements = 10;

// `soft_mu` and `stiff_mu`: found by probes of soft_probe_N_per_m and stiff_probe_N_per_m.
double of_a_rigid_probe(double soft_mu, double stiff_mu);
// `again_mu`: what the scans measured again gave, each extrapolated to a rigid probe; at least two.
FrictionEstimate friction_estimate(double rigid_mu, const std::vector<double>& again_mu);

// Calls `replayed` after each of the replays, of which there are about friction_replays. Throws Stopped soon after that
// was asked for.
inline constexpr std::size_t friction_replays = 430;
FrictionFit fit_friction(std::uint64_t seed, double true_mu, const std::function<void()>& replayed = {});
// `surface`: the surface of zero force of the recorded point, in metres. Throws BadData if the recording never touches
// it.
RealFrictionFit fit_real_friction(const recording::Recording& recording,
                                  const std::shared_ptr<const surface::Surface>& surface, double block_s);

// A finding of the paper, and whether it holds here.
struct PaperFinding {
  std::string statement;
  bool holds;
  std::string here;  // the numbers that say so
};
std::vector<PaperFinding> friction_findings(const FrictionExperiment& experiment);

}  // namespace touchstone::experiments
