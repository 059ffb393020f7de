#include "harness/perception/judge/replay_path.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "harness/base/random.h"
#include "harness/perception/judge/judged_conditions.h"

namespace touchstone::perception {
using recording::Recording;

namespace {

constexpr double replay_turn = 2.0 * std::numbers::pi;

struct Session {
  double k_N_per_m = 400.0;
  double tracker_m = 0.0;
  bool slides = false;
  double rate_Hz = 1000.0;
};

Vec3 place_at(const Session& session, double t) {
  const double deepest_m = 3.0 / session.k_N_per_m;
  const double depth_m = (deepest_m + 0.001) * 0.5 * (1.0 - std::cos(replay_turn * 0.9 * t)) - 0.001;
  if (!session.slides) return {0.0, 0.0, -depth_m};
  // To and fro at a depth that changes slowly, from the air and back.
  const double slow_m = (deepest_m + 0.001) * 0.5 * (1.0 - std::cos(replay_turn * 0.3 * t)) - 0.001;
  return {0.02 * std::sin(replay_turn * 0.7 * t), 0.0, -slow_m};
}

Vec3 force_of(const Session& session, const Vec3& p) { return {0.0, 0.0, std::max(0.0, -session.k_N_per_m * p.z())}; }

Recording recorded(const Session& session, std::uint64_t seed) {
  Random random(seed);
  Recording recording;
  recording.source = "session";
  const auto noise = [&random](double sigma) {
    const double x = random.normal();
    const double y = random.normal();
    return Vec3(sigma * Vec3(x, y, random.normal()));
  };
  for (int i = 0; i < static_cast<int>(10.0 * session.rate_Hz); ++i) {
    const double t = i / session.rate_Hz;
    const Vec3 p = place_at(session, t);
    recording.motion.t_s.push_back(t);
    recording.motion.p_W_m.push_back(p + noise(session.tracker_m));
    recording.f_W_N.push_back(force_of(session, p) + noise(0.005));
  }
  return recording;
}

// The process's own model, and one 30 % too soft, on the real path.
JudgedConditions judged_models(const Session& session, std::uint64_t seed) {
  const Recording real = recorded(session, seed);
  const auto path = replay_path(real.motion);
  const auto model = [&](const std::string& name, double share) {
    return RecordingSource{name,
                           [&session, &real, &path, share] {
                             Recording rendered{real.motion, {}, {}, "model"};
                             for (const Vec3& p : path.motion.p_W_m)
                               rendered.f_W_N.push_back(share * force_of(session, p));
                             return rendered;
                           },
                           path.samples};
  };
  const RecordingSource again{"again", [&] { return recorded(session, seed + 1000); }};
  return judge_conditions(real, {again}, {model("right", 1.0), model("soft", 0.7)}, Vec3::UnitZ(), {});
}

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
