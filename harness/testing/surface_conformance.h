// The conformance suite of Surface: any implementation passes all of it by one line in a test file of its own,
//
//   TOUCHSTONE_SURFACE_CONFORMANCE(MySurface, {"torus", make_my_torus, {.closed = true}});
//
// where make_my_torus(scale, rotation, shift) makes the surface of one object, scaled, then turned, then moved. Include
// this header in one .cc per test program, and link touchstone::testing and touchstone::testing_alloc.
//
// Invariants, with s the signed distance, c(q) the closest point and u one unit of rounding of the coordinates at hand:
//  1. c(q) lies on the surface: |s(c(q))| <= bound * u, and projecting again stays there.
//  2. distance = |q - c(q)| = |s(q)|, and the normal has length 1.
//  3. No surface point is closer than c(q).
//  4. s (its magnitude, where the surface is open) is 1-Lipschitz: |s(a) - s(b)| <= |a - b|.
//  5. Off edges, q - c(q) is along the normal: q = c(q) + s n.
//  6. A crossing lies on the segment and on the surface, its fraction is in [0, 1], it is no closer to the start than s
//     says, and nothing is crossed before it.
//  7. On a closed surface a segment from one side to the other crosses, and `entering` alternates along it beginning
//  with
//     the side where it starts: the parity of the crossings says whether the ends lie on the same side.
//  8. Rotation, translation and scaling of the object and the query change answers only so.
//  9. Queries give the same in other threads, and allocate nothing.
// Queries are random, close to the surface, and close to its edges and vertices; objects are 1e-3, 1 and 1e3 m large,
// turned awkwardly, at the origin and away from it.
#pragma once

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <string>
#include <thread>
#include <vector>

#include "harness/base/random.h"
#include "harness/surface/surface.h"
#include "harness/testing/allocation_guard.h"

namespace touchstone::testing {

struct SurfaceTraits {
  bool closed = true;
  bool allocates = false;  // a reference that may be slow
  double roundings = 4.0;  // the bound on errors, in units of rounding of the coordinates; larger for iterative shapes
  int queries = 200;       // per pose
};

struct SurfaceCase {
  std::string name;
  std::function<std::shared_ptr<surface::Surface>(double scale, const Quat& rotation, const Vec3& shift_m)> make;
  SurfaceTraits traits;
};
inline void PrintTo(const SurfaceCase& tested, std::ostream* out) { *out << tested.name; }

class SurfaceConformance : public ::testing::TestWithParam<SurfaceCase> {
 protected:
  static constexpr std::uint64_t seed = 20060325;

  // One object in one pose, and the scale of its rounding.
  struct Pose {
    double scale;
    Quat rotation;
    Vec3 shift_m;
    std::shared_ptr<surface::Surface> surface;
    double size_m;     // diagonal of the box
    double largest_m;  // coordinate

    [[nodiscard]] double rounding(const Vec3& q) const {
      return std::numeric_limits<double>::epsilon() * (largest_m + size_m + q.cwiseAbs().maxCoeff());
    }
    [[nodiscard]] Vec3 world(const Vec3& body) const { return rotation * (scale * body) + shift_m; }
  };

  [[nodiscard]] const SurfaceTraits& traits() const { return GetParam().traits; }
  [[nodiscard]] double bound(const Pose& pose, const Vec3& q) const { return traits().roundings * pose.rounding(q); }

  [[nodiscard]] Pose pose(double scale, const Quat& rotation, const Vec3& shift_m) const {
    Pose out{scale, rotation, shift_m, GetParam().make(scale, rotation, shift_m), 0.0, 0.0};
    const Box3 box = out.surface->bounds();
    out.size_m = box.diagonal().norm();
    out.largest_m = std::max(box.min().cwiseAbs().maxCoeff(), box.max().cwiseAbs().maxCoeff());
    return out;
  }

  template <class Check>
  void for_every_pose(Check check) {
    Random random(seed);
    for (const double scale : {1e-3, 1.0, 1e3}) {
      for (const double offset : {0.0, 100.0}) {
        SCOPED_TRACE(fmt::format("seed {}, scale {}, offset {} sizes", seed, scale, offset));
        const Quat rotation = random.rotation();
        Random stream = random.stream(static_cast<std::uint64_t>(offset) + 1);
        check(pose(scale, rotation, offset * scale * random.direction()), stream);
        if (HasFatalFailure()) return;
      }
    }
  }

  // Anywhere, near the surface, near an edge, near a vertex in turn; near means 1e-12 to 1 of the size.
  static Vec3 query(const Pose& pose, Random& random, int i) {
    const surface::Surface& surface = *pose.surface;
    Vec3 anywhere = surface.bounds().center() + pose.size_m * random.log_uniform(1e-2, 3.0) * random.direction();
    if (i % 4 == 0) return anywhere;
    Vec3 base = surface.closest(anywhere).p_W_m;
    if (const surface::TriangleMesh* mesh = surface.mesh(); mesh != nullptr && i % 4 >= 2) {
      const auto& corners = mesh->triangles[random.below(mesh->triangles.size())];
      const Vec3& a = mesh->vertices_W_m[static_cast<std::size_t>(corners[0])];
      const Vec3& b = mesh->vertices_W_m[static_cast<std::size_t>(corners[1])];
      base = i % 4 == 2 ? a : Vec3(a + random.uniform() * (b - a));
    }
    return base + pose.size_m * random.log_uniform(1e-12, 1.0) * random.direction();
  }
};

TEST_P(SurfaceConformance, ClosestPointIsOnTheSurfaceAndClosest) {
  double worst = 0.0;
  for_every_pose([&](const Pose& pose, Random& random) {
    std::vector<Vec3> on_surface;
    for (int i = 0; i < traits().queries; ++i) {
      const Vec3 q = query(pose, random, i);
      SCOPED_TRACE(fmt::format("query ({}, {}, {})", q.x(), q.y(), q.z()));
      const surface::SurfacePoint c = pose.surface->closest(q);
      const double tolerance = bound(pose, q);
      const surface::SurfacePoint again = pose.surface->closest(c.p_W_m);
      ASSERT_LE(again.distance_m, tolerance);
      ASSERT_LE((again.p_W_m - c.p_W_m).norm(), tolerance);
      ASSERT_LE(std::abs(c.distance_m - (q - c.p_W_m).norm()), tolerance);
      ASSERT_EQ(c.distance_m, std::abs(c.signed_distance_m));
      ASSERT_EQ(pose.surface->signed_distance(q), c.signed_distance_m);
      ASSERT_LE(std::abs(c.n_W.norm() - 1.0), 1e-12);
      if (c.feature == surface::Feature::face || c.feature == surface::Feature::analytic) {
        ASSERT_LE((c.p_W_m + c.signed_distance_m * c.n_W - q).norm(), tolerance);
      }
      for (const Vec3& p : on_surface) ASSERT_LE(c.distance_m, (p - q).norm() + tolerance);
      on_surface.push_back(c.p_W_m);
      worst = std::max(worst, again.distance_m / pose.rounding(q));
    }
  });
  fmt::print("{}: closest point off the surface by at most {:.2f} units of rounding (bound {})\n", GetParam().name,
             worst, traits().roundings);
}

TEST_P(SurfaceConformance, DistanceIsLipschitz) {
  for_every_pose([&](const Pose& pose, Random& random) {
    for (int i = 0; i < traits().queries; ++i) {
      const Vec3 a = query(pose, random, i);
      const Vec3 b = a + pose.size_m * random.log_uniform(1e-12, 1.0) * random.direction();
      double sa = pose.surface->signed_distance(a);
      double sb = pose.surface->signed_distance(b);
      if (!traits().closed) {
        sa = std::abs(sa);
        sb = std::abs(sb);
      }
      ASSERT_LE(std::abs(sa - sb), (a - b).norm() + bound(pose, a));
    }
  });
}

TEST_P(SurfaceConformance, CrossingsLieOnSegmentAndSurface) {
  int crossed = 0;
  for_every_pose([&](const Pose& pose, Random& random) {
    for (int i = 0; i < traits().queries; ++i) {
      const Vec3 a = query(pose, random, i);
      const Vec3 b = i % 2 == 0 ? query(pose, random, i / 2)
                                : Vec3(a + pose.size_m * random.log_uniform(1e-12, 1.0) * random.direction());
      SCOPED_TRACE(fmt::format("({}, {}, {}) to ({}, {}, {})", a.x(), a.y(), a.z(), b.x(), b.y(), b.z()));
      const double tolerance = bound(pose, a) + bound(pose, b);
      const double sa = pose.surface->signed_distance(a);
      const auto crossing = pose.surface->first_crossing(a, b);
      if (!crossing) continue;
      ++crossed;
      ASSERT_GE(crossing->fraction, 0.0);
      ASSERT_LE(crossing->fraction, 1.0);
      ASSERT_LE((a + crossing->fraction * (b - a) - crossing->p_W_m).norm(), tolerance);
      ASSERT_LE(std::abs(crossing->n_W.norm() - 1.0), 1e-12);
      // Where the segment grazes, rounding moves the crossing along it further by that factor.
      const double length = (b - a).norm();
      const double steepness = std::max(std::abs(crossing->n_W.dot(b - a)) / length, 1e-3);
      ASSERT_LE(pose.surface->closest(crossing->p_W_m).distance_m, tolerance / steepness);
      ASSERT_GE((crossing->p_W_m - a).norm(), std::abs(sa) - tolerance);
      ASSERT_EQ(crossing->entering, crossing->n_W.dot(b - a) < 0.0);
      // Before it, all is on one side.
      const Vec3 before = a + 0.5 * crossing->fraction * (b - a);
      const double sb = pose.surface->signed_distance(before);
      if (traits().closed && std::abs(sa) > tolerance && std::abs(sb) > tolerance) {
        ASSERT_EQ(sa > 0.0, sb > 0.0);
        ASSERT_EQ(crossing->entering, sa > 0.0);
      }
    }
  });
  EXPECT_GT(crossed, traits().queries);
}

TEST_P(SurfaceConformance, ParityOfCrossingsIsInsideAgainstOutside) {
  if (!traits().closed) GTEST_SKIP() << "inside and outside need a closed surface";
  int chains = 0;
  for_every_pose([&](const Pose& pose, Random& random) {
    for (int i = 0; i < traits().queries; ++i) {
      const Vec3 a = query(pose, random, i);
      const Vec3 b = query(pose, random, 0);
      SCOPED_TRACE(fmt::format("({}, {}, {}) to ({}, {}, {})", a.x(), a.y(), a.z(), b.x(), b.y(), b.z()));
      const double tolerance = bound(pose, a) + bound(pose, b);
      const double sa = pose.surface->signed_distance(a);
      const double sb = pose.surface->signed_distance(b);
      if (std::abs(sa) <= tolerance || std::abs(sb) <= tolerance) continue;
      const Vec3 step = (b - a).normalized();
      bool outside = sa > 0.0;
      bool grazes = false;
      Vec3 start = a;
      for (int n = 0; n < 100; ++n) {
        const auto crossing = pose.surface->first_crossing(start, b);
        if (!crossing) break;
        // A chain that grazes, or meets two crossings within rounding, is not followed.
        const Vec3 next = crossing->p_W_m + 100.0 * tolerance * step;
        grazes = grazes || std::abs(crossing->n_W.dot(step)) < 0.05 || (b - next).dot(step) <= 0.0;
        if (grazes) break;
        ASSERT_EQ(crossing->entering, outside);
        outside = !outside;
        if ((pose.surface->signed_distance(next) > 0.0) != outside) grazes = true;
        start = next;
      }
      if (grazes) continue;
      ++chains;
      ASSERT_EQ(outside, sb > 0.0);
    }
  });
  EXPECT_GT(chains, 3 * traits().queries);
}

TEST_P(SurfaceConformance, RigidMotionAndScaleChangeNothingElse) {
  const Pose home = pose(1.0, Quat::Identity(), Vec3::Zero());
  double worst = 0.0;
  for_every_pose([&](const Pose& away, Random& random) {
    for (int i = 0; i < traits().queries; ++i) {
      const Vec3 q = query(home, random, i);
      const Vec3 there = away.world(q);
      // The moved object's own coordinates are rounded, at most twice in turning and once in moving.
      const double tolerance = bound(away, there) + away.scale * bound(home, q);
      const double expected = away.scale * home.surface->signed_distance(q);
      const double obtained = away.surface->signed_distance(there);
      if (traits().closed && std::abs(expected) > tolerance) {
        ASSERT_LE(std::abs(obtained - expected), tolerance) << q.transpose();
      } else {
        ASSERT_LE(std::abs(std::abs(obtained) - std::abs(expected)), tolerance) << q.transpose();
      }
      worst = std::max(worst, std::abs(std::abs(obtained) - std::abs(expected)) /
                                  (away.rounding(there) + away.scale * home.rounding(q)));
      const Vec3 end = query(home, random, 0);
      const auto crossing = home.surface->first_crossing(q, end);
      const auto moved_crossing = away.surface->first_crossing(there, away.world(end));
      const double clear = home.surface->closest(q).distance_m;
      if (!crossing || std::abs(crossing->n_W.dot((end - q).normalized())) < 0.05 || clear < tolerance / away.scale)
        continue;
      // A crossing next to an edge of the silhouette may come or go; one that is steep and clear of the ends may not.
      const double span = (end - q).norm();
      if (moved_crossing &&
          std::abs(moved_crossing->fraction - crossing->fraction) * span * away.scale <= 40.0 * tolerance)
        continue;
      const double margin = 100.0 * tolerance / away.scale;
      const Vec3 inside = crossing->p_W_m - margin * crossing->n_W * (crossing->entering ? 1.0 : -1.0);
      ASSERT_LE(home.surface->closest(inside).distance_m, 0.99 * margin)
          << "a crossing is missing or elsewhere: " << q.transpose();
    }
  });
  fmt::print("{}: signed distance after motion and scaling off by at most {:.2f} units of rounding (bound {})\n",
             GetParam().name, worst, traits().roundings);
}

TEST_P(SurfaceConformance, TheSameInOtherThreadsAndWithoutAllocating) {
  Random random(seed);
  const Pose at = pose(1.0, random.rotation(), Vec3(0.1, 0.2, 0.3));
  std::vector<std::pair<Vec3, Vec3>> queries;
  queries.reserve(static_cast<std::size_t>(traits().queries));
  for (int i = 0; i < traits().queries; ++i) queries.emplace_back(query(at, random, i), query(at, random, i + 1));
  const auto answers = [&](std::vector<double>& out) {
    for (const auto& [a, b] : queries) {
      out.push_back(at.surface->closest(a).signed_distance_m);
      const auto crossing = at.surface->first_crossing(a, b);
      out.push_back(crossing ? crossing->fraction : -1.0);
    }
  };
  std::vector<double> expected;
  expected.reserve(2 * queries.size());
  const AllocationGuard guard;
  answers(expected);
  const std::uint64_t allocated = guard.count();
  EXPECT_TRUE(traits().allocates || !allocations_are_counted() || allocated == 0U) << allocated << " allocations";
  std::vector<std::vector<double>> obtained(3);
  std::vector<std::thread> threads;
  threads.reserve(obtained.size());
  for (auto& out : obtained) threads.emplace_back([&] { answers(out); });
  for (std::thread& thread : threads) thread.join();
  for (const auto& out : obtained) EXPECT_EQ(out, expected);
}

inline std::string surface_case_name(const ::testing::TestParamInfo<SurfaceCase>& tested) { return tested.param.name; }

}  // namespace touchstone::testing

// TOUCHSTONE_SURFACE_CONFORMANCE(Name, case...): outside any namespace; Name and the cases' names are identifiers.
#define TOUCHSTONE_SURFACE_CONFORMANCE(Name, ...)                                                                \
  namespace touchstone::testing {                                                                                \
  INSTANTIATE_TEST_SUITE_P(Name, SurfaceConformance, ::testing::ValuesIn(std::vector<SurfaceCase>{__VA_ARGS__}), \
                           surface_case_name);                                                                   \
  }                                                                                                              \
  static_assert(true)
