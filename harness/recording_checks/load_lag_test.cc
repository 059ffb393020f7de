#include "harness/recording_checks/load_lag.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "harness/base/random.h"

namespace touchstone::recording_checks {
namespace {

struct Press {
  std::vector<double> t_s, load_N, depth_m;
};

// Pressing with two incommensurable rhythms at `rate_Hz` for 20 s; force k d + b d', late by `lag_s`.
Press press(double rate_Hz, double lag_s, double damping_s, double noise_N, Random& random) {
  Press p;
  const auto depth = [](double t) { return 2e-3 + 1e-3 * std::sin(9.0 * t) + 0.7e-3 * std::sin(3.7 * t + 1.0); };
  for (int i = 0; i < static_cast<int>(20.0 * rate_Hz); ++i) {
    const double t = i / rate_Hz;
    const double late = t - lag_s, h = 1e-4;
    const double rate = (depth(late + h) - depth(late - h)) / (2 * h);
    p.t_s.push_back(t);
    p.depth_m.push_back(depth(t));
    p.load_N.push_back(500.0 * (depth(late) + damping_s * rate) + noise_N * random.normal());
  }
  return p;
}

TEST(LoadLag, IsFoundWithItsSizeOfEitherSign) {
  Random random(1);
  for (const double rate_Hz : {66.0, 250.0, 1000.0}) {
    for (const double lag_s : {-0.2, -0.1, 0.06, 0.1, 0.3}) {
      const Press p = press(rate_Hz, lag_s, 0.0, 0.02, random);
      const auto lag = find_load_lag(p.t_s, p.load_N, p.depth_m);
      ASSERT_TRUE(lag) << lag_s;
      EXPECT_NEAR(lag->lag_s, lag_s, 1.01 / rate_Hz);
      EXPECT_GT(lag->shifted, 0.99);
    }
  }
}

TEST(LoadLag, ClocksThatAgreeAndDampingAreNotBlamed) {
  Random random(2);
  for (const double damping_s : {0.0, 0.01, 0.03, 0.1}) {
    for (const double noise_N : {0.0, 0.05, 0.3}) {
      const Press p = press(250.0, 0.0, damping_s, noise_N, random);
      EXPECT_FALSE(find_load_lag(p.t_s, p.load_N, p.depth_m)) << damping_s << " " << noise_N;
    }
  }
}

TEST(LoadLag, AConstantLoadTellsNothing) {
  Random random(3);
  Press p = press(250.0, 0.0, 0.0, 0.0, random);
  for (double& f : p.load_N) f = 1.0 + 0.01 * random.normal();
  EXPECT_FALSE(find_load_lag(p.t_s, p.load_N, p.depth_m));
  for (double& f : p.load_N) f = 1.0;
  EXPECT_FALSE(find_load_lag(p.t_s, p.load_N, p.depth_m));
}

TEST(LoadLag, TwoClocksOfDifferentRatesDrift) {
  Random random(4);
  Press p = press(250.0, 0.0, 0.0, 0.0, random);
  const Press exact = p;
  for (std::size_t i = 0; i < p.t_s.size(); ++i) {  // the force's clock runs 1 % slow, 0.1 s late at the start
    const double t = 0.99 * p.t_s[i] - 0.1;
    const auto k = static_cast<std::size_t>(std::max(0.0, t * 250.0));
    p.load_N[i] = exact.load_N[k];
  }
  const auto lag = find_load_lag(p.t_s, p.load_N, p.depth_m);
  ASSERT_TRUE(lag);
  EXPECT_NEAR(lag->drift_s, 0.1, 0.04);
}

}  // namespace
}  // namespace touchstone::recording_checks
