// The rate of `noticed` among pairs of one process.
#pragma once

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <utility>
#include <vector>

#include "harness/perception/judge/identical_pairs_for_test.h"
#include "harness/perception/judge/judged_conditions.h"

namespace touchstone::perception {

struct FalseAlarms {
  int pairs = 0;
  int noticed = 0;
};

// `hands`: load and pace of the second recording; the first and its repeat have 1 and 1.
inline FalseAlarms false_alarms(const std::vector<double>& noises_N, const std::vector<double>& rates_Hz,
                                const std::vector<std::pair<double, double>>& hands, std::uint64_t seeds, int presses) {
  FalseAlarms all;
  const auto surfaces = kinds_of_surface();
  for (std::size_t kind = 0; kind < surfaces.size(); ++kind) {
    FalseAlarms own;
    std::string which;
    for (const double noise_N : noises_N) {
      for (const double rate_Hz : rates_Hz) {
        PlantedProcess process = surfaces[kind];
        process.noise_N = noise_N;
        process.rate_Hz = rate_Hz;
        process.presses = presses;
        for (std::uint64_t seed = 0; seed < seeds; ++seed) {
          const std::uint64_t first = first_seed() + 100000 * (kind + 1) + 100 * seed;
          const recording::Recording real = planted(process, first);
          std::vector<RecordingSource> conditions;
          for (std::size_t h = 0; h < hands.size(); ++h) {
            PlantedProcess other = process;
            other.load = hands[h].first;
            other.pace = hands[h].second;
            conditions.push_back(
                {fmt::format("hand {}", h), [other, first, h] { return planted(other, first + 2 + h); }});
          }
          const RecordingSource again{"again", [&] { return planted(process, first + 1); }};
          const auto judged = judge_conditions(real, {again}, conditions, Vec3::UnitZ(), {});
          for (const auto& condition : judged.conditions) {
            ++own.pairs;
            if (condition.judgement.verdict != Verdict::noticed) continue;
            ++own.noticed;
            const auto& by =
                condition.judgement
                    .channels[static_cast<std::size_t>(condition.judgement.gives_away.value_or(Channel::force))];
            which += fmt::format("  {} mN, {} Hz, seed {}, {}: d' {:.2f}, {}: {}\n", 1e3 * noise_N, rate_Hz, seed,
                                 condition.name, condition.judgement.d_prime, name_of(by.channel), by.what);
          }
        }
      }
    }
    fmt::print("surface {}: {} of {} noticed\n{}", kind, own.noticed, own.pairs, which);
    all.pairs += own.pairs;
    all.noticed += own.noticed;
  }
  return all;
}

}  // namespace touchstone::perception
