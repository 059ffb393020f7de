// The mean of a short series that is correlated in time, and whether it differs from zero.
//
// The variance of the mean comes from the lowest frequencies: with Lambda_j = sqrt(2 / n) sum_i x_i cos(pi j (i + 1/2)
// / n), j = 1 .. nu, the long-run variance is the mean of the Lambda_j squared (each is free of the mean), and
// mean / standard error has Student's t distribution with nu degrees of freedom, if the spectrum is flat up to the
// frequency of Lambda_nu. Source: equal-weighted cosines, Lazarus, Lewis, Stock and Watson, HAR inference:
// recommendations for practice, Journal of Business and Economic Statistics 36 (2018); Mueller, Econometric Reviews 33
// (2014).
//
// Their nu = 0.4 n^(2/3) is for long series at a level of 5 %. For recordings of a quarter of a minute, tested at a
// thousandth, that is too many: nu is at most 5 (4 below 150 values), and at most n / (5 L), L being the lag after
// which the autocorrelation stays within the band of a white series (Politis and White, Econometric Reviews 23, 2004).
// If that leaves fewer than 4, the series is correlated over too long to say anything, and nothing is said. Both
// numbers were chosen on simulated series (correlation over 0.5 to 2 s, strokes, snags; ranking_test.cc counts).
#pragma once

#include <span>

namespace touchstone::stats {

struct SeriesMean {
  double mean = 0.0;
  double standard_error = 0.0;  // 0 for a series that does not vary
  double degrees = 0.0;         // nu; 0: the series is too short, or correlated over too long, to say anything
  double p = 1.0;               // two-sided, of mean = 0
};

inline constexpr double fewest_degrees = 4.0;
inline constexpr double most_degrees = 5.0;

SeriesMean series_mean(std::span<const double> series);

}  // namespace touchstone::stats
