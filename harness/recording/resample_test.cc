// Each method against functions that it must reproduce exactly, against its stated error on sines, and at gaps.
#include "harness/recording/resample.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>

#include "harness/base/error.h"
#include "harness/base/random.h"

namespace touchstone::recording {
namespace {

using ::testing::ElementsAre;
constexpr double pi = std::numbers::pi;

// Sampling times with jitter.
std::vector<double> jittered(int n, double interval_s, std::uint64_t seed) {
  Random random(seed);
  std::vector<double> t_s;
  for (int i = 0; i < n; ++i) t_s.push_back(interval_s * (i + 0.4 * (random.uniform() - 0.5)));
  return t_s;
}

std::vector<Vec3> sampled(const std::vector<double>& t_s, const std::function<Vec3(double)>& f) {
  std::vector<Vec3> values;
  for (const double t : t_s) values.push_back(f(t));
  return values;
}

TEST(Resample, EachMethodReproducesItsPolynomialsOnAnyClockAndScale) {
  for (const double scale : {1e-3, 1.0, 1e3}) {
    const auto t_s = jittered(200, 1e-2 * scale, 1);
    const auto targets = uniform_times(t_s.front(), t_s.back(), 377.0 / scale);
    const Vec3 a(1, -2, 3);
    const Vec3 b(0.5, 4, -1);
    const Vec3 c(-3, 1, 2);
    const Vec3 d(2, 2, -5);
    const auto line = [&](double t) { return Vec3(a + b * (t / scale)); };
    const auto cubic = [&](double t) {
      const double u = t / scale;
      return Vec3(a + u * (b + u * (c + u * d)));
    };
    const auto worst = [&](const std::function<Vec3(double)>& f, const ResampleOptions& options) {
      const auto result = resample(t_s, sampled(t_s, f), targets, options);
      double error = 0.0;
      for (std::size_t i = 0; i < targets.size(); ++i) {
        EXPECT_EQ(result.valid[i], 1);
        error = std::max(error, (result.values[i] - f(targets[i])).norm() / (1.0 + f(targets[i]).norm()));
      }
      return error;
    };
    EXPECT_LE(worst(line, {.method = Interpolation::linear}), 1e-14);
    EXPECT_LE(worst(cubic, {.method = Interpolation::cubic}), 1e-13) << "at the ends too";
    EXPECT_LE(worst(line, {.method = Interpolation::windowed_average, .target_rate_Hz = 20.0 / scale}), 1e-13)
        << "at the ends too";
    EXPECT_GT(worst(cubic, {.method = Interpolation::linear}), 1e-6) << "the check can fail";
  }
}

TEST(Resample, HoldGivesTheLastSample) {
  const std::vector<double> t_s{0, 1, 2};
  const std::vector<double> values{5, 7, 9};
  const auto held = resample(t_s, values, {0, 0.999, 1, 1.5, 2}, {.method = Interpolation::zero_order_hold});
  EXPECT_THAT(held.values, ElementsAre(5, 5, 7, 7, 9));
}

// The largest error on a sine of frequency x (in units of the sampling rate) and amplitude 1, over all phases.
double sine_error(Interpolation method, double x) {
  std::vector<double> t_s;
  std::vector<double> values;
  double worst = 0.0;
  for (int phase = 0; phase < 32; ++phase) {
    t_s.clear();
    values.clear();
    const auto f = [&](double t) { return std::sin(2.0 * pi * x * t + phase * pi / 16.0); };
    for (int i = 0; i < 60; ++i) {
      t_s.push_back(i);
      values.push_back(f(i));
    }
    std::vector<double> targets;
    for (int i = 0; i < 32 * 20; ++i) targets.push_back(20.0 + i / 32.0);
    const auto result = resample(t_s, values, targets, {.method = method});
    for (std::size_t i = 0; i < targets.size(); ++i)
      worst = std::max(worst, std::abs(result.values[i] - f(targets[i])));
  }
  return worst;
}

TEST(Resample, ErrorOnSinesIsWithinTheStatedBoundsAndNearThem) {
  for (const double x : {0.003, 0.03, 0.1, 0.2}) {
    const double linear = 1.0 - std::cos(pi * x);
    EXPECT_LE(sine_error(Interpolation::linear, x), linear * (1.0 + 1e-9));
    EXPECT_GE(sine_error(Interpolation::linear, x), 0.98 * linear);
    const double cubic = 3.0 / 128.0 * std::pow(2.0 * pi * x, 4);
    EXPECT_LE(sine_error(Interpolation::cubic, x), cubic + 1e-14);
    EXPECT_GE(sine_error(Interpolation::cubic, x), 0.5 * cubic);
    const double hold = 2.0 * std::sin(pi * x);
    EXPECT_LE(sine_error(Interpolation::zero_order_hold, x), hold);
    EXPECT_GE(sine_error(Interpolation::zero_order_hold, x), 0.9 * hold);
  }
}

TEST(Resample, WindowedAverageHasTheStatedGain) {
  // 5 kHz force down to a 60 Hz tracker.
  const double rate_Hz = 60.0;
  std::vector<double> t_s;
  for (int i = 0; i < 5000; ++i) t_s.push_back(i / 5000.0);
  const double time_s = 0.5;
  for (const double f_Hz : {1.0, 10.0, 30.0, 59.99, 90.0, 150.0, 480.0, 1200.0}) {
    std::vector<double> values;
    for (const double t : t_s) values.push_back(std::cos(2.0 * pi * f_Hz * (t - time_s)));
    const auto result =
        resample(t_s, values, {time_s}, {.method = Interpolation::windowed_average, .target_rate_Hz = rate_Hz});
    const double u = 2.0 * f_Hz / rate_Hz;
    const double gain = u == 1.0 ? 0.5 : std::sin(pi * u) / (pi * u) / (1.0 - u * u);
    EXPECT_NEAR(result.values[0], gain, 2e-3) << f_Hz << " Hz";
    EXPECT_TRUE(f_Hz < rate_Hz || std::abs(result.values[0]) <= 0.029) << f_Hz << " Hz";
  }
}

TEST(Resample, SlerpTurnsSteadilyTheShorterWay) {
  Random random(5);
  for (int trial = 0; trial < 50; ++trial) {
    const Quat start = random.rotation();
    const Vec3 axis = random.direction();
    const double rate = random.uniform(-2.0, 2.0);
    const auto exact = [&](double t) { return Quat(Eigen::AngleAxisd(rate * t, axis) * start); };
    std::vector<double> t_s;
    std::vector<Quat> values;
    for (int i = 0; i < 5; ++i) {
      t_s.push_back(0.3 * i);
      Quat q = exact(t_s.back());
      if (random.uniform() < 0.5) q.coeffs() *= -1.0;
      values.push_back(q);
    }
    const auto targets = uniform_times(0.0, 1.2, 50.0);
    for (const auto method : {Interpolation::linear, Interpolation::cubic, Interpolation::windowed_average}) {
      const auto result = resample(t_s, values, targets, {.method = method, .target_rate_Hz = 50.0});
      for (std::size_t i = 0; i < targets.size(); ++i) {
        EXPECT_LE(result.values[i].angularDistance(exact(targets[i])), 1e-7);
      }
    }
  }
}

TEST(Resample, NothingIsMadeUpAcrossGapsOrOutside) {
  const std::vector<double> t_s{0, 1, 2, 10, 11, 12, 13, 14};
  const std::vector<double> values{0, 1, 2, 100, 101, 102, 103, 104};
  const std::vector<double> targets{-0.5, 0, 1.5, 2, 2.5, 9.9, 10, 10.5, 14, 14.1};
  for (const auto method :
       {Interpolation::zero_order_hold, Interpolation::linear, Interpolation::cubic, Interpolation::windowed_average}) {
    ResampleOptions options{.method = method, .longest_gap_s = 2.0, .target_rate_Hz = 0.4};
    const auto result = resample(t_s, values, targets, options);
    EXPECT_THAT(result.valid, ElementsAre(0, 1, 1, 1, 0, 0, 1, 1, 1, 0)) << name_of(method);
    for (std::size_t i = 0; i < targets.size(); ++i) {
      EXPECT_EQ(std::isnan(result.values[i]), result.valid[i] == 0);
    }
    if (method != Interpolation::zero_order_hold) {
      // A stencil or window that reached over the gap would bend these.
      EXPECT_NEAR(result.values[2], 1.5, 1e-12);
      EXPECT_NEAR(result.values[3], 2.0, 1e-12);
      EXPECT_NEAR(result.values[6], 100.0, 1e-12);
      EXPECT_NEAR(result.values[7], 100.5, 1e-12);
    }
    options.refuse = true;
    EXPECT_THROW(resample(t_s, values, {2.5}, options), BadData);
    EXPECT_THROW(resample(t_s, values, {-1.0}, options), BadData);
    EXPECT_NO_THROW(resample(t_s, values, {2.0, 10.0}, options));
  }
  // Without a limit every interval is bridged.
  EXPECT_EQ(resample(t_s, values, {6.0}, {}).values[0], 51.0);
}

TEST(Resample, RefusesArgumentsThatMakeNoSense) {
  const std::vector<double> t_s{0, 1};
  const std::vector<double> two{1, 2};
  EXPECT_THROW(resample({0}, std::vector<double>{1}, {0}, {}), std::invalid_argument);
  EXPECT_THROW(resample(t_s, std::vector<double>{1, 2, 3}, {0}, {}), std::invalid_argument);
  EXPECT_THROW(resample({1, 1}, two, {1}, {}), std::invalid_argument);
  EXPECT_THROW(resample(t_s, two, {0}, {.method = Interpolation::windowed_average}), std::invalid_argument);
  EXPECT_THROW(uniform_times(0, 1, 0), std::invalid_argument);
  EXPECT_THAT(uniform_times(0, 1, 4), ElementsAre(0, 0.25, 0.5, 0.75, 1));
}

}  // namespace
}  // namespace touchstone::recording
