// The goldens of scenes against exact answers. With every free region convex, as in front of the floor and wall, on the
// belt between guide and stop, and in the closing wedge, the god-object is the point nearest to the tip in front of all
// faces, whatever came before: found here by trying every set of faces, at poses that the test writes down itself. In
// every case, the ring's too, the proxy is outside of every body, and what it feels is carried by the triangles that it
// touches, found by looking at all of them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <vector>

#include "harness/golden/case_runner.h"
#include "harness/golden/golden_case.h"
#include "harness/recording/recording_file.h"
#include "harness/rendering/scene_file.h"

namespace touchstone::golden {
using recording::RenderedTrajectory;

namespace {

GoldenCase scene_case(const std::string& name) {
  return load_case(std::filesystem::path(std::getenv("TOUCHSTONE_SOURCE_DIR")) / "golden" / name);
}

// Free space is n . x >= b.
struct Face {
  Vec3 n;
  double b;
};
using Faces = std::vector<Face>;

Vec3 y_turned(double angle, const Vec3& v) { return Eigen::AngleAxisd(angle, Vec3::UnitY()) * v; }
// The face through `at`.
Face face(const Vec3& n, const Vec3& at) { return {n, n.dot(at)}; }

// The point of all half-spaces that is nearest to `tip`: of every set of up to three faces the nearest point on all of
// them, the nearest of those that lie in front of every face.
Vec3 nearest_in_front(const Faces& faces, const Vec3& tip) {
  Vec3 best = Vec3::Constant(1e9);
  const auto count = static_cast<unsigned>(faces.size());
  for (unsigned set = 0; set < 1U << count; ++set) {
    Eigen::MatrixXd n(3, 0);
    Eigen::VectorXd gap(0);
    for (unsigned i = 0; i < count; ++i) {
      if ((set >> i & 1U) == 0) continue;
      n.conservativeResize(3, n.cols() + 1);
      gap.conservativeResize(n.cols());
      n.col(n.cols() - 1) = faces[i].n;
      gap[n.cols() - 1] = faces[i].b - faces[i].n.dot(tip);
    }
    Vec3 p = tip;
    if (n.cols() > 0) p += n * (n.transpose() * n).ldlt().solve(gap);
    const bool free = std::ranges::all_of(faces, [&](const Face& one) { return one.n.dot(p) >= one.b - 1e-13; });
    if (free && (p - tip).norm() < (best - tip).norm()) best = p;
  }
  return best;
}

// A scene whose free region is convex, at scale and speed 1.
struct Convex {
  const char* name;
  std::function<Faces(double t_s)> faces;
};

// Between 0.2 s and 0.7 s the wall goes from x = 30 mm to (2, 0, 1) mm and turns by 0.2 rad about y.
Faces wall(double t_s) {
  const double u = std::clamp((t_s - 0.2) / 0.5, 0.0, 1.0);
  const Vec3 at(0.03 - 0.028 * u, 0.0, 0.001 * u);
  return {{Vec3::UnitZ(), 0.0}, face(y_turned(0.2 * u, -Vec3::UnitX()), at)};
}
// The belt's top, the stop's face at x = 8 mm, the guide's at y = 3 mm.
Faces belt(double) { return {{Vec3::UnitZ(), 0.0}, {-Vec3::UnitX(), -0.008}, {-Vec3::UnitY(), -0.003}}; }
// The right block rises by 6 mm/s.
Faces wedge(double t_s) {
  return {face(y_turned(0.5, Vec3::UnitZ()), Vec3::Zero()),
          face(y_turned(-0.5, Vec3::UnitZ()), Vec3(0.0, 0.0, -0.004 + 0.006 * t_s))};
}

class ConvexScene : public ::testing::TestWithParam<Convex> {};
INSTANTIATE_TEST_SUITE_P(Goldens, ConvexScene,
                         ::testing::Values(Convex{"scene-wall", wall}, Convex{"scene-wall-small-fast", wall},
                                           Convex{"scene-belt", belt}, Convex{"scene-belt-large-fast", belt},
                                           Convex{"scene-wedge", wedge}),
                         [](const auto& tested) {
                           std::string name = tested.param.name;
                           std::ranges::replace(name, '-', '_');
                           return name;
                         });

TEST_P(ConvexScene, TheGodObjectIsTheNearestPointInFrontOfAllFaces) {
  const GoldenCase golden = scene_case(GetParam().name);
  const RenderedTrajectory run = recording::load_rendered(golden.expected("god-object"));
  const double k = 500.0 / golden.scale;
  double largest_N = 0.0;
  double off_N = 0.0;
  std::size_t several = 0;
  for (std::size_t i = 0; i < run.size(); ++i) {
    const Vec3 tip = run.tip_W_m[i] / golden.scale;
    const Faces faces = GetParam().faces(run.t_s[i] * golden.speed);
    const Vec3 f_W_N = 500.0 * (nearest_in_front(faces, tip) - tip);
    several += std::ranges::count_if(faces, [&](const Face& one) { return one.n.dot(tip) < one.b; }) > 1 ? 1 : 0;
    largest_N = std::max(largest_N, f_W_N.norm());
    off_N = std::max(off_N, (run.f_W_N[i] - f_W_N).norm());
    ASSERT_LT((run.contact_W_m[i] - (run.tip_W_m[i] + run.f_W_N[i] / k)).norm(), 1e-12 * golden.scale) << i;
  }
  EXPECT_GT(largest_N, 1.0);
  EXPECT_GT(several, run.size() / 10) << "samples that two bodies press on";
  EXPECT_LT(off_N, 1e-8);
  RecordProperty("off_N", std::to_string(off_N));
}

struct Corners {
  std::array<Vec3, 3> p;
};

// The point of the triangle closest to p (Ericson, Real-Time Collision Detection, 2005, 5.1.5).
Vec3 closest_on(const Corners& t, const Vec3& p) {
  const auto& [a, b, c] = t.p;
  const Vec3 ab = b - a;
  const Vec3 ac = c - a;
  const double d1 = ab.dot(p - a);
  const double d2 = ac.dot(p - a);
  if (d1 <= 0 && d2 <= 0) return a;
  const double d3 = ab.dot(p - b);
  const double d4 = ac.dot(p - b);
  if (d3 >= 0 && d4 <= d3) return b;
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return a + d1 / (d1 - d3) * ab;
  const double d5 = ab.dot(p - c);
  const double d6 = ac.dot(p - c);
  if (d6 >= 0 && d5 <= d6) return c;
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return a + d2 / (d2 - d6) * ac;
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) return b + (d4 - d3) / (d4 - d3 + d5 - d6) * (c - b);
  const double w = 1.0 / (va + vb + vc);
  return a + vb * w * ab + vc * w * ac;
}

// How far v is from the cone of the directions: the least |v - sum c_i d_i| with c_i >= 0, by coordinate descent.
double off_cone(const std::vector<Vec3>& directions, const Vec3& v) {
  std::vector<double> c(directions.size(), 0.0);
  Vec3 left = v;
  for (int round = 0; round < 2000; ++round) {
    for (std::size_t i = 0; i < directions.size(); ++i) {
      const double next = std::max(0.0, c[i] + left.dot(directions[i]));
      left -= (next - c[i]) * directions[i];
      c[i] = next;
    }
  }
  return left.norm();
}

class EveryScene : public ::testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Goldens, EveryScene,
                         ::testing::Values("scene-wall", "scene-wall-small-fast", "scene-belt", "scene-belt-large-fast",
                                           "scene-wedge", "scene-ring"),
                         [](const auto& tested) {
                           std::string name = tested.param;
                           std::ranges::replace(name, '-', '_');
                           return name;
                         });

TEST_P(EveryScene, TheProxyIsOutsideAndTouchesWhatCarriesTheForce) {
  const GoldenCase golden = scene_case(GetParam());
  rendering::SceneFile file = parse_scene(golden.scene, golden.name, golden.folder, rendering::SceneFiles::own_folder);
  file.rescale(golden.scale, golden.speed);
  const RenderedTrajectory run = recording::load_rendered(golden.expected("god-object"));
  const double near_m = 1e-9 * golden.scale;
  double off_N = 0.0;
  for (std::size_t i = 0; i < run.size(); i += 3) {
    if (run.contact[i] == 0) continue;
    std::vector<Vec3> touched;
    for (const rendering::SceneFileBody& body : file.bodies) {
      std::size_t segment = 0;
      const rendering::BodyPose pose = body.pose.at(run.t_s[i], segment);
      const Vec3 p = pose.q_WB.conjugate() * (run.contact_W_m[i] - pose.p_W_m);
      double nearest_m = 1e9;
      double side = 0.0;
      for (const auto& triangle : body.mesh_B.triangles) {
        const auto corner = [&](std::size_t j) { return body.mesh_B.vertices_W_m[triangle[j]]; };
        const Corners corners{{corner(0), corner(1), corner(2)}};
        const Vec3 n = (corners.p[1] - corners.p[0]).cross(corners.p[2] - corners.p[0]).normalized();
        const double away_m = (closest_on(corners, p) - p).norm();
        if (away_m < near_m) touched.push_back(pose.q_WB * n);
        // Of triangles that are equally near, the one that p is most in front of or behind tells the side.
        const double height = n.dot(p - corners.p[0]);
        if (away_m < nearest_m - 1e-15 || (away_m < nearest_m + 1e-15 && std::abs(height) > std::abs(side)))
          side = height;
        nearest_m = std::min(nearest_m, away_m);
      }
      ASSERT_TRUE(side > 0.0 || nearest_m < near_m) << body.name << ", sample " << i << ": inside by " << nearest_m;
    }
    ASSERT_FALSE(touched.empty()) << "sample " << i;
    off_N = std::max(off_N, off_cone(touched, run.f_W_N[i]));
  }
  EXPECT_LT(off_N, 1e-6);
}

// The friction cone's answers keep to its cone where the floor or belt alone presses, and the belt drags the tip along.
TEST(SceneGoldens, FrictionIsOnItsConeWhereOneBodyPresses) {
  const GoldenCase golden = scene_case("scene-belt");
  const RenderedTrajectory free = recording::load_rendered(golden.expected("god-object"));
  const RenderedTrajectory run = recording::load_rendered(golden.expected("friction-cone"));
  std::size_t sliding = 0;
  for (std::size_t i = 0; i < run.size(); ++i) {
    const bool alone = run.contact_W_m[i].x() < 0.008 - 1e-9 && run.contact_W_m[i].y() < 0.003 - 1e-9;
    if (!alone || run.f_W_N[i].z() == 0.0) continue;
    const double sideways_N = run.f_W_N[i].head<2>().norm();
    ASSERT_LE(sideways_N, 0.4 * run.f_W_N[i].z() + 1e-9) << i;
    ASSERT_NEAR(run.f_W_N[i].z(), free.f_W_N[i].z(), 1e-9) << i;
    sliding += std::abs(sideways_N - 0.3 * run.f_W_N[i].z()) < 1e-9 ? 1 : 0;
  }
  EXPECT_GT(sliding, 300U);
}

}  // namespace
}  // namespace touchstone::golden
