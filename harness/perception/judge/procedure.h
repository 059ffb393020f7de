// From the share of right answers at which an experiment stopped to d', the distance of the two stimuli in standard
// deviations of the observer: what makes just noticeable differences of different procedures comparable (Macmillan and
// Creelman 2005).
#pragma once

namespace touchstone::perception {

// Where a staircase settles that makes the task harder after three right answers and easier after a wrong one: the
// share p with p^3 = 1/2 (Levitt 1971).
inline constexpr double three_down_one_up = 0.79370052598409974;
// Two right answers: p^2 = 1/2.
inline constexpr double two_down_one_up = 0.70710678118654752;

// One stimulus a trial, two answers, no bias: 2 z(p).
double d_prime_of_one_interval(double share_right);
// One interval of `alternatives` (2 or more) holds the changed stimulus, and the observer names it. The share right is
// the integral of phi(x - d') Phi(x)^(m - 1); for two, d' = sqrt(2) z(p). 0 at 1 / alternatives and below.
double d_prime_of_forced_choice(double share_right, int alternatives = 2);

}  // namespace touchstone::perception
