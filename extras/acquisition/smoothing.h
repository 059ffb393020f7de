// Smoothing and resampling with a stated bandwidth: local linear regression under a Gaussian kernel (Fan and Gijbels
// 1996, section 2.3), evaluated at any times. It has no phase lag, reproduces straight lines exactly, uneven sampling
// and the ends included, and on even samples its gain is exp(-(2 pi f sigma)^2 / 2): -3 dB at the cutoff for sigma =
// sqrt(ln 2) / (2 pi f_c).
#pragma once

#include <string>
#include <vector>

#include "harness/base/vec.h"

namespace touchstone::acquisition {

struct Smoothed {
  std::vector<Vec3> values;
  double bandwidth_Hz = 0.0;  // -3 dB of what came out: the cutoff, or less where the samples do not carry as much
  double noise_gain = 0.0;    // standard deviation of white noise after against before, mean over the queries
};

// Values at t_query_s. `t_s` is strictly increasing; queries must lie within its range widened by one sample. Throws
// BadData where a query has fewer than 2 samples within reach of the kernel (a gap): a value there would be invented.
Smoothed smooth_at(const std::vector<double>& t_s, const std::vector<Vec3>& values,
                   const std::vector<double>& t_query_s, double cutoff_Hz, const std::string& what);

// Gaussian width for a -3 dB frequency.
double gaussian_sigma_s(double cutoff_Hz);

// Orientations by spherical linear interpolation at the query times; the same conditions.
std::vector<Quat> slerp_at(const std::vector<double>& t_s, const std::vector<Quat>& q,
                           const std::vector<double>& t_query_s, const std::string& what);

// Positions by linear interpolation at the query times; the same conditions.
std::vector<Vec3> lerp_at(const std::vector<double>& t_s, const std::vector<Vec3>& p,
                          const std::vector<double>& t_query_s, const std::string& what);

// Median distance between samples.
double sample_interval_s(const std::vector<double>& t_s);

}  // namespace touchstone::acquisition
