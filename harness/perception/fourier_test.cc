#include "harness/perception/fourier.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "harness/base/random.h"

namespace touchstone::perception {
namespace {

std::vector<double> noise(std::size_t n) {
  Random random(n);
  std::vector<double> x(n);
  for (double& v : x) v = random.normal();
  return x;
}

// Products of small primes, primes, their doubles, and one at which a padded length just serves.
const std::vector<std::size_t> lengths{1, 2, 3, 4, 5, 6, 7, 8, 9, 13, 17, 34, 64, 97, 129, 194, 251, 360, 502, 1009};

TEST(RealFourier, IsTheSumOfItsDefinition) {
  for (const std::size_t n : lengths) {
    const std::vector<double> x = noise(n);
    const auto spectrum = real_fourier(x);
    ASSERT_EQ(spectrum.size(), n / 2 + 1);
    for (std::size_t k = 0; k < spectrum.size(); ++k) {
      std::complex<long double> sum = 0.0L;
      for (std::size_t i = 0; i < n; ++i) {
        const long double angle =
            -2.0L * std::numbers::pi_v<long double> * static_cast<long double>(k * i % n) / static_cast<long double>(n);
        sum += static_cast<long double>(x[i]) * std::polar(1.0L, angle);
      }
      const std::complex<double> right(static_cast<double>(sum.real()), static_cast<double>(sum.imag()));
      EXPECT_LE(std::abs(spectrum[k] - right), 1e-14 * static_cast<double>(n)) << n << ", " << k;
    }
  }
  EXPECT_TRUE(real_fourier({}).empty());
}

TEST(CosineTransform, IsTheSumOfItsDefinitionAndComesBack) {
  for (const std::size_t n : lengths) {
    const std::vector<double> x = noise(n);
    const auto coefficients = cosine_transform(x);
    for (std::size_t k = 0; k < n; ++k) {
      long double sum = 0.0L;
      for (std::size_t i = 0; i < n; ++i) {
        sum += static_cast<long double>(x[i]) *
               std::cos(std::numbers::pi_v<long double> * static_cast<long double>((2 * i + 1) * k) /
                        static_cast<long double>(2 * n));
      }
      const long double scale = std::sqrt((k == 0 ? 1.0L : 2.0L) / static_cast<long double>(n));
      EXPECT_NEAR(coefficients[k], static_cast<double>(sum * scale), 1e-14 * static_cast<double>(n)) << n << ", " << k;
    }
    const auto back = inverse_cosine_transform(coefficients);
    for (std::size_t i = 0; i < n; ++i) EXPECT_NEAR(back[i], x[i], 1e-13) << n << ", " << i;
  }
}

}  // namespace
}  // namespace touchstone::perception
