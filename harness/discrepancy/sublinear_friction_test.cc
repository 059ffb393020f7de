// Friction that grows less than the load has its name, and is not named where friction goes with the load. The truth is
// written by other equations than the effect's: the area of Hertz's contact under a shear strength, turned over a path
// by Dahl's differential equation.
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

template <class Friction>
Findings search_of(const Friction& friction_N, std::uint64_t seed) {
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
    const MotionColumns path = hand(phase, 1.0);
    return measured(path, forces_N(path, friction_N), small_noise(1.0), noise);
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
  for (const FoundParameter& one : findings.parameters.front()) {
    if (one.name != "exponent") continue;
    EXPECT_LT(one.low95, 2.0 / 3.0);
    EXPECT_GT(one.high95, 2.0 / 3.0);
    EXPECT_LT(one.high95 - one.low95, 0.2);
  }
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

}  // namespace
}  // namespace touchstone::discrepancy
