#include "harness/discrepancy/gap_shares.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "harness/discrepancy/plane_for_test.h"

namespace touchstone::discrepancy {
using rendering::Model;

namespace {

Model plane_of(double stiffness_N_per_m) {
  Model model;
  model.renderer = "plane";
  model.parameters["stiffness_N_per_m"] = stiffness_N_per_m;
  return model;
}

TEST(GapShares, AddUpToWhatGoesAndPutTheLargestFirst) {
  const MotionColumns motion = hand(0.0, 1.0);
  Model truth = plane_of(900.0);
  truth.effects.push_back({"viscous-friction", {{"coefficient_N_s_per_m", 4.0}}, ""});
  truth.instrument.push_back({"force-bias", {{"fx_N", 1.0}, {"fy_N", 0.0}, {"fz_N", 0.0}}, ""});
  PlanePredictor predictor(motion);
  recording::Recording recording;
  recording.motion = motion;
  recording.f_W_N = predictor.predict(truth).f_W_N;
  for (Vec3& f : recording.f_W_N) f.y() += 0.1;  // what no part explains
  const Evidence evidence{&recording, &predictor, nullptr, {}};
  const Model start = plane_of(850.0);
  const auto shares = share_gap(evidence, start, truth);
  ASSERT_EQ(shares.size(), 3U);
  EXPECT_EQ(shares[0].name, "force-bias");
  const double before_N = rms_force_error_N(evidence, predictor.predict(start));
  const double all = std::accumulate(shares.begin(), shares.end(), 0.0,
                                     [](double sum, const GapShare& share) { return sum + share.share; });
  EXPECT_NEAR(all, 1.0 - 0.01 / (before_N * before_N), 1e-12);
  EXPECT_NEAR(shares.back().left_N, 0.1, 1e-9);
}

TEST(GapShares, PartsThatOnlyMeanSomethingTogetherAreOne) {
  const auto one =
      merge_inseparable({{"stiffness-field", 20.4, 9.0}, {"relaxation", -0.2, 9.1}, {"height-field", -19.3, 0.2}});
  ASSERT_EQ(one.size(), 1U);
  EXPECT_EQ(one[0].name, "stiffness-field, relaxation and height-field together");
  EXPECT_NEAR(one[0].share, 0.9, 1e-12);
  EXPECT_EQ(one[0].left_N, 0.2);
  EXPECT_EQ(merge_inseparable({{"friction", 0.6, 0.3}, {"stiffness", -0.1, 0.4}}).size(), 2U);
}

// Errors along different axes do not meet: each share is what the part takes away alone.
TEST(GapShares, AreExactWherePartsDoNotMeet) {
  const MotionColumns motion = hand(0.0, 1.0);
  PlanePredictor predictor(motion);
  Model truth = plane_of(900.0);
  truth.instrument.push_back({"force-bias", {{"fx_N", 0.3}, {"fy_N", 0.4}, {"fz_N", 0.0}}, ""});
  recording::Recording recording;
  recording.motion = motion;
  recording.f_W_N = predictor.predict(truth).f_W_N;
  const Evidence evidence{&recording, &predictor, nullptr, {}};
  const Model start = plane_of(700.0);
  const double before_N = rms_force_error_N(evidence, predictor.predict(start));
  for (const GapShare& share : share_gap(evidence, start, truth)) {
    const double bias = 0.25 / (before_N * before_N);
    EXPECT_NEAR(share.share, share.name == "force-bias" ? bias : 1.0 - bias, 1e-12) << share.name;
  }
}

}  // namespace
}  // namespace touchstone::discrepancy
