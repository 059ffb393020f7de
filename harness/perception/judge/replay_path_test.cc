#include "harness/perception/judge/replay_path.h"

#include <gtest/gtest.h>

#include <cmath>

#include "harness/base/random.h"
#include "harness/perception/judge/replayed_session_for_test.h"

namespace touchstone::perception {
namespace {

TEST(ReplayPath, TheProcessesOwnModelIsNotNoticedWhateverTheTracker) {
  for (const double k : {400.0, 2000.0}) {
    for (const bool slides : {false, true}) {
      for (const double tracker_m : {0.0, 5e-6, 20e-6, 50e-6}) {
        for (const std::uint64_t seed : {1u, 2u, 3u}) {
          const auto judged = judged_models({.k_N_per_m = k, .tracker_m = tracker_m, .slides = slides}, seed);
          const Judgement& right = judged.conditions[0].judgement;
          EXPECT_NE(right.verdict, Verdict::noticed)
              << k << " N/m, " << 1e6 * tracker_m << " um, " << (slides ? "slides" : "presses") << ", seed " << seed
              << ": d' " << right.d_prime;
          EXPECT_EQ(judged.conditions[0].rank, 1U) << k << " " << tracker_m << " " << slides << " " << seed;
        }
      }
    }
  }
}

TEST(ReplayPath, AtTheRateOfATrackerToo) {
  for (const double rate_Hz : {60.0, 250.0, 5000.0}) {
    const auto judged = judged_models({.k_N_per_m = 2000.0, .tracker_m = 10e-6, .rate_Hz = rate_Hz}, 4);
    EXPECT_NE(judged.conditions[0].judgement.verdict, Verdict::noticed) << rate_Hz;
  }
}

TEST(ReplayPath, LeavesAPathWithoutNoiseAndSmoothsNoMovementAway) {
  const Session session{.k_N_per_m = 2000.0};
  MotionColumns exact;
  for (int i = 0; i < 5000; ++i) {
    exact.t_s.push_back(0.001 * i);
    exact.p_W_m.push_back(place_at(session, 0.001 * i));
  }
  const auto kept = replay_path(exact);
  for (std::size_t i = 0; i < exact.size(); ++i) EXPECT_LT((kept.motion.p_W_m[i] - exact.p_W_m[i]).norm(), 1e-9) << i;
  Random random(7);
  MotionColumns noisy = exact;
  for (Vec3& p : noisy.p_W_m) p.z() += 20e-6 * random.normal();
  const auto smooth = replay_path(noisy);
  EXPECT_GE(smooth.samples, 15U);
  double squares = 0.0;
  for (std::size_t i = 50; i + 50 < exact.size(); ++i)
    squares += std::pow(smooth.motion.p_W_m[i].z() - exact.p_W_m[i].z(), 2);
  // A parabola over n samples leaves 9 / 4 / n of the variance.
  EXPECT_NEAR(std::sqrt(squares / static_cast<double>(exact.size() - 100)),
              20e-6 * std::sqrt(2.25 / static_cast<double>(smooth.samples)), 1e-6);
}

TEST(ReplayPath, WeightsAreAParabolas) {
  for (const std::size_t samples : {1U, 3U, 5U, 21U}) {
    const auto weights = parabola_weights(samples);
    double sum = 0.0;
    double squares = 0.0;
    for (std::size_t j = 0; j < samples; ++j) {
      const double at = static_cast<double>(j) - static_cast<double>(samples / 2);
      sum += weights[j];
      squares += weights[j] * at * at;
    }
    EXPECT_NEAR(sum, 1.0, 1e-12) << samples;
    EXPECT_NEAR(squares, 0.0, 1e-9) << samples;
  }
}

}  // namespace
}  // namespace touchstone::perception
