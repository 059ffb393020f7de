// The stated false-alarm rate and the delay of detection, over simulated years of daily builds.
// TOUCHSTONE_HISTORY_SEED sets the first seed, TOUCHSTONE_HISTORY_YEARS the years of each noise.
#include <gtest/gtest.h>

#include <boost/math/distributions/binomial.hpp>
#include <cstdio>
#include <cstdlib>

#include "change_points/change_points.h"
#include "change_points/simulated_noise.h"

namespace touchstone::change_points {
namespace {

std::uint64_t from_environment(const char* name, std::uint64_t otherwise) {
  const char* const text = std::getenv(name);
  return text == nullptr ? otherwise : std::strtoull(text, nullptr, 10);
}

class FalseAlarms : public testing::TestWithParam<std::string_view> {};

// The years of each noise, looked at every fourth day. The most alarms that pass are those that 1 % a year would exceed
// with a probability of at most 2e-3 (300 years: 9).
TEST_P(FalseAlarms, AtMostOnePercentAYear) {
  const auto years = static_cast<int>(from_environment("TOUCHSTONE_HISTORY_YEARS", 300));
  const std::uint64_t first_seed = from_environment("TOUCHSTONE_HISTORY_SEED", 1000);
  int alarms = 0;
  for (int year = 0; year < years; ++year) {
    Random random(first_seed + static_cast<std::uint64_t>(year));
    const auto values = series_of(GetParam(), 365, random);
    bool alarm = false;
    for (std::size_t day = 8; day <= values.size() && !alarm; day += 4) {
      ChangeOptions options;
      options.smallest_relative = 0.0;
      alarm = !find_changes(std::span(values).first(day), options).changes.empty();
    }
    alarms += alarm ? 1 : 0;
  }
  std::printf("| %s | %d of %d |\n", std::string(GetParam()).c_str(), alarms, years);
  std::fflush(stdout);
  const boost::math::binomial at_the_stated_rate(years, 0.01);
  EXPECT_LE(alarms, boost::math::quantile(boost::math::complement(at_the_stated_rate, 2e-3)));
}
INSTANTIATE_TEST_SUITE_P(Noise, FalseAlarms, testing::ValuesIn(noises));

// Builds from a step after 60 quiet builds to its detection: each size over 200 series.
TEST(Detection, DelayBySize) {
  for (const std::string_view noise : noises) {
    for (const double size : {2.0, 3.0, 5.0, 10.0}) {
      std::vector<std::size_t> delays;
      for (std::uint64_t seed = 0; seed < 200; ++seed) {
        Random random(from_environment("TOUCHSTONE_HISTORY_SEED", 0) + seed);
        auto values = series_of(noise, 120, random);
        for (std::size_t i = 60; i < values.size(); ++i) values[i] += size;
        std::size_t day = 61;
        const auto found = [&] {
          const auto report = find_changes(std::span(values).first(day), {.smallest_relative = 0.0});
          for (const Change& change : report.changes) {
            if (change.first <= 63 && change.last >= 57) return true;
          }
          return false;
        };
        while (day < values.size() && !found()) ++day;
        delays.push_back(day - 60);
      }
      std::ranges::sort(delays);
      std::printf("| %s | %g | %zu | %zu |\n", std::string(noise).c_str(), size, delays[100], delays[190]);
      if (size >= 5.0) {
        EXPECT_LE(delays[100], 10U) << noise << ' ' << size;
      }
    }
  }
}

}  // namespace
}  // namespace touchstone::change_points
