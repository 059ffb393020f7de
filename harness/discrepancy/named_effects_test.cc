// What has a name is called by it, on a plate whose forces are written by other equations than the effects': friction
// by the area of Hertz's contact under a shear strength, turned over a path by Dahl's differential equation; a sharp
// border between two materials.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "harness/discrepancy/catalogue_for_test.h"
#include "harness/discrepancy/findings.h"
#include "harness/discrepancy/plane_for_test.h"
#include "harness/discrepancy/two_recordings_for_test.h"
#include "harness/surface/embree_surface.h"
#include "renderers/catalogue.h"
#include "renderers/model_predictor.h"

namespace touchstone::discrepancy {
namespace {

using rendering::Candidate;
using rendering::Model;

constexpr double plate_N_per_m = 900.0;

// On the plane z = 0, the tip's velocity by differences; `friction_N` of the load.
template <class Friction>
std::vector<Vec3> forces_N(const MotionColumns& path, const Friction& friction_N) {
  constexpr double path_m = 8e-5;
  std::vector<Vec3> f_W_N;
  Vec3 z = Vec3::Zero();
  for (std::size_t i = 0; i < path.size(); ++i) {
    const double load_N = plate_N_per_m * std::max(0.0, -path.p_W_m[i].z());
    Vec3 step_m = i > 0 ? Vec3(path.p_W_m[i] - path.p_W_m[i - 1]) : Vec3(Vec3::Zero());
    step_m.z() = 0.0;
    z = load_N > 0.0 ? Vec3((z + step_m / path_m) / (1.0 + step_m.norm() / path_m)) : Vec3(Vec3::Zero());
    f_W_N.emplace_back(-friction_N(load_N) * z + load_N * Vec3::UnitZ());
  }
  return f_W_N;
}

// `force_W_N` of a path, for two recordings of every `nth` sample.
template <class Force>
Findings searched(const Force& force_W_N, std::uint64_t seed, std::size_t nth = 1) {
  surface::TriangleMesh mesh;
  mesh.vertices_W_m = {{-0.1, -0.1, 0}, {0.1, -0.1, 0}, {0.1, 0.1, 0}, {-0.1, 0.1, 0}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  mesh.source = "plate";
  const std::shared_ptr<const surface::Surface> plate = surface::make_embree_surface(mesh);
  Model start;
  start.renderer = "god-object";
  start.parameters["stiffness_N_per_m"] = 850.0;
  start.source = "test";
  const auto measure = [&](double phase, std::uint64_t noise) {
    const MotionColumns whole = hand(phase, 1.0);
    MotionColumns path;
    for (std::size_t i = 0; i < whole.size(); i += nth) {
      path.t_s.push_back(whole.t_s[i]);
      path.p_W_m.push_back(whole.p_W_m[i]);
    }
    return measured(path, force_W_N(path), small_noise(1.0), noise);
  };
  const TwoRecordings recordings(
      measure(0.0, seed), measure(1.1, seed + 1), small_noise(1.0), start,
      [&](const MotionColumns& motion) { return renderers::make_model_predictor(plate, motion); });
  const std::vector<Candidate> library = whole_catalogue();
  Findings findings;
  findings.search = search_effects(recordings.data, start, library, {}, [](const std::string&) {});
  conclude(findings, library);
  return findings;
}

template <class Friction>
Findings search_of(const Friction& friction_N, std::uint64_t seed) {
  return searched([&](const MotionColumns& path) { return forces_N(path, friction_N); }, seed);
}

// A value of the first effect found and its interval.
FoundParameter value_of(const Findings& findings, const std::string& name) {
  for (const FoundParameter& one : findings.parameters.at(0)) {
    if (one.name == name) return one;
  }
  return {};
}

TEST(SublinearFriction, OfASoftBallIsNamed) {
  constexpr double radius_m = 4e-3, modulus_Pa = 3e5, shear_Pa = 3e4;
  const Findings findings = search_of(
      [&](double load_N) {
        const double a_m = std::cbrt(0.75 * radius_m * load_N / modulus_Pa);
        return shear_Pa * std::numbers::pi * a_m * a_m;
      },
      1);
  ASSERT_EQ(findings.search.found.size(), 1U) << findings.explanation;
  EXPECT_EQ(findings.search.found.front().name, "sublinear-friction");
  EXPECT_EQ(findings.verdict, FindingsVerdict::explained) << findings.explanation;
  const FoundParameter exponent = value_of(findings, "exponent");
  EXPECT_LT(exponent.low95, 2.0 / 3.0);
  EXPECT_GT(exponent.high95, 2.0 / 3.0);
  EXPECT_LT(exponent.high95 - exponent.low95, 0.2);
}

TEST(SublinearFriction, OfTheLoadIsNot) {
  for (const double mu : {0.15, 0.5}) {
    for (const std::uint64_t seed : {1U, 3U}) {
      const Findings findings = search_of([&](double load_N) { return mu * load_N; }, seed);
      ASSERT_EQ(findings.search.found.size(), 1U) << findings.explanation;
      EXPECT_EQ(findings.search.found.front().name, "coulomb-friction") << mu << ", seed " << seed;
    }
  }
}

// Two plates glued together along a line, which the tip crosses aslant.
TEST(TwoMaterials, AreNamedAndTheirBorderIsFound) {
  constexpr double direction_rad = 0.6, border_m = 3e-3, ratio = 1.8;
  const Findings findings = searched(
      [&](const MotionColumns& path) {
        std::vector<Vec3> f_W_N = forces_N(path, [](double) { return 0.0; });
        for (std::size_t i = 0; i < path.size(); ++i) {
          const Vec3& p = path.p_W_m[i];
          if (p.x() * std::cos(direction_rad) + p.y() * std::sin(direction_rad) > border_m) f_W_N[i] *= ratio;
        }
        return f_W_N;
      },
      7, 3);
  ASSERT_EQ(findings.search.found.size(), 1U) << findings.explanation;
  EXPECT_EQ(findings.search.found.front().name, "two-materials");
  // The same border from its other side has the reciprocal ratio.
  const double found = value_of(findings, "ratio").value;
  EXPECT_NEAR(std::abs(std::log(found)), std::log(ratio), 0.05);
  const double turned = found < 1.0 ? -1.0 : 1.0;
  const double towards_rad = value_of(findings, "direction_rad").value;
  EXPECT_NEAR(turned * std::cos(towards_rad - direction_rad), 1.0, 0.005);
  EXPECT_NEAR(turned * value_of(findings, "border_m").value, border_m, 1e-3);
}

}  // namespace
}  // namespace touchstone::discrepancy
