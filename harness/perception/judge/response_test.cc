#include "harness/perception/judge/response.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace touchstone::perception {
namespace {

// Presses of 10 mm, once a second for 8 s, on an object with the given force [N] over depth [m].
template <class Force>
FeltSeries presses(Force force) {
  FeltSeries felt;
  felt.name = "presses";
  felt.rate_Hz = 500.0;
  for (int i = 0; i < 4000; ++i) {
    const double phase = 2.0 * std::numbers::pi * i / felt.rate_Hz;
    const double depth_m = -0.010 * std::cos(phase);
    felt.depth_m.push_back(depth_m);
    felt.rate_of_depth_m_per_s.push_back(0.010 * 2.0 * std::numbers::pi * std::sin(phase));
    felt.slide_x.push_back(0.0);
    felt.slide_y.push_back(0.0);
    felt.slide_m_per_s.push_back(0.0);
    felt.force_N[0].push_back(depth_m > 0.0 ? force(depth_m) : 0.0);
    felt.force_N[1].push_back(0.0);
    felt.force_N[2].push_back(0.0);
  }
  return felt;
}

constexpr FirstContact at_zero{0.0, true};

TEST(Response, HasAKnotForEverySpacingDownToTheDeepest) {
  const auto felt = presses([](double d) { return 400.0 * d; });
  EXPECT_EQ(fit_response(felt, at_zero, {0.001})->knots(), 11u);
  EXPECT_EQ(fit_response(felt, at_zero, {0.003})->knots(), 5u);
  EXPECT_EQ(fit_response(felt, at_zero, {0.020})->knots(), 2u);
  // However fine the grid of the other recording is.
  EXPECT_EQ(fit_response(felt, at_zero, {1e-7})->knots(), 48u);
}

TEST(Response, IsTheObjectsForceOverDepth) {
  const auto felt = presses([](double d) { return 400.0 * d; });
  const auto response = fit_response(felt, at_zero, {0.001});
  ASSERT_TRUE(response);
  EXPECT_NEAR(response->deepest_m, 0.010, 1e-12);
  for (std::size_t j = 0; j < response->knots(); ++j) {
    EXPECT_NEAR(response->curves.normal_N[j], 0.4 * static_cast<double>(j), 1e-6);
    EXPECT_NEAR(response->curves.normal_N_s_per_m[j], 0.0, 1e-4);
  }
  EXPECT_NEAR(residual_squares_N2(*response, felt), 0.0, 1e-8);
}

// An object that is stiffer in every other press: no force over depth is both.
TEST(Response, SaysWhatForceItLeaves) {
  auto felt = presses([](double d) { return 400.0 * d; });
  auto response = fit_response(felt, at_zero, {0.001});
  measure_left(*response, felt);
  for (const double left_N : response->left_N) EXPECT_LT(left_N, 0.01);
  for (std::size_t i = 0; i < felt.size(); ++i) felt.force_N[0][i] *= (i / 500) % 2 == 0 ? 1.3 : 0.7;
  response = fit_response(felt, at_zero, {0.001});
  measure_left(*response, felt);
  for (std::size_t j = 2; j < response->knots(); ++j)
    EXPECT_NEAR(response->left_N[j], 0.3 * 0.4 * static_cast<double>(j), 0.12) << j;
  for (const double left_N : response->left_side_N) EXPECT_LT(left_N, 1e-6);
}

TEST(Response, NothingIsFittedWhereThereIsNoDepth) {
  const auto felt = presses([](double d) { return 400.0 * d; });
  EXPECT_FALSE(fit_response(felt, at_zero, {0.0}));
  EXPECT_FALSE(fit_response(felt, {0.010, true}, {0.001}));
}

}  // namespace
}  // namespace touchstone::perception
