#include "harness/rendering/smooth_field.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "harness/base/error.h"

namespace touchstone::rendering {
namespace {

std::map<std::string, double> range(double columns, double rows) {
  return {{"x_low_m", -1.0}, {"x_high_m", 2.0},    {"y_low_m", 0.5},
          {"y_high_m", 1.5}, {"columns", columns}, {"rows", rows}};
}

// Cubic B-splines reproduce polynomials up to the third degree; Marsden's identity gives the coefficients of the first:
// of the place itself they are the knots' means (de Boor 1978, chapter IX).
TEST(SmoothField, ReproducesAPlaneWithItsSlope) {
  auto parameters = range(7.0, 5.0);
  for (std::size_t row = 0; row < 5; ++row) {
    for (std::size_t column = 0; column < 7; ++column) {
      const double x = -1.0 + 3.0 / 4.0 * (static_cast<double>(column) - 1.0);
      const double y = 0.5 + 1.0 / 2.0 * (static_cast<double>(row) - 1.0);
      parameters[field_coefficient(column, row)] = 0.3 + 2.0 * x - 0.7 * y;
    }
  }
  const SmoothField field = field_of(parameters, "test");
  for (const double x : {-0.99, -0.25, 0.1, 0.75, 1.9}) {
    for (const double y : {0.51, 0.8, 1.0, 1.49}) {
      const SmoothField::Value value = field.with_slope(x, y);
      EXPECT_NEAR(value.value, 0.3 + 2.0 * x - 0.7 * y, 1e-12);
      EXPECT_NEAR(value.along_x, 2.0, 1e-12);
      EXPECT_NEAR(value.along_y, -0.7, 1e-12);
      EXPECT_DOUBLE_EQ(field.at(x, y), value.value);
    }
  }
}

TEST(SmoothField, KeepsTheValueOfItsBorderOutsideAndHasItsSlopeInside) {
  auto parameters = range(6.0, 6.0);
  for (std::size_t i = 0; i < 36; ++i)
    parameters[field_coefficient(i % 6, i / 6)] = std::sin(static_cast<double>(i * i));
  const SmoothField field = field_of(parameters, "test");
  EXPECT_DOUBLE_EQ(field.at(-7.0, 0.9), field.at(-1.0, 0.9));
  EXPECT_DOUBLE_EQ(field.at(0.4, 9.0), field.at(0.4, 1.5));
  EXPECT_EQ(field.with_slope(-7.0, 0.9).along_x, 0.0);
  constexpr double h = 1e-6;
  for (const double x : {-0.7, 0.31, 1.7}) {
    const SmoothField::Value value = field.with_slope(x, 1.23);
    EXPECT_NEAR(value.along_x, (field.at(x + h, 1.23) - field.at(x - h, 1.23)) / (2.0 * h), 1e-7);
    EXPECT_NEAR(value.along_y, (field.at(x, 1.23 + h) - field.at(x, 1.23 - h)) / (2.0 * h), 1e-7);
  }
}

TEST(SmoothField, RefusesAnEmptyRangeAndHalfACoefficientWithTheirPlace) {
  const auto message = [](const std::map<std::string, double>& parameters) {
    try {
      check_field(parameters, "m.json: /effects/0/parameters");
    } catch (const BadData& error) {
      return std::string(error.what());
    }
    return std::string("accepted");
  };
  auto empty = range(5.0, 5.0);
  empty["x_high_m"] = -1.0;
  EXPECT_THAT(message(empty), ::testing::AllOf(::testing::HasSubstr("/effects/0"), ::testing::HasSubstr("x_high_m")));
  EXPECT_THAT(message(range(4.5, 5.0)), ::testing::HasSubstr("columns 4.5 is not a whole number"));
  EXPECT_EQ(message(range(5.0, 5.0)), "accepted");
  for (const auto& outside : {field_coefficient(5, 0), field_coefficient(0, 5)}) {
    auto transposed = range(5.0, 5.0);
    transposed[outside] = 0.5;
    EXPECT_THAT(message(transposed),
                ::testing::AllOf(::testing::HasSubstr(outside), ::testing::HasSubstr("nothing reads it")));
    transposed[outside] = 0.0;
    EXPECT_EQ(message(transposed), "accepted");
  }
}

TEST(SmoothField, KnowsItsCoefficientsByName) {
  EXPECT_TRUE(is_field_coefficient(field_coefficient(0, 19)));
  for (const char* const other : {"c_xz", "columns", "c_1_2", "c_01-02", "d_01_02"}) {
    EXPECT_FALSE(is_field_coefficient(other)) << other;
  }
}

}  // namespace
}  // namespace touchstone::rendering
