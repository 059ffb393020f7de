#include "harness/report/quantity.h"

#include <limits>

namespace touchstone::report {
namespace {

TEST(Quantity, PicksTheUnitThatSuitsTheValue) {
  EXPECT_EQ(display_quantity(0.418, "N"), "0.4180 N");
  EXPECT_EQ(display_quantity(3.15e-3, "m"), "3.150 mm");
  EXPECT_EQ(display_quantity(1.25e-5, "m"), "12.50 um");
  EXPECT_EQ(display_quantity(12.0, "m"), "12 m");
  EXPECT_EQ(display_quantity(2500.0, "us"), "2.500 ms");
  EXPECT_EQ(display_quantity(-0.0042, "s"), "-4.200 ms");
  EXPECT_EQ(display_quantity(7.0, "1"), "7");
  EXPECT_EQ(display_quantity(12.345678, "deg"), "12.35 deg");
  EXPECT_EQ(display_quantity(0.0, "m"), "0 m");
  EXPECT_EQ(display_quantity(4.2e-20, "m"), "4.200e-20 m");
  EXPECT_EQ(display_setting(5e-4, "m"), "0.5 mm");
  EXPECT_EQ(display_setting(0.1, "N"), "0.1 N");
}

TEST(Quantity, NeverHidesWhatIsNotANumber) {
  EXPECT_EQ(display_quantity(std::numeric_limits<double>::quiet_NaN(), "N"), "not a number");
  EXPECT_EQ(display_number(std::numeric_limits<double>::infinity()), "not a number");
}

TEST(Quantity, KeepsFourDigitsOverTheRangeOfDouble) {
  for (const double value : {1.2345e-300, 1.2345e-6, 1.2345e-3, 1.2345, 123.45, 12345.4, 1.2345e9, 1.2345e300}) {
    EXPECT_NEAR(std::stod(display_number(value)), value, 5.1e-4 * value) << display_number(value);
  }
}

}  // namespace
}  // namespace touchstone::report
