#include "record/envelope_clock.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "harness/base/random.h"

namespace touchstone::hil {
namespace {

struct Arrival {
  std::uint64_t number;
  double t_s;
};

EnvelopeClock::Line line_of(const std::vector<Arrival>& arrivals) {
  EnvelopeClock clock;
  for (const auto& a : arrivals) clock.add(a.number, a.t_s);
  return clock.line();
}

TEST(EnvelopeClock, IsExactWithoutDelays) {
  for (const double rate_Hz : {60.0, 5000.0, 7912.0}) {
    std::vector<Arrival> arrivals;
    for (std::uint64_t i = 0; i < 20000; ++i) arrivals.push_back({i + 7, 3.0 + static_cast<double>(i) / rate_Hz});
    const auto line = line_of(arrivals);
    EXPECT_NEAR(line.seconds_per_sample * rate_Hz, 1.0, 1e-12);
    EXPECT_NEAR(line.at(7), 3.0, 1e-12);
  }
}

// The slow twin: every pair of points, of those below all others the one with the least sum of distances.
TEST(EnvelopeClock, IsTheBestLineBelowAllPoints) {
  Random random(5);
  for (int run = 0; run < 50; ++run) {
    std::vector<Arrival> arrivals;
    for (std::uint64_t i = 0; i < 40; ++i)
      arrivals.push_back({3 * i + 11, 0.2 * static_cast<double>(i) + 0.3 * random.uniform(0, 1)});
    const auto cost_of = [&](double slope, double level) {
      double sum = 0.0;
      for (const auto& a : arrivals) {
        const double distance = a.t_s - level - slope * static_cast<double>(a.number);
        if (distance < -1e-12) return std::numeric_limits<double>::infinity();
        sum += distance;
      }
      return sum;
    };
    double best = std::numeric_limits<double>::infinity();
    for (const auto& a : arrivals) {
      for (const auto& b : arrivals) {
        if (b.number <= a.number) continue;
        const double slope = (b.t_s - a.t_s) / static_cast<double>(b.number - a.number);
        best = std::min(best, cost_of(slope, a.t_s - slope * static_cast<double>(a.number)));
      }
    }
    const auto line = line_of(arrivals);
    EXPECT_NEAR(cost_of(line.seconds_per_sample, line.at(0)), best, 1e-10);
  }
}

// Twenty runs as bad machines make them: samples come in packets, now and then nothing is read for up to a second, and
// half the runs have no quiet stretch at the beginning. Held: the axis within 1 ms, the rate within 5 ppm.
TEST(EnvelopeClock, HoldsTheTimeAxisOfDisturbedRuns) {
  for (std::uint64_t run = 0; run < 20; ++run) {
    Random random(100 + run);
    constexpr double rate_Hz = 5000.0, start_s = 1234.5;
    EnvelopeClock clock;
    double least_squares[5] = {};
    double blocked_until = run % 2 == 0 ? 0.0 : start_s + 0.8, next_block = start_s + random.uniform(0, 5);
    for (std::uint64_t i = 0; i < 300000; ++i) {
      const double sent = start_s + static_cast<double>(i) / rate_Hz;
      if (sent > next_block) {
        blocked_until = sent + random.uniform(0.01, 1.0);
        next_block = blocked_until + random.uniform(0, 5);
      }
      // Read every 1 ms or so, and never before it came.
      const double read = std::max(blocked_until, std::ceil(sent * 1000 + random.uniform(0, 0.3)) / 1000 + 2e-5);
      const double arrival = std::max(sent + 5e-5, read);
      if (random.uniform(0, 1) > 0.01) clock.add(i, arrival);
      const double x = static_cast<double>(i), y = arrival - start_s;
      const double terms[5] = {1.0, x, y, x * x, x * y};
      for (int k = 0; k < 5; ++k) least_squares[k] += terms[k];
    }
    const auto line = clock.line();
    EXPECT_NEAR(1.0 / line.seconds_per_sample, rate_Hz, 5e-6 * rate_Hz) << run;
    for (const std::uint64_t i : {0, 150000, 299999})
      EXPECT_NEAR(line.at(i), start_s + static_cast<double>(i) / rate_Hz, 1e-3) << run;
    const auto [n, sx, sy, sxx, sxy] = least_squares;
    const double slope = (n * sxy - sx * sy) / (n * sxx - sx * sx), level = (sy - slope * sx) / n;
    EXPECT_GT(std::abs(level), 1e-3) << "least squares would do, and this test shows nothing";
  }
}

}  // namespace
}  // namespace touchstone::hil
