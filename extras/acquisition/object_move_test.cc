// Contacts on planes: across them a move shows, along all of them none can.
#include "object_move.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "harness/base/random.h"

namespace touchstone::acquisition {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

// The part of space that is behind all these planes through the origin; far from their edges a plane each.
class Wedge : public surface::Surface {
 public:
  explicit Wedge(std::vector<Vec3> normals) : normals_(std::move(normals)) {}
  [[nodiscard]] surface::SurfacePoint closest(const Vec3& p) const override {
    const Vec3 n = *std::max_element(normals_.begin(), normals_.end(),
                                     [&](const Vec3& a, const Vec3& b) { return a.dot(p) < b.dot(p); });
    return {p - n.dot(p) * n, n, std::abs(n.dot(p)), n.dot(p), -1, surface::Feature::analytic};
  }
  [[nodiscard]] std::optional<surface::Crossing> first_crossing(const Vec3&, const Vec3&) const override {
    return std::nullopt;
  }
  [[nodiscard]] Box3 bounds() const override { return {}; }

 private:
  std::vector<Vec3> normals_;
};

constexpr double radius_m = 2e-3;

// On each plane in turn, 10 to 50 mm from the origin where the other planes are behind, seen with 50 um of noise.
ObjectMove after_touching(const std::vector<Vec3>& normals, std::size_t contacts, std::uint64_t seed) {
  const Wedge wedge(normals);
  Random random(seed);
  ContactSamples touched;
  while (touched.t_s.size() < contacts) {
    const Vec3 n = normals[touched.t_s.size() % normals.size()];
    const Vec3 u = random.direction();
    const Vec3 on_plane = random.uniform(10e-3, 50e-3) * (u - n.dot(u) * n).normalized();
    const bool outside = std::all_of(normals.begin(), normals.end(), [&](const Vec3& other) {
      return other.dot(on_plane) < (other == n ? 1e-9 : -5e-3);
    });
    if (!outside) continue;
    touched.t_s.push_back(0.1 * static_cast<double>(touched.t_s.size()));
    touched.center_W_m.emplace_back(on_plane + (radius_m + 5e-5 * random.normal()) * n);
    touched.force_W_N.push_back(n);
    touched.torque_W_Nm.push_back(Vec3::Zero());
    touched.velocity_W_m_per_s.push_back(Vec3::Zero());
    touched.q_WP.push_back(Quat::Identity());
    touched.q_WS.push_back(Quat::Identity());
  }
  return object_move(wedge, touched, radius_m, 5e-5, RigidTransform(), MarkerRegistration());
}

constexpr double shows_m = 2e-3, boundless_m = 0.1;

TEST(ObjectMove, APlaneShowsAMoveAcrossItAlone) {
  Random random(4601);
  for (int i = 0; i < 5; ++i) {
    const Vec3 n = random.direction();
    const ObjectMove move = after_touching({n}, 300, 4610 + static_cast<std::uint64_t>(i));
    EXPECT_FALSE(move.clear());
    ASSERT_TRUE(move.unnoticed_shift_m);
    EXPECT_LT((*move.unnoticed_shift_m)[0], shows_m);
    EXPECT_GT((*move.unnoticed_shift_m)[1], boundless_m);
    EXPECT_NEAR(std::abs(n.dot(move.shift_axes.col(0))), 1.0, 1e-3);
    EXPECT_THAT(move.doubt(), AllOf(HasSubstr("mm along ("), HasSubstr("by any distance along (")));
  }
  const ObjectMove level = after_touching({Vec3::UnitZ()}, 300, 4620);
  EXPECT_THAT(level.doubt(), HasSubstr(" mm along (0.00, 0.00, 1.00), by any distance along "));
}

// Two planes leave the way along their edge.
TEST(ObjectMove, ARoofLeavesItsRidgeOpen) {
  Random random(4602);
  for (int i = 0; i < 5; ++i) {
    const Quat turn = random.rotation();
    const Vec3 a = turn * Vec3(1, 0, 1).normalized(), b = turn * Vec3(-1, 0, 1).normalized();
    const ObjectMove move = after_touching({a, b}, 300, 4630 + static_cast<std::uint64_t>(i));
    ASSERT_TRUE(move.unnoticed_shift_m);
    EXPECT_LT((*move.unnoticed_shift_m)[1], shows_m);
    EXPECT_GT((*move.unnoticed_shift_m)[2], boundless_m);
    EXPECT_NEAR(std::abs((turn * Vec3::UnitY()).dot(move.shift_axes.col(2))), 1.0, 1e-3);
  }
}

// A corner shows every shift, and every turn.
TEST(ObjectMove, ACornerLeavesNothingOpen) {
  const ObjectMove move = after_touching({Vec3::UnitX(), Vec3::UnitY(), Vec3::UnitZ()}, 300, 4603);
  ASSERT_TRUE(move.unnoticed_shift_m);
  EXPECT_LT(move.unnoticed_shift_m->maxCoeff(), shows_m);
  EXPECT_LT(move.unnoticed_m, shows_m);
  EXPECT_EQ(move.doubt(), "");
}

TEST(ObjectMove, FewContactsTellNothing) {
  const ObjectMove move = after_touching({Vec3::UnitZ()}, 25, 4604);
  EXPECT_FALSE(move.unnoticed_shift_m);
  EXPECT_THAT(move.doubt(), HasSubstr("the contacts do not show whether the object moved: measure the markers again"));
}

}  // namespace
}  // namespace touchstone::acquisition
