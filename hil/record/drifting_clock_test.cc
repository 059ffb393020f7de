// The axis of a device whose clock is off and drifts, from arrivals that are disturbed as a network and a busy machine
// disturb them: against the clock that made them.
#include "record/drifting_clock.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "harness/base/random.h"

namespace touchstone::hil {
namespace {

struct Device {
  double rate_Hz = 5000.0;   // at the beginning
  double drift_per_s = 0.0;  // of the rate, as a part of it: 1e-8 is 0.6 parts in a million a minute
  double seconds = 120.0;
  // When the n-th sample is taken.
  [[nodiscard]] double at(std::uint64_t n) const {
    // n = rate (t + drift t^2 / 2), solved for t.
    const double x = static_cast<double>(n) / rate_Hz;
    return drift_per_s == 0.0 ? x : (std::sqrt(1.0 + 2.0 * drift_per_s * x) - 1.0) / drift_per_s;
  }
};

// Delays: a least one, a tail, and stretches in which everything comes late in lumps.
std::vector<std::pair<std::uint64_t, double>> arrivals_of(const Device& device, Random& random) {
  std::vector<std::pair<double, double>> bursts;  // from, and how long
  for (int i = 0; i < 6; ++i) bursts.emplace_back(random.uniform(0, device.seconds), random.uniform(0.05, 3.0));
  std::vector<std::pair<std::uint64_t, double>> all;
  double last = 0.0;
  for (std::uint64_t n = 0;; ++n) {
    const double t = device.at(n);
    if (t > device.seconds) break;
    if (random.uniform(0, 1) < 1e-3) continue;  // lost
    double arrival = t + 30e-6 - 150e-6 * std::log(1.0 - random.uniform(0, 1));
    for (const auto& [from, length] : bursts) {
      if (t > from && t < from + length) arrival += 5e-3 + 10e-3 * random.uniform(0, 1);
    }
    last = std::max(last, arrival);  // in order
    all.emplace_back(n, last);
  }
  return all;
}

TEST(DriftingClock, IsTheLineWithoutDrift) {
  Random random(401);
  const Device device{.rate_Hz = 5000.0, .drift_per_s = 0.0, .seconds = 60.0};
  DriftingClock clock;
  EnvelopeClock line;
  for (const auto& [n, t] : arrivals_of(device, random)) clock.add(n, t), line.add(n, t);
  const auto axis = clock.axis();
  EXPECT_EQ(axis.drift_s, 0.0);
  EXPECT_EQ(axis.at(1000), line.line().at(1000));
  EXPECT_EQ(axis.at(299000), line.line().at(299000));
}

TEST(DriftingClock, KeepsTheAxisAndTheRateOverDisturbedRuns) {
  Random random(402);
  double worst_s = 0.0, worst_rate = 0.0, line_s = 0.0;
  for (int run = 0; run < 20; ++run) {
    Device device;
    device.rate_Hz = (run % 2 == 0 ? 5000.0 : 60.0) * (1.0 + 1e-6 * random.uniform(-100, 100));
    device.drift_per_s = 1e-8 * random.uniform(-5, 5);
    DriftingClock clock;
    EnvelopeClock straight;
    for (const auto& [n, t] : arrivals_of(device, random)) clock.add(n, t), straight.add(n, t);
    const auto axis = clock.axis();
    const auto line = straight.line();
    for (std::uint64_t n = axis.first; n <= axis.last;
         n += std::max<std::uint64_t>(1, (axis.last - axis.first) / 500)) {
      worst_s = std::max(worst_s, std::abs(axis.at(n) - device.at(n)));
      line_s = std::max(line_s, std::abs(line.at(n) - device.at(n)));
    }
    const double rate = static_cast<double>(axis.last - axis.first) / (device.at(axis.last) - device.at(axis.first));
    worst_rate = std::max(worst_rate, std::abs(axis.rate_Hz() / rate - 1.0));
  }
  fmt::print("20 disturbed runs: axis within {:.3f} ms (a straight line: {:.3f} ms), rate within {:.2f} ppm\n",
             1e3 * worst_s, 1e3 * line_s, 1e6 * worst_rate);
  EXPECT_LT(worst_s, 1e-3);
  EXPECT_LT(worst_rate, 5e-6);
}

TEST(DriftingClock, FindsTheDrift) {
  Random random(403);
  const Device device{.rate_Hz = 5000.0, .drift_per_s = 4e-8, .seconds = 300.0};
  DriftingClock clock;
  for (const auto& [n, t] : arrivals_of(device, random)) clock.add(n, t);
  const auto axis = clock.axis();
  EXPECT_NEAR(axis.rate_change(), 4e-8 * 300.0, 0.05 * 4e-8 * 300.0);
  EXPECT_LT(axis.floor_s, 0.2e-3);
}

// The slow twin: a grid over the drift, for each the best line below all points over all pairs.
TEST(DriftingClock, HasTheLeastSumOfDistances) {
  Random random(404);
  std::vector<std::pair<std::uint64_t, double>> points;
  for (std::uint64_t n = 0; n < 60; ++n) {
    const double t = static_cast<double>(n), u = (t - 29.5) / 29.5;
    points.emplace_back(n, t + 0.3 * u * u + 0.05 * random.uniform(0, 1));
  }
  DriftingClock clock;
  for (const auto& [n, t] : points) clock.add(n, t);
  const auto axis = clock.axis();
  ASSERT_NE(axis.drift_s, 0.0);
  double mine = 0.0;
  for (const auto& [n, t] : points) {
    EXPECT_GE(t - axis.at(n), -1e-9);
    mine += t - axis.at(n);
  }
  double best = 1e9;
  for (double drift = 0.2; drift < 0.4; drift += 0.002) {
    std::vector<std::pair<double, double>> left;
    for (const auto& [n, t] : points) {
      const double u = (static_cast<double>(n) - 29.5) / 29.5;
      left.emplace_back(static_cast<double>(n), t - drift * u * u);
    }
    for (const auto& [xa, ya] : left) {
      for (const auto& [xb, yb] : left) {
        if (!(xb > xa)) continue;
        const double slope = (yb - ya) / (xb - xa);
        double sum = 0.0;
        for (const auto& [x, y] : left) {
          const double distance = y - ya - slope * (x - xa);
          sum = distance < -1e-12 ? 1e9 : sum + distance;
          if (sum > 1e8) break;
        }
        best = std::min(best, sum);
      }
    }
  }
  EXPECT_LT(mine, best + 1e-3);
}

}  // namespace
}  // namespace touchstone::hil
