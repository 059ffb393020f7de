#include "harness/stats/distributions.h"

#include <algorithm>
#include <boost/math/distributions/fisher_f.hpp>
#include <boost/math/distributions/students_t.hpp>
#include <boost/math/special_functions/erf.hpp>
#include <boost/math/special_functions/gamma.hpp>
#include <cmath>
#include <numbers>

namespace touchstone::stats {

double normal_cdf(double z) { return 0.5 * std::erfc(-z / std::numbers::sqrt2); }

double normal_quantile(double p) { return -std::numbers::sqrt2 * boost::math::erfc_inv(2.0 * p); }

double chi_squared_tail(double x, double degrees) {
  return boost::math::gamma_q(0.5 * degrees, 0.5 * std::max(x, 0.0));
}

double student_p(double t, double degrees) {
  const boost::math::students_t_distribution<double> student(degrees);
  return 2.0 * boost::math::cdf(boost::math::complement(student, std::abs(t)));
}

double student_t_975(double degrees) { return boost::math::quantile(boost::math::students_t(degrees), 0.975); }

double f_tail(double x, double numerator, double denominator) {
  const boost::math::fisher_f_distribution<double> fisher(numerator, denominator);
  return boost::math::cdf(boost::math::complement(fisher, std::max(x, 0.0)));
}

double f_quantile(double p, double numerator, double denominator) {
  return boost::math::quantile(boost::math::fisher_f(numerator, denominator), p);
}

}  // namespace touchstone::stats
