// When one process recorded twice is called not noticed: by the force sensor's noise and by how long was recorded.
// Prints the table of docs/explanation/perception.md.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "harness/perception/judge/identical_pairs_for_test.h"
#include "harness/perception/judge/judge.h"

namespace touchstone::perception {
namespace {

struct Power {
  int not_noticed = 0;
  double may_differ = 0.0;  // upper end of the interval of d', mean
};

constexpr int seeds = 3;
constexpr double presses_s = 0.9;

Power power(double noise_N, double seconds, const std::vector<Channel>& without) {
  Power result;
  JudgeOptions options;
  options.without = without;
  options.keep_moments = false;
  for (std::uint64_t seed = 0; seed < seeds; ++seed) {
    PlantedProcess process{.noise_N = noise_N};
    process.presses = static_cast<int>(seconds / presses_s);
    const auto prepared = [&](std::uint64_t which, const JudgedProcess* reference) {
      return judged_process(felt_series(planted(process, first_seed() + 880000 + 10 * seed + which), Vec3::UnitZ()),
                            options.thresholds, reference);
    };
    const JudgedProcess real = prepared(0, nullptr);
    const Judgement judgement = judge(real, prepared(1, &real), {}, options);
    EXPECT_NE(judgement.verdict, Verdict::noticed) << noise_N << " N, " << seconds << " s";
    result.not_noticed += judgement.verdict == Verdict::not_noticed ? 1 : 0;
    result.may_differ += judgement.d_prime_high95 / seeds;
  }
  return result;
}

TEST(Power, OneProcessIsCalledOneWhereTheDataAllowIt) {
  const std::vector<Channel> fast{Channel::vibration, Channel::transient};
  const std::vector<std::pair<double, const char*>> durations{
      {10.0, "10 s"}, {60.0, "1 min"}, {600.0, "10 min"}, {3600.0, "1 h"}};
  std::string table = "### Not noticed, of three pairs of one process\n\n| noise of the force, per axis |";
  for (const auto& [seconds, words] : durations) table += fmt::format(" {} |", words);
  table += " 10 s, without vibration and transient |\n|---|---:|---:|---:|---:|---:|\n";
  for (const double noise_N : {0.001, 0.005, 0.02}) {
    table += fmt::format("| {:.0f} mN |", 1e3 * noise_N);
    Power before{0, 1e9};
    for (const auto& [seconds, words] : durations) {
      const Power found = power(noise_N, seconds, {});
      table += fmt::format(" {} (d' up to {:.2f}) |", found.not_noticed, found.may_differ);
      EXPECT_LE(found.may_differ, before.may_differ + 0.05) << "more data say more";
      // 20 mN are a hundred thresholds of vibration: an hour averages them away on some seeds and not on others.
      if (noise_N < 0.002 || (noise_N < 0.01 && seconds > 50.0)) {
        EXPECT_EQ(found.not_noticed, seeds) << words;
      }
      before = found;
    }
    EXPECT_LT(before.may_differ, 1.5) << "an hour at " << noise_N << " N";
    const Power slow = power(noise_N, durations.front().first, fast);
    EXPECT_EQ(slow.not_noticed, seeds);
    table += fmt::format(" {} (d' up to {:.2f}) |\n", slow.not_noticed, slow.may_differ);
  }
  fmt::print("{}", table);
}

}  // namespace
}  // namespace touchstone::perception
