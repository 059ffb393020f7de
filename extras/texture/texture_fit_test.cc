// A known process is found again in a recording of it, by a generator that shares nothing with the fit.
#include "texture_fit.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "harness/base/error.h"
#include "made_texture_for_test.h"
#include "segment_burg.h"

namespace touchstone::texture {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

// Two speeds, two loads; 40 s each. The frequency goes with the speed, the power with the load.
const std::vector<Hold> holds{{0.06, 0.5, 40.0}, {0.15, 0.5, 40.0}, {0.06, 1.5, 40.0}, {0.15, 1.5, 40.0}};
std::vector<std::pair<std::vector<double>, double>> filters(double rate_Hz) {
  return {{resonance(80.0, 0.9, rate_Hz), 0.05},
          {resonance(200.0, 0.9, rate_Hz), 0.05},
          {resonance(80.0, 0.9, rate_Hz), 0.3},
          {resonance(200.0, 0.9, rate_Hz), 0.3}};
}

class FitRates : public ::testing::TestWithParam<double> {};

// The error of Burg's estimate of order 2 is, from n samples, (1 - a2^2) / n of a2 and of a1 likewise, and 2 / n of the
// logarithm of the variance (Box and Jenkins 1976, chapter 7.2). The parabola over each window takes 3 of 256.
TEST_P(FitRates, CoefficientsVarianceAndFrictionAreFoundAgain) {
  const double rate_Hz = GetParam();
  const auto truth = filters(rate_Hz);
  const recording::Recording made = made_slide(holds, truth, 0.41, rate_Hz, 11);
  const SlideWindows windows = slide_windows(made, Vec3::UnitZ(), 1.0);
  const TextureFit fit = fit_texture(windows, made_mass_kg, "made");
  EXPECT_NEAR(fit.model.mu, 0.41, 0.002);
  EXPECT_NEAR(fit.model.rate_Hz, rate_Hz, 1e-6 * rate_Hz);
  ASSERT_EQ(fit.parts.size(), 4U);
  for (std::size_t h = 0; h < holds.size(); ++h) {
    const TextureFilter found = filter_at(fit.model, holds[h].speed_m_per_s, holds[h].load_N);
    TextureFilter right;
    right.ar_count = 2;
    std::copy(truth[h].first.begin(), truth[h].first.end(), right.ar.begin());
    right.ma[0] = 1.0;
    right.variance = truth[h].second;
    const double samples = holds[h].seconds * rate_Hz;
    EXPECT_NEAR(found.variance / right.variance, 1.0, 5.0 * std::sqrt(2.0 / samples));
    // The logarithm of the density has 2 (order + 1) / n as variance (Berk 1974, Ann. Statist. 2:489). The parabola
    // takes what lies below 10 Hz, and so few coefficients follow that gap with a shallow slope.
    const double error_dB = 4.343 * std::sqrt(2.0 * (static_cast<double>(fit.order) + 1.0) / samples);
    const double blurred_Hz = std::max(50.0, rate_Hz / static_cast<double>(fit.order));
    for (double f = 30.0; f < 0.45 * rate_Hz; f += 10.0) {
      EXPECT_NEAR(10.0 * std::log10(found.density(f, rate_Hz) / right.density(f, rate_Hz)), 0.0,
                  f < blurred_Hz ? 1.0 : 4.5 * error_dB)
          << f << " Hz, order " << fit.order;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Rates, FitRates, ::testing::Values(500.0, 1000.0, 2500.0),
                         [](const auto& test) { return fmt::format("{:g}_Hz", test.param); });

TEST(TextureFit, ATurnOfTheWorldChangesNothing) {
  const Quat turn(Eigen::AngleAxisd(1.1, Vec3(1.0, -2.0, 0.5).normalized()));
  const auto fitted = [&](const Quat& by) {
    const recording::Recording made = made_slide(holds, filters(1000.0), 0.3, 1000.0, 4, by);
    return fit_texture(slide_windows(made, by * Vec3::UnitZ(), 1.0), made_mass_kg, "made");
  };
  const TextureFit flat = fitted(Quat::Identity()), turned = fitted(turn);
  EXPECT_EQ(flat.order, turned.order);
  EXPECT_NEAR(flat.model.mu, turned.model.mu, 1e-9);
  const TextureFilter a = filter_at(flat.model, 0.1, 1.0), b = filter_at(turned.model, 0.1, 1.0);
  EXPECT_NEAR(a.density(120.0, 1000.0) / b.density(120.0, 1000.0), 1.0, 1e-6);
}

TEST(TextureFit, TheEdgesAreSilentAtRestAndFilled) {
  const recording::Recording made = made_slide(holds, filters(1000.0), 0.3, 1000.0, 4);
  const TextureModel model = fit_texture(slide_windows(made, Vec3::UnitZ(), 1.0), made_mass_kg, "made").model;
  EXPECT_EQ(filter_at(model, 0.0, 1.0).variance, 0.0);
  EXPECT_EQ(filter_at(model, 0.1, 0.0).variance, 0.0);
  EXPECT_GT(filter_at(model, 9.0, 9.0).variance, 0.2);
  // What is written is read, which checks that the triangles leave no gap.
  EXPECT_EQ(parse_texture_model(texture_model_to_xml(model), "m.xml").nodes.size(), model.nodes.size());
}

TEST(SegmentBurg, SegmentsAreOneProcessAndGiveAStableFilter) {
  std::mt19937_64 engine(8);
  std::normal_distribution<double> normal;
  const std::vector<double> a = resonance(90.0, 0.97, 1000.0);
  std::vector<std::vector<double>> series;
  for (int s = 0; s < 300; ++s) {
    double x1 = 0.0, x2 = 0.0;
    std::vector<double> one;
    for (int i = -300; i < 64; ++i) {
      const double x = normal(engine) - a[1] * x1 - a[2] * x2;
      x2 = x1;
      x1 = x;
      if (i >= 0) one.push_back(x);
    }
    series.push_back(one);
  }
  const SegmentBurg burg = segment_burg(series, 12);
  const double error = std::sqrt((1.0 - a[2] * a[2]) / (300.0 * 62.0));
  EXPECT_NEAR(burg.polynomials[2][1], a[1], 5.0 * error);
  EXPECT_NEAR(burg.polynomials[2][2], a[2], 5.0 * error);
  EXPECT_NEAR(burg.errors[2], 1.0, 5.0 * std::sqrt(2.0 / (300.0 * 64.0)) + 0.03);
  EXPECT_NO_THROW(line_spectral_frequencies(burg.polynomials[12]));
}

TEST(SlideWindows, OnlyEvenPartsCount) {
  recording::Recording made = made_slide({{0.1, 1.0, 4.0}}, {{resonance(90.0, 0.9, 1000.0), 0.1}}, 0.3, 1000.0, 2);
  const std::size_t all = slide_windows(made, Vec3::UnitZ(), 1.0).windows.size();
  EXPECT_EQ(all, 15U);
  // Half a second in the middle with a load that swings by half.
  for (std::size_t i = 1700; i < 2300; ++i) made.f_W_N[i].z() *= 1.0 + 0.6 * std::sin(0.02 * static_cast<double>(i));
  const std::size_t even = slide_windows(made, Vec3::UnitZ(), 1.0).windows.size();
  EXPECT_LT(even, all);
  EXPECT_GE(even, all - 5);
}

TEST(SlideWindows, WhatCannotBeUsedIsNamed) {
  recording::Recording made = made_slide({{0.1, 1.0, 4.0}}, {{resonance(90.0, 0.9, 1000.0), 0.1}}, 0.3, 1000.0, 2);
  EXPECT_THAT([&] { slide_windows(made, -Vec3::UnitZ(), 1.0); }, ThrowsMessage<BadData>(HasSubstr("--normal")));
  EXPECT_THAT(
      [&] {
        const auto short_one = made_slide({{0.1, 1.0, 0.9}}, {{resonance(90.0, 0.9, 1000.0), 0.1}}, 0.3, 1000.0, 2);
        fit_texture(slide_windows(short_one, Vec3::UnitZ(), 1.0), made_mass_kg, "made");
      },
      ThrowsMessage<BadData>(HasSubstr("slide longer")));
  recording::Recording huge = made;
  huge.f_W_N[5].x() = -1e200;
  EXPECT_THAT([&] { slide_windows(huge, Vec3::UnitZ(), 1.0); },
              ThrowsMessage<BadData>(HasSubstr("sample 6 (t = 0.005")));
  for (std::size_t i = 2000; i < made.size(); ++i) made.motion.t_s[i] += 0.01;
  EXPECT_THAT([&] { slide_windows(made, Vec3::UnitZ(), 1.0); }, ThrowsMessage<BadData>(HasSubstr("sample 2001")));
}

TEST(TextureFit, AForceThatDrivesTheMotionIsRefused) {
  const recording::Recording made =
      made_slide({{0.1, 1.0, 4.0}}, {{resonance(90.0, 0.9, 1000.0), 0.1}}, -0.3, 1000.0, 2);
  EXPECT_THAT([&] { fit_texture(slide_windows(made, Vec3::UnitZ(), 1.0), made_mass_kg, "made"); },
              ThrowsMessage<BadData>(HasSubstr("--flip-force")));
}

TEST(TextureFit, AForceWithoutAFastPartIsNoTexture) {
  const recording::Recording made = made_slide({{0.1, 1.0, 4.0}}, {{{1.0, 0.0}, 0.0}}, 0.0, 1000.0, 2);
  EXPECT_THAT([&] { fit_texture(slide_windows(made, Vec3::UnitZ(), 1.0), made_mass_kg, "made"); },
              ThrowsMessage<BadData>(HasSubstr("no fast part")));
}

}  // namespace
}  // namespace touchstone::texture
