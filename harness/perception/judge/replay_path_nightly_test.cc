// The rate at which a process's own model is noticed, over 512 recordings: two stiffnesses, presses and slides, four
// trackers, 32 seeds.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "harness/perception/judge/identical_pairs_for_test.h"
#include "harness/perception/judge/replayed_session_for_test.h"

namespace touchstone::perception {
namespace {

TEST(ReplayPath, TheRightModelIsNoticedInFiveOfAHundredAtMost) {
  int recordings = 0;
  int noticed = 0;
  int not_noticed = 0;
  int behind = 0;
  for (const double k : {400.0, 2000.0}) {
    for (const bool slides : {false, true}) {
      for (const double tracker_m : {0.0, 5e-6, 20e-6, 50e-6}) {
        for (std::uint64_t seed = 0; seed < 32; ++seed) {
          const auto judged =
              judged_models({.k_N_per_m = k, .tracker_m = tracker_m, .slides = slides}, first_seed() + 10000 + seed);
          const auto& right = judged.conditions[0];
          ++recordings;
          not_noticed += right.judgement.verdict == Verdict::not_noticed ? 1 : 0;
          behind += right.rank == 1 ? 0 : 1;
          if (right.judgement.verdict != Verdict::noticed) continue;
          ++noticed;
          fmt::print("{} N/m, {} um, {}, seed {}: d' {:.2f}\n", k, 1e6 * tracker_m, slides ? "slides" : "presses", seed,
                     right.judgement.d_prime);
        }
      }
    }
  }
  fmt::print("{} recordings: the right model noticed in {}, not noticed in {}, ranked behind a softer one in {}\n",
             recordings, noticed, not_noticed, behind);
  EXPECT_LE(noticed, recordings / 20);
  EXPECT_LE(behind, recordings / 20);
}

}  // namespace
}  // namespace touchstone::perception
