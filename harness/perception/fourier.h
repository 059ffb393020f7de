// Real transforms by Eigen's FFT (kissfft), for lengths with a large prime by Bluestein's convolution: no code under
// the GPL, and every run and machine rounds alike. Safe to call from several threads.
#pragma once

#include <complex>
#include <span>
#include <vector>

namespace touchstone::perception {

// Sum over n of x[n] exp(-2 pi i k n / N) for k = 0..N/2; empty for an empty input.
std::vector<std::complex<double>> real_fourier(std::span<const double> x);
// The orthonormal discrete cosine transform of type II, and its inverse (type III), by a real transform of the same
// length (Makhoul 1980, "A fast cosine transform in one and two dimensions", eq 5-11).
std::vector<double> cosine_transform(std::span<const double> x);
std::vector<double> inverse_cosine_transform(std::span<const double> coefficients);

}  // namespace touchstone::perception
