// Every trajectory of the catalogue: a function of time, finite, continuous where it should be; and what each is for.
#include "synthetic/trajectory_catalogue.h"

#include <gmock/gmock.h>

#include <cmath>
#include <numbers>

#include "harness/base/error.h"
#include "harness/testing/steps.h"
#include "synthetic/trajectories/tremor.h"

namespace touchstone::synthetic {
using recording::InTrajectory;

namespace {

class EveryTrajectory : public ::testing::TestWithParam<std::size_t> {
 protected:
  [[nodiscard]] const TrajectoryEntry& entry() const { return trajectory_catalogue()[GetParam()]; }
};

INSTANTIATE_TEST_SUITE_P(Catalogue, EveryTrajectory, ::testing::Range<std::size_t>(0, trajectory_catalogue().size()),
                         [](const auto& instance) {
                           std::string name = trajectory_catalogue()[instance.param].name;
                           std::replace(name.begin(), name.end(), '-', '_');
                           return name;
                         });

TEST_P(EveryTrajectory, IsTheSameFunctionOfTimeEachTime) {
  const auto path = make_path(entry().name, {}, 7);
  const auto again = make_path(entry().name, {}, 7);
  const InTrajectory slow = sample(*path, 500.0);
  const InTrajectory fast = sample(*again, 1000.0);
  ASSERT_GE(fast.size() + 1, 2 * slow.size());
  for (std::size_t i = 0; i < slow.size(); ++i) {
    EXPECT_TRUE(slow.motion.p_W_m[i].allFinite());
    // 2 i / 1000 and i / 500 are the same double.
    EXPECT_EQ(slow.motion.p_W_m[i], fast.motion.p_W_m[2 * i]);
  }
  EXPECT_EQ(path->position_W_m(-1.0), path->position_W_m(0.0));
  EXPECT_EQ(path->position_W_m(path->duration_s() + 1.0), path->position_W_m(path->duration_s()));
}

TEST_P(EveryTrajectory, IsContinuousUnlessItJumps) {
  const auto path = make_path(entry().name);
  double fastest = 0.0;
  double fastest_finer = 0.0;
  for (const double rate : {1000.0, 10000.0}) {
    const InTrajectory trajectory = sample(*path, rate);
    double& most = rate < 5000.0 ? fastest : fastest_finer;
    for (std::size_t i = 1; i < trajectory.size(); ++i) {
      most = std::max(most, (trajectory.motion.p_W_m[i] - trajectory.motion.p_W_m[i - 1]).norm() * rate);
    }
  }
  if (entry().name == "jumps") {
    EXPECT_GT(fastest_finer, 5.0 * fastest);
  } else {
    EXPECT_LT(fastest_finer, 1.2 * fastest);
    EXPECT_LT(fastest, 1.0) << "m/s, at the defaults";
  }
}

TEST_P(EveryTrajectory, TakesAnyUnitScale) {
  const auto unscaled = make_path(entry().name, {}, 3);
  for (const double scale : {1e-3, 1e3}) {
    ParameterOverrides overrides;
    for (const Parameter& p : entry().parameters) {
      if (p.unit == "m" || p.unit == "m/s") overrides[p.name] = p.initial * scale;
    }
    const auto scaled = make_path(entry().name, overrides, 3);
    ASSERT_NEAR(scaled->duration_s(), unscaled->duration_s(), 1e-12 * unscaled->duration_s());
    for (int i = 0; i <= 200; ++i) {
      // Off the instants at which a path turns or jumps, where rounding of the duration decides.
      const double t = unscaled->duration_s() * (i + 0.37) / 201.0;
      EXPECT_LT((scaled->position_W_m(t) / scale - unscaled->position_W_m(t)).norm(), 1e-13);
    }
  }
}

TEST(Trajectories, AnApproachComesStraightDownAndLeavesTheRestAsItIs) {
  for (const char* const name : {"stroke", "raster", "edge-crossing", "spiral"}) {
    const auto plain = make_path(name);
    const auto approached = make_path(name, {{"approach_m", 0.002}});
    const Vec3 first = plain->position_W_m(0.0);
    const double lead_s = (0.002 - first.z()) / 0.05;
    EXPECT_NEAR(approached->duration_s(), plain->duration_s() + lead_s, 1e-12);
    EXPECT_EQ(approached->position_W_m(0.0).z(), 0.002) << name;
    for (int i = 0; i < 100; ++i) {
      const Vec3 p = approached->position_W_m(lead_s * i / 100.0);
      EXPECT_EQ(p.head<2>(), first.head<2>());
      EXPECT_NEAR(p.z(), 0.002 - 0.05 * lead_s * i / 100.0, 1e-15);
    }
    for (int i = 0; i <= 100; ++i) {
      const double t = plain->duration_s() * i / 100.0;
      EXPECT_LT((approached->position_W_m(lead_s + t) - plain->position_W_m(t)).norm(), 1e-15) << name;
    }
    // From below the first position there is nothing to come down from.
    EXPECT_EQ(make_path(name, {{"depth_m", -0.01}, {"approach_m", 0.002}})->duration_s(), plain->duration_s());
  }
}

double speed_at(const Path& path, double t) {
  return (path.position_W_m(t + 1e-6) - path.position_W_m(t - 1e-6)).norm() / 2e-6;
}

TEST(Trajectories, StrokesKeepSpeedAndAngle) {
  for (const double speed : {0.001, 0.05, 0.8}) {
    for (const double azimuth : {0.0, 0.7, 2.5}) {
      const auto path = make_path(
          "stroke", {{"speed_m_per_s", speed}, {"azimuth_rad", azimuth}, {"descent_rad", 0.2}, {"depth_m", 0.004}});
      const double early = 0.2 * path->duration_s();
      EXPECT_NEAR(speed_at(*path, early), speed, 1e-7 * std::max(1.0, speed / 0.01));
      const Vec3 way = path->position_W_m(1.1 * early) - path->position_W_m(early);
      EXPECT_NEAR(std::atan2(way.y(), way.x()), azimuth, 1e-12);
      EXPECT_NEAR(std::asin(-way.z() / way.norm()), 0.2, 1e-12);
      EXPECT_NEAR(path->position_W_m(0.25 * path->duration_s()).z(), -0.004, 1e-15);
    }
  }
}

TEST(Trajectories, EdgeCrossingsPassTheOriginUnderEveryAngle) {
  const auto path = make_path("edge-crossing", {{"strokes", 6}, {"depth_m", 0.0}});
  int passes = 0;
  for (const auto trajectory = sample(*path, 10000.0); const Vec3& p : trajectory.motion.p_W_m) {
    passes += p.norm() < 2.6e-6 ? 1 : 0;
    EXPECT_LE(p.norm(), 0.01 + 1e-12);
  }
  EXPECT_GE(passes, 6);
  for (const double t : testing::steps(1e-3, path->duration_s(), 1.234e-2)) EXPECT_NEAR(speed_at(*path, t), 0.05, 2e-3);
}

TEST(Trajectories, PushesReachBeyondAShellAndComeBackAside) {
  const auto path = make_path("push", {{"depth_m", 0.004}, {"shift_m", 0.003}});
  double lowest = 0.0;
  for (const auto trajectory = sample(*path, 1000.0); const Vec3& p : trajectory.motion.p_W_m)
    lowest = std::min(lowest, p.z());
  EXPECT_NEAR(lowest, -0.004, 5e-5);
  EXPECT_LT((path->position_W_m(path->duration_s()) - Vec3(0.003, 0.0, 0.002)).norm(), 1e-15);
}

TEST(Trajectories, RastersCoverTheirSquareAtConstantSpeed) {
  const auto path = make_path("raster");
  Box3 box;
  for (const auto trajectory = sample(*path, 1000.0); const Vec3& p : trajectory.motion.p_W_m) box.extend(p);
  EXPECT_LT((box.sizes() - Vec3(0.04, 0.04, 0.0)).norm(), 1e-4);
  for (const double t : testing::steps(1e-3, path->duration_s(), 3.21e-2)) EXPECT_NEAR(speed_at(*path, t), 0.05, 1e-7);
}

TEST(Trajectories, TremorStaysInItsBandAndHasItsSize) {
  const Tremor tremor(11, 5e-5);
  // Correlation with a sinusoid over a long time picks out one frequency: Goertzel's sum, one bin of 0.05 Hz.
  const double duration = 20.0;
  const int count = 4000;
  std::vector<Vec3> samples;
  for (int i = 0; i < count; ++i) samples.push_back(tremor.at(duration * i / count));
  const auto power = [&](double frequency) {
    Vec3 in = Vec3::Zero();
    Vec3 quadrature = Vec3::Zero();
    for (int i = 0; i < count; ++i) {
      const double window = 1.0 - std::cos(2.0 * std::numbers::pi * i / count);
      const double turned = 2.0 * std::numbers::pi * frequency * duration * i / count;
      in += window * std::cos(turned) / count * samples[static_cast<std::size_t>(i)];
      quadrature += window * std::sin(turned) / count * samples[static_cast<std::size_t>(i)];
    }
    return in.squaredNorm() + quadrature.squaredNorm();
  };
  double inside = 0.0;
  double outside = 0.0;
  for (const double f : testing::steps(1.0, 30.0, 0.1)) (f > 7.7 && f < 12.3 ? inside : outside) += power(f);
  EXPECT_LT(outside, 1e-6 * inside);
  double square = 0.0;
  for (const Vec3& at : samples) square += at.squaredNorm() / (3.0 * count);
  EXPECT_NEAR(std::sqrt(square), 5e-5, 2e-6);
}

TEST(Trajectories, RefuseWhatTheyDoNotKnow) {
  EXPECT_THROW(make_path("strok"), UsageError);
  EXPECT_THROW(make_path("stroke", {{"speed_m_per_s", 0.0}}), UsageError);
  EXPECT_THROW(make_path("spiral", {{"length_m", 1.0}}), UsageError);
  EXPECT_THROW(sample(*make_path("stroke"), 0.0), UsageError);
  EXPECT_THROW(sample(*make_path("stroke"), 1e12), UsageError);
}

}  // namespace
}  // namespace touchstone::synthetic
