// Line spectral frequencies, in which filters of a texture model are interpolated: between those of two stable filters
// lie stable filters.
//
// Source: Itakura 1975, "Line spectrum representation of linear predictor coefficients of speech signals", J. Acoust.
// Soc. Am. 57:S35; Soong and Juang 1984, "Line spectrum pair (LSP) and speech data compression", ICASSP. For
// A(z) = 1 + a1 z^-1 + ... + ap z^-p the polynomials A(z) +- z^-(p+1) A(1/z) have their zeros on the unit circle, and
// their angles interlace, exactly if A has its zeros inside it. The first, third ... angle is one of the sum.
#pragma once

#include <span>
#include <vector>

namespace touchstone::texture {

// 1, a1 ... ap from p ascending angles between 0 and pi. `out` has p + 1 places. Allocates nothing.
void polynomial_of(std::span<const double> angles_rad, std::span<double> out) noexcept;

// The inverse. `polynomial` begins with 1. Throws std::domain_error if a zero lies on or outside the unit circle.
std::vector<double> line_spectral_frequencies(std::span<const double> polynomial);

}  // namespace touchstone::texture
