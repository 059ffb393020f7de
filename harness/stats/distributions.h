// Distribution functions of statistics and their inverses, computed by Boost.Math.
#pragma once

namespace touchstone::stats {

// Standard normal distribution function and its inverse (0 < p < 1).
double normal_cdf(double z);
double normal_quantile(double p);
// P(X >= x) for chi-squared with `degrees` > 0 degrees of freedom.
double chi_squared_tail(double x, double degrees);
// Two-sided p of Student's t with `degrees` > 0 degrees of freedom.
double student_p(double t, double degrees);
// The 97.5 % quantile of Student's t with `degrees` > 0 degrees of freedom: half the width of a two-sided 95 %
// interval.
double student_t_975(double degrees);

// P(X >= x) for Fisher's F with `numerator` and `denominator` > 0 degrees of freedom.
double f_tail(double x, double numerator, double denominator);
// The x with P(X <= x) = p for Fisher's F, 0 < p < 1.
double f_quantile(double p, double numerator, double denominator);

}  // namespace touchstone::stats
