#include "harness/recording_checks/force_frame.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "harness/base/random.h"

namespace touchstone::recording_checks {
namespace {

struct Pressed {
  std::vector<Vec3> n, f;
  std::vector<Quat> q;
};

// A probe that is turned about as it presses all over a ball, with friction 0.2 and noise.
Pressed pressed(Random& random) {
  Pressed p;
  Quat turned = random.rotation();
  for (int i = 0; i < 2000; ++i) {
    turned = (turned * Quat(Eigen::AngleAxisd(0.1, random.direction()))).normalized();
    const Vec3 n = random.direction();
    const Vec3 slide = n.cross(random.direction());
    const double load = random.uniform(0.0, 3.0);
    p.n.push_back(n);
    p.q.push_back(turned);
    p.f.push_back(load * (n + 0.2 * slide.normalized()) + 0.05 * random.direction());
  }
  return p;
}

TEST(ForceFrame, EachReadingIsNamed) {
  Random random(1);
  for (int world = 0; world < 10; ++world) {
    const Pressed good = pressed(random);
    EXPECT_FALSE(find_force_frame(good.n, good.f, good.q));
    Pressed sensor = good, inverse = good, transposed = good, reversed = good;
    for (std::size_t i = 0; i < good.f.size(); ++i) {
      sensor.f[i] = good.q[i].conjugate() * good.f[i];
      inverse.f[i] = good.q[i] * good.f[i];
      transposed.f[i] = good.q[i].conjugate() * (good.q[i].conjugate() * good.f[i]);
      reversed.f[i] = -sensor.f[i];
    }
    const auto key = [](const Pressed& p) {
      const auto found = find_force_frame(p.n, p.f, p.q);
      return found ? found->map_key : std::string("nothing");
    };
    EXPECT_EQ(key(sensor), R"("force_frame": "sensor")");
    EXPECT_EQ(key(inverse), R"("force_frame": "inverse")");
    EXPECT_EQ(key(transposed), R"("force_frame": "transposed")");
    EXPECT_EQ(key(reversed), R"("force_frame": "sensor", "force_sign": -1)");
  }
}

TEST(ForceFrame, MirroredAndExchangedAxesAreNamedWithOrWithoutAnOrientation) {
  Random random(3);
  const Pressed good = pressed(random);
  Pressed mirrored = good, exchanged = good;
  for (std::size_t i = 0; i < good.f.size(); ++i) {
    mirrored.f[i].z() *= -1.0;
    std::swap(exchanged.f[i].x(), exchanged.f[i].z());
  }
  for (const std::vector<Quat>& q : {good.q, std::vector<Quat>{}}) {
    const auto first = find_force_frame(mirrored.n, mirrored.f, q),
               second = find_force_frame(exchanged.n, exchanged.f, q);
    ASSERT_TRUE(first && second);
    EXPECT_EQ(first->meaning, "fz has the other sign");
    EXPECT_EQ(second->meaning, "fx and fz are exchanged");
    EXPECT_GT(first->repaired, 0.95);
    EXPECT_FALSE(find_force_frame(good.n, good.f, q));
  }
}

TEST(ForceFrame, APoseThatNeverTurnsAndSlipperyOrStickyContactAreNotBlamed) {
  Random random(2);
  Pressed p = pressed(random);
  for (Quat& q : p.q) q = Quat::Identity();
  EXPECT_FALSE(find_force_frame(p.n, p.f, p.q));
  for (Vec3& f : p.f) f = -f;  // reversed, which is not a matter of frames
  EXPECT_FALSE(find_force_frame(p.n, p.f, p.q));
  Pressed sticky = pressed(random);
  for (std::size_t i = 0; i < sticky.f.size(); ++i) sticky.f[i] = sticky.n[i] + sticky.n[i].cross(random.direction());
  EXPECT_FALSE(find_force_frame(sticky.n, sticky.f, sticky.q));
  EXPECT_FALSE(find_force_frame({}, {}, {}));
}

}  // namespace
}  // namespace touchstone::recording_checks
