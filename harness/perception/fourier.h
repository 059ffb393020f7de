// Real transforms by FFTW with plans that do not measure (so that runs agree to the bit). Safe to call from several
// threads.
#pragma once

#include <complex>
#include <span>
#include <vector>

namespace touchstone::perception {

// Sum over n of x[n] exp(-2 pi i k n / N) for k = 0..N/2; empty for an empty input.
std::vector<std::complex<double>> real_fourier(std::span<const double> x);
// The orthonormal discrete cosine transform of type II, and its inverse (type III), by a real transform of the same
// length (Makhoul 1980, "A fast cosine transform in one and two dimensions", eq 5-11): FFTW's own takes several times
// as long where it does not measure.
std::vector<double> cosine_transform(std::span<const double> x);
std::vector<double> inverse_cosine_transform(std::span<const double> coefficients);

}  // namespace touchstone::perception
