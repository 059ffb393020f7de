// The loss of a whitened block in all fits: least squares that are robust against blocks that no noise explains (Huber
// 1964).
#pragma once

#include <cmath>

namespace touchstone::discrepancy {

// Whitened blocks beyond this many standard deviations count linearly.
inline constexpr double huber = 5.0;

// Huber's rho of the square of a whitened block, in units of chi-squared.
inline double huber_loss(double square) {
  return square <= huber * huber ? square : 2.0 * huber * std::sqrt(square) - huber * huber;
}
// Its derivative by the square: the weight of the block in reweighted least squares.
inline double huber_weight(double square) { return square > huber * huber ? huber / std::sqrt(square) : 1.0; }

}  // namespace touchstone::discrepancy
