#include "harness/perception/filters/output_band.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "harness/base/error.h"
#include "harness/base/random.h"
#include "harness/perception/fourier.h"

namespace touchstone::perception {
namespace {

std::vector<double> noise(std::size_t n, std::uint64_t seed) {
  Random random(seed);
  std::vector<double> x(n);
  for (double& value : x) value = random.normal();
  return x;
}

TEST(Fourier, AgreesWithTheSumsWrittenOut) {
  for (const std::size_t n : {1u, 2u, 7u, 30u, 64u}) {
    const auto x = noise(n, n);
    const auto y = real_fourier(x);
    ASSERT_EQ(y.size(), n / 2 + 1);
    for (std::size_t k = 0; k < y.size(); ++k) {
      std::complex<double> sum = 0.0;
      for (std::size_t t = 0; t < n; ++t) {
        sum += x[t] * std::polar(1.0, -2.0 * std::numbers::pi * static_cast<double>(k * t) / static_cast<double>(n));
      }
      EXPECT_LT(std::abs(sum - y[k]), 1e-12 * static_cast<double>(n));
    }
    const auto c = cosine_transform(x);
    double energy = 0.0;
    for (std::size_t k = 0; k < n; ++k) {
      double sum = 0.0;
      for (std::size_t t = 0; t < n; ++t) {
        sum += x[t] * std::cos(std::numbers::pi * (static_cast<double>(t) + 0.5) * static_cast<double>(k) /
                               static_cast<double>(n));
      }
      EXPECT_NEAR(c[k], sum * std::sqrt((k == 0 ? 1.0 : 2.0) / static_cast<double>(n)), 1e-12 * static_cast<double>(n));
      energy += c[k] * c[k] - x[k] * x[k];
    }
    EXPECT_NEAR(energy, 0.0, 1e-11);  // orthonormal
    const auto back = inverse_cosine_transform(c);
    for (std::size_t t = 0; t < n; ++t) EXPECT_NEAR(back[t], x[t], 1e-12);
  }
  EXPECT_TRUE(real_fourier({}).empty());
  EXPECT_TRUE(cosine_transform({}).empty());
}

TEST(OutputBand, IsALinearProjection) {
  const auto x = noise(1000, 3);
  const auto y = noise(1000, 4);
  const auto fx = output_band(x, 1000.0, 6.0);
  const auto fy = output_band(y, 1000.0, 6.0);
  const auto again = output_band(fx, 1000.0, 6.0);
  std::vector<double> sum(1000);
  for (std::size_t t = 0; t < 1000; ++t) sum[t] = 2.0 * x[t] - 3.0 * y[t];
  const auto fsum = output_band(sum, 1000.0, 6.0);
  for (std::size_t t = 0; t < 1000; ++t) {
    EXPECT_NEAR(again[t], fx[t], 1e-13);
    EXPECT_NEAR(fsum[t], 2.0 * fx[t] - 3.0 * fy[t], 1e-12);
  }
}

TEST(OutputBand, KeepsSlowPressesAndTheirEndsAndDropsVibration) {
  std::vector<double> slow(4000);
  std::vector<double> both(4000);
  for (std::size_t n = 0; n < slow.size(); ++n) {
    const double t = static_cast<double>(n) / 1000.0;
    slow[n] = 1.0 + t - std::cos(2.0 * std::numbers::pi * 1.0 * (t + 0.0005));  // starts and ends far apart
    both[n] = slow[n] + 0.3 * std::sin(2.0 * std::numbers::pi * 40.0 * t);
  }
  const auto filtered = output_band(both, 1000.0);
  double worst = 0.0;
  for (std::size_t n = 0; n < slow.size(); ++n) worst = std::max(worst, std::abs(filtered[n] - slow[n]));
  EXPECT_LT(worst, 0.05);  // the ramp's own content above 6 Hz at its ends, far below 0.3
  EXPECT_THROW(output_band(slow, 0.0, 6.0), UsageError);
  EXPECT_THROW(output_band(slow, 1000.0, std::nan("")), UsageError);
}

}  // namespace
}  // namespace touchstone::perception
