#include "harness/metrics/close_up.h"

namespace touchstone::metrics {
namespace {

MetricSample forces(int i, double rendered_N) {
  MetricSample sample;
  sample.t_s = i;
  sample.f_measured_W_N = Vec3(1, 0, 0);
  sample.f_rendered_W_N = Vec3(rendered_N, 0, 0);
  return sample;
}

TEST(CloseUp, EverySampleAroundTheWorstEpisodesWorstFirst) {
  CloseUpRecorder recorder(0.5);
  // Ten episodes of one sample each, 200 samples apart, error i + 1 for the i-th.
  for (int i = 0; i < 2000; ++i) {
    const int episode = i / 200;
    recorder.add(forces(i, i % 200 == 100 ? 2.0 + episode : 1.0));
  }
  const auto worst = recorder.worst();
  ASSERT_EQ(worst.size(), CloseUpRecorder::kept);
  for (std::size_t k = 0; k < worst.size(); ++k) {
    EXPECT_EQ(worst[k].worst, 10.0 - static_cast<double>(k));
    EXPECT_EQ(worst[k].worst_t_s, 100.0 + 200.0 * (9.0 - static_cast<double>(k)));
    ASSERT_EQ(worst[k].signals.size(), 3u);
    for (const Series& signal : worst[k].signals) {
      EXPECT_EQ(signal.samples_per_pair, 1u);
      EXPECT_EQ(signal.t_s.size(), 2 * CloseUpRecorder::margin + 1);
      EXPECT_EQ(signal.t_s.front(), worst[k].worst_t_s - static_cast<double>(CloseUpRecorder::margin));
    }
  }
}

// A lower peak later in an episode does not begin it anew.
TEST(CloseUp, AnEpisodeKeepsAWorstThatCameFirst) {
  CloseUpRecorder recorder(0.5);
  for (int i = 0; i < 400; ++i) recorder.add(forces(i, i == 100 ? 4.0 : i == 150 || i == 200 ? 2.0 : 1.0));
  const auto worst = recorder.worst();
  ASSERT_EQ(worst.size(), 1u);
  EXPECT_EQ(worst[0].worst, 3.0);
  EXPECT_EQ(worst[0].worst_t_s, 100.0);
  EXPECT_EQ(worst[0].signals[2].t_s.size(), 2 * CloseUpRecorder::margin + 101);
}

TEST(CloseUp, AnEpisodeAtTheEndIsClosedThere) {
  CloseUpRecorder recorder(0.5);
  for (int i = 0; i < 10; ++i) recorder.add(forces(i, i >= 8 ? 3.0 : 1.0));
  const auto worst = recorder.worst();
  ASSERT_EQ(worst.size(), 1u);
  EXPECT_EQ(worst[0].signals[2].t_s.back(), 9.0);
  EXPECT_EQ(worst[0].worst, 2.0);
}

}  // namespace
}  // namespace touchstone::metrics
