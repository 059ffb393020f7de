#include "experiments/golden_section.h"

#include <gtest/gtest.h>

namespace touchstone::experiments {
namespace {

TEST(GoldenSection, FindsTheLeastPlaceOfACornerAtEveryScale) {
  for (const double scale : {1e-3, 1.0, 1e3}) {
    for (const double place : {-0.7, 0.0, 0.31, 1.0}) {
      const auto f = [&](double x) { return std::abs(x - place * scale); };
      EXPECT_NEAR(golden_section(f, -scale, scale, 1e-9 * scale), place * scale, 1e-9 * scale);
    }
  }
  // At the end of the interval where the function has no other least place.
  EXPECT_NEAR(golden_section([](double x) { return x; }, 2.0, 3.0, 1e-6), 2.0, 1e-6);
}

TEST(GoldenSection, CallsAsOftenAsTheRatioSaysAndEndsBelowRounding) {
  int calls = 0;
  const auto counted = [&calls](double x) {
    ++calls;
    return x * x;
  };
  golden_section(counted, -1.0, 1.0, 2e-3);
  // Two at first and one for each factor of 0.618 from 2 down to 0.002.
  EXPECT_EQ(calls, 2 + static_cast<int>(std::ceil(std::log(1e-3) / std::log(0.5 * (std::sqrt(5.0) - 1.0)))));
  EXPECT_NEAR(golden_section([](double x) { return std::abs(x - 1.0); }, 0.0, 3.0, 1e-300), 1.0, 1e-15);
  EXPECT_EQ(golden_section(counted, 4.0, 4.0, 1e-6), 4.0);
}

TEST(GoldenSection, RefusesWhatIsNoInterval) {
  const auto f = [](double x) { return x; };
  EXPECT_THROW(golden_section(f, 1.0, 0.0, 1e-6), std::invalid_argument);
  EXPECT_THROW(golden_section(f, std::nan(""), 1.0, 1e-6), std::invalid_argument);
  EXPECT_THROW(golden_section(f, 0.0, 1.0, 0.0), std::invalid_argument);
}

}  // namespace
}  // namespace touchstone::experiments
