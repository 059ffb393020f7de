// Sign changes of a smooth function of one variable, none missed: an interval is dropped only where a bound on the
// second derivative proves that it holds none. Linear interpolation between the ends of an interval of length h errs by
// at most m h^2 / 8 where |f''| <= m, hence ends of one sign and both beyond that leave no root between; and where the
// slope at an end exceeds m h the function is monotone. Negative is one side, zero and positive the other.
#pragma once

#include <algorithm>
#include <cmath>

namespace touchstone::synthetic {

struct Jet1 {
  double value;
  double slope;
};

// The root of f in a bracket [a, b] with different signs at its ends: Newton's method kept inside the bracket by
// bisection, until neither moves it: exact to the rounding of f.
template <class F>
double bracketed_root(const F& f, double a, double b, bool negative_at_a) {
  double x = 0.5 * (a + b);
  double last_step = b - a;
  for (int i = 0; i < 200; ++i) {
    const Jet1 at = f(x);
    if (at.value == 0.0) return x;
    ((at.value < 0.0) == negative_at_a ? a : b) = x;
    double next = x - at.value / at.slope;
    // Not inside (a, b) (also when the slope is 0), or converging slower than bisection would.
    if (!(next > a && next < b) || std::abs(next - x) > 0.5 * last_step) next = 0.5 * (a + b);
    last_step = std::abs(next - x);
    if (next == x || next <= a || next >= b) return x;
    x = next;
  }
  return x;
}

namespace detail {
template <class F, class Visit>
bool visit_sign_changes(const F& f, double a, const Jet1& fa, double b, const Jet1& fb, double second_derivative_bound,
                        double noise, const Visit& visit) {
  const double h = b - a;
  const double deviation = second_derivative_bound * h * h / 8.0;
  const bool differ = (fa.value < 0.0) != (fb.value < 0.0);
  if (!differ && std::min(std::abs(fa.value), std::abs(fb.value)) > deviation) return false;
  const double middle = 0.5 * (a + b);
  const bool smallest = deviation <= noise || middle <= a || middle >= b;
  const bool monotone = std::max(std::abs(fa.slope), std::abs(fb.slope)) > second_derivative_bound * h;
  if (differ && (monotone || smallest)) return visit(bracketed_root(f, a, b, fa.value < 0.0), fa.value >= 0.0);
  if (smallest || (!differ && monotone)) return false;
  const Jet1 fm = f(middle);
  return visit_sign_changes(f, a, fa, middle, fm, second_derivative_bound, noise, visit) ||
         visit_sign_changes(f, middle, fm, b, fb, second_derivative_bound, noise, visit);
}
}  // namespace detail

// Calls visit(root, downward) for the sign changes of f in [a, b] in increasing order until it returns true; says
// whether it did. `downward`: from not negative to negative. f returns Jet1; |f''| <= second_derivative_bound on [a,
// b]; an excursion across zero smaller than `noise` (the rounding of f) may be missed.
template <class F, class Visit>
bool visit_sign_changes(const F& f, double a, double b, double second_derivative_bound, double noise,
                        const Visit& visit) {
  return detail::visit_sign_changes(f, a, f(a), b, f(b), second_derivative_bound, noise, visit);
}

}  // namespace touchstone::synthetic
