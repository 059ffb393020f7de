// Averaged periodograms of overlapping segments with a Hann taper (P. D. Welch, "The use of fast Fourier transform for
// the estimation of power spectra", IEEE Transactions on Audio and Electroacoustics 15(2), 1967), and what they need of
// a recording: an even clock and a length that transforms fast.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "harness/base/vec.h"

namespace touchstone::discrepancy {

// The three components of a force over time [N].
using Axes = std::array<std::vector<double>, 3>;

// Averaged one-sided periodograms; the sum over bins is the mean square.
struct Spectra {
  double bin_Hz = 0.0;
  double averages = 1.0;  // independent ones that the overlapping segments amount to
  std::array<std::vector<double>, 3> power_N2;
};

// The largest length up to `n` without prime factors above 5, for which the transform is fast.
std::size_t fast_length(std::size_t n);

// The median step of the clock [s]; 0 of fewer than two samples.
double median_step_s(const std::vector<double>& t_s);

// A series on an even clock, linear between samples where the recording's is uneven.
Axes even(const std::vector<double>& t_s, const std::vector<Vec3>& series, double step_s);

// Of segments of `length` samples that overlap by a half; `length` is at most the series'.
Spectra welch(const Axes& axes, double step_s, std::size_t length);

// Running mean over `reach` bins to both sides.
std::vector<double> running_mean(const std::vector<double>& values, std::size_t reach);

}  // namespace touchstone::discrepancy
