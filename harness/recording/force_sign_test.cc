#include "harness/recording/force_sign.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "harness/base/random.h"

namespace touchstone::recording {
namespace {

struct Scan {
  std::vector<Vec3> normals;
  std::vector<Vec3> forces;
};

// Taps on a body: half the samples are in contact; friction and noise on every force.
Scan taps(double sign, double size_N, double friction, double noise, std::uint64_t seed) {
  Random random(seed);
  Scan scan;
  for (int i = 0; i < 4000; ++i) {
    const Vec3 n = random.direction();
    const Vec3 tangent = n.unitOrthogonal();
    const double pressed = std::max(0.0, std::sin(i * 0.05));
    const Vec3 f = pressed * (n + friction * tangent) + noise * Vec3(random.normal(), random.normal(), random.normal());
    scan.normals.push_back(n);
    scan.forces.push_back(sign * size_N * f);
  }
  return scan;
}

TEST(ForceSign, FindsTheSignAtEverySizeWithFrictionAndNoise) {
  for (const double size_N : {1e-300, 1e-3, 1.0, 1e3, 1e300}) {
    for (const double friction : {0.0, 0.5, 2.0}) {
      const Scan right = taps(1.0, size_N, friction, 0.05, 1);
      const Scan wrong = taps(-1.0, size_N, friction, 0.05, 1);
      const ForceSign a = check_force_sign(right.normals, right.forces);
      const ForceSign b = check_force_sign(wrong.normals, wrong.forces);
      EXPECT_EQ(a.verdict, SignVerdict::outward) << a.explain();
      EXPECT_EQ(b.verdict, SignVerdict::reversed) << b.explain();
      EXPECT_DOUBLE_EQ(a.statistic, -b.statistic);
      EXPECT_DOUBLE_EQ(a.p_value, std::pow(0.5, 19)) << "20 of 20 blocks, two-sided";
    }
  }
}

TEST(ForceSign, DoesNotDecideWithoutEvidence) {
  Random random(3);
  int decided = 0;
  for (int trial = 0; trial < 200; ++trial) {
    Scan noise;
    for (int i = 0; i < 100; ++i) {
      noise.normals.push_back(random.direction());
      noise.forces.push_back(random.direction());
    }
    if (check_force_sign(noise.normals, noise.forces).verdict != SignVerdict::undecided) ++decided;
  }
  EXPECT_EQ(decided, 0);
  const std::vector<Vec3> n(3, Vec3::UnitZ());
  EXPECT_EQ(check_force_sign(n, n).verdict, SignVerdict::undecided) << "three samples prove nothing";
  EXPECT_DOUBLE_EQ(check_force_sign(n, n).p_value, 0.25);
  EXPECT_EQ(check_force_sign({}, {}).verdict, SignVerdict::undecided);
  const std::vector<Vec3> bad(30, Vec3::Constant(std::numeric_limits<double>::quiet_NaN()));
  EXPECT_EQ(check_force_sign(std::vector<Vec3>(30, Vec3::UnitZ()), bad).samples, 0U);
  EXPECT_THROW(check_force_sign(n, {}), std::invalid_argument);
}

// Presses of a few newtons under a tool of any weight: the load's mean may point inward, its change with the depth does
// not.
TEST(ForceSign, TheChangeOfTheLoadDecidesUnderAnyWeight) {
  for (const double scale : {1e-6, 1.0, 1e6}) {
    for (const double weight_N : {-100.0, -1.0, 0.0, 1.0, 100.0}) {
      for (const double sign : {1.0, -1.0}) {
        Random random(5);
        std::vector<double> depths_m, loads_N;
        for (int i = 0; i < 4000; ++i) {
          const double depth_m = scale * 1e-3 * std::max(0.0, std::sin(i * 0.05));
          depths_m.push_back(depth_m);
          loads_N.push_back(sign * (1000.0 * depth_m / scale + weight_N + 0.05 * random.normal()));
        }
        const ForceSign change = check_load_change(depths_m, loads_N);
        EXPECT_EQ(change.verdict, sign > 0.0 ? SignVerdict::outward : SignVerdict::reversed)
            << scale << " " << weight_N << " " << change.explain();
      }
    }
  }
}

TEST(ForceSign, AConstantLoadHasNoChangeThatDecides) {
  Random random(6);
  int decided = 0;
  for (int trial = 0; trial < 200; ++trial) {
    std::vector<double> depths_m, loads_N;
    for (int i = 0; i < 400; ++i) {
      depths_m.push_back(1e-3 * std::max(0.0, std::sin(i * 0.05)));
      loads_N.push_back(1.0 + 0.02 * random.normal());
    }
    if (check_load_change(depths_m, loads_N).verdict != SignVerdict::undecided) ++decided;
  }
  EXPECT_EQ(decided, 0);
  const std::vector<double> flat(100, 1e-3), bad(100, std::numeric_limits<double>::quiet_NaN());
  EXPECT_EQ(check_load_change(flat, flat).verdict, SignVerdict::undecided);
  EXPECT_EQ(check_load_change(flat, bad).samples, 0U);
  EXPECT_EQ(check_load_change({}, {}).verdict, SignVerdict::undecided);
  EXPECT_THROW(check_load_change(flat, {}), std::invalid_argument);
}

TEST(ForceSign, OneHugeOutlierDoesNotDecide) {
  Scan scan = taps(1.0, 1.0, 0.2, 0.05, 4);
  scan.forces[10] = -1e9 * scan.normals[10];
  EXPECT_EQ(check_force_sign(scan.normals, scan.forces).verdict, SignVerdict::undecided);
}

}  // namespace
}  // namespace touchstone::recording
