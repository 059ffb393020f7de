// A bump on a plane is found where it is, at every unit, whatever else is wrong with the model along the normal.
#include "harness/discrepancy/bump_peaks.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "harness/discrepancy/plane_for_test.h"

namespace touchstone::discrepancy {
namespace {

struct Hidden {
  double amplitude;
  double x_m;
  double y_m;
  double width_m;
};

// At a unit of length.
class BumpPeaksAt : public ::testing::TestWithParam<double> {
 protected:
  const double unit_ = GetParam();
  const Vec3 low_W_m_{-0.02 * unit_, -0.015 * unit_, -0.001 * unit_};
  const Vec3 high_W_m_{0.02 * unit_, 0.015 * unit_, 0.0};

  recording::Recording recording_;
  rendering::Prediction current_;

  // What a sensor shows of a plane with the bump, stiffer than the model by a tenth and with a bias.
  void record(BumpOf of, const Hidden& hidden) {
    recording_.motion = hand(0.3, unit_);
    rendering::Model model;
    model.parameters["stiffness_N_per_m"] = 800.0;
    current_ = PlanePredictor(recording_.motion).predict(model);
    std::mt19937_64 random(11);
    std::normal_distribution<double> noise_N(0.0, 0.01 * unit_);
    for (std::size_t i = 0; i < recording_.motion.size(); ++i) {
      const Vec3& p = recording_.motion.p_W_m[i];
      const double at = std::exp(-0.5 * (std::pow(p.x() - hidden.x_m, 2) + std::pow(p.y() - hidden.y_m, 2)) /
                                 (hidden.width_m * hidden.width_m));
      const double bump = of == BumpOf::stiffness ? current_.depth_m[i] * hidden.amplitude * at : hidden.amplitude * at;
      const double force_N = 880.0 * (current_.depth_m[i] + (current_.depth_m[i] > 0.0 ? bump : 0.0));
      recording_.f_W_N.emplace_back(noise_N(random), noise_N(random), force_N + 0.05 * unit_ + noise_N(random));
    }
  }

  void expect_found(BumpOf of, const Hidden& hidden) {
    record(of, hidden);
    const auto peaks = bump_peaks(recording_, current_, of, low_W_m_, high_W_m_, 4);
    ASSERT_FALSE(peaks.empty());
    // The grid's cells are 3.3 and 2.5 mm at unit 1.
    EXPECT_NEAR(peaks[0].x_m, hidden.x_m, 0.0035 * unit_);
    EXPECT_NEAR(peaks[0].y_m, hidden.y_m, 0.0035 * unit_);
    // A narrower bump of the grid is higher: a start, with its sign.
    EXPECT_GT(peaks[0].amplitude / hidden.amplitude, 0.5);
    EXPECT_LT(peaks[0].amplitude / hidden.amplitude, 2.0);
    EXPECT_GT(peaks[0].power, 0.7);
    for (std::size_t i = 1; i < peaks.size(); ++i) EXPECT_LE(peaks[i].power, peaks[i - 1].power);
  }
};

TEST_P(BumpPeaksAt, FindsASofterPlaceWithItsSign) {
  expect_found(BumpOf::stiffness, {-0.5, 0.006 * unit_, -0.004 * unit_, 0.004 * unit_});
}

TEST_P(BumpPeaksAt, FindsAStifferPlace) {
  expect_found(BumpOf::stiffness, {0.8, -0.009 * unit_, 0.005 * unit_, 0.005 * unit_});
}

TEST_P(BumpPeaksAt, FindsAHillInTheSurface) {
  expect_found(BumpOf::surface, {0.0003 * unit_, 0.008 * unit_, 0.004 * unit_, 0.004 * unit_});
}

TEST_P(BumpPeaksAt, FindsNoneWithoutContactOrExtent) {
  record(BumpOf::stiffness, {0.5, 0.0, 0.0, 0.005 * unit_});
  EXPECT_TRUE(bump_peaks(recording_, current_, BumpOf::stiffness, low_W_m_, low_W_m_, 4).empty());
  for (Vec3& n : current_.n_W) n.setZero();
  EXPECT_TRUE(bump_peaks(recording_, current_, BumpOf::stiffness, low_W_m_, high_W_m_, 4).empty());
}

INSTANTIATE_TEST_SUITE_P(Units, BumpPeaksAt, ::testing::Values(1e-3, 1.0, 1e3));

}  // namespace
}  // namespace touchstone::discrepancy
