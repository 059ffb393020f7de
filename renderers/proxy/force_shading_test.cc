// Shaded forces against the smooth shapes that the meshes stand for.
#include "renderers/proxy/force_shading.h"

#include <gtest/gtest.h>

#include <numbers>

#include "harness/base/random.h"
#include "harness/testing/tiny_meshes.h"
#include "renderers/hand_for_test.h"
#include "synthetic/surface_catalogue.h"

namespace touchstone::renderers {
using rendering::StepResult;
using surface::TriangleMesh;

namespace {

constexpr double stiffness = 500.0;
constexpr double eps = std::numeric_limits<double>::epsilon();

std::unique_ptr<rendering::Renderer> shading(const TriangleMesh& mesh, std::map<std::string, double> parameters = {}) {
  parameters.try_emplace("stiffness_N_per_m", stiffness);
  return make_renderer(model_of("force-shading", parameters), make_embree_surface(mesh));
}

double angle(const Vec3& a, const Vec3& b) { return std::atan2(a.cross(b).norm(), a.dot(b)); }

// Rounds about a body's z axis at constant depth, dragged along beside the exact surface.
std::vector<Vec3> rounds(const synthetic::AnalyticSurface& body, double depth_m, double radius_m, int turns,
                         int per_turn) {
  std::vector<Vec3> tips;
  for (int i = 0; i <= turns * per_turn; ++i) {
    const double a = 2.0 * std::numbers::pi * i / per_turn;
    const surface::SurfacePoint foot = body.closest(Vec3(0.03 * std::cos(a), 0.03 * std::sin(a), 0.007));
    tips.push_back(foot.p_W_m + (radius_m - depth_m) * foot.n_W);
  }
  return tips;
}

TEST(ForceShading, KeepsTheSizeOfTheForceAndTheContactPoint) {
  for (const std::string name : {"sphere", "bumpy", "torus", "v-groove", "gauss", "extrusion"}) {
    const TriangleMesh mesh = synthetic::make_mesh(name, {}, 800).mesh;
    const auto at = make_embree_surface(mesh);
    for (const double radius : {0.0, 0.001}) {
      const auto shaded = shading(mesh, {{"tip_radius_m", radius}});
      const auto plain = god_object(mesh, stiffness, radius);
      Hand one(*shaded);
      Hand other(*plain);
      Random random(21);
      std::size_t turned = 0;
      Vec3 way = Vec3(0.2, 0.1, 1.0).normalized();
      for (int i = 0; i < 2000; ++i) {
        way = (way + 0.03 * random.direction()).normalized();
        way.z() = std::abs(way.z());
        const surface::SurfacePoint foot = at->closest(0.06 * way);
        const Vec3 p = foot.p_W_m + (radius - 4e-4 - 5e-4 * std::sin(0.01 * i)) * foot.n_W;
        const StepResult obtained = one.to(p);
        const StepResult expected = other.to(p);
        ASSERT_EQ(obtained.contact, expected.contact);
        ASSERT_EQ(obtained.contact_W_m, expected.contact_W_m);
        ASSERT_EQ(obtained.depth_m, expected.depth_m);
        ASSERT_NEAR(obtained.f_W_N.norm(), expected.f_W_N.norm(), 64 * eps * expected.f_W_N.norm());
        ASSERT_LE((obtained.f_W_N - obtained.f_W_N.norm() * obtained.n_W).norm(), stiffness * 1e3 * eps * 0.1)
            << name << " radius " << radius << " step " << i;
        turned += angle(obtained.f_W_N, expected.f_W_N) > 1e-6 ? 1U : 0U;
      }
      if (name != "v-groove" && name != "extrusion") {
        EXPECT_GT(turned, 50U) << name;
      }
    }
  }
}

// The direction's error falls with the square of the triangles' size (but for a few of the corners), without shading
// with the size.
TEST(ForceShading, IsOfSecondOrderOnASphere) {
  for (const double scale : unit_scales()) {
    std::vector<double> shaded_error, plain_error;
    for (const int levels : {3, 4, 5}) {
      const TriangleMesh mesh = surface::moved(testing::ball(0.03, levels), awkward_rotation(), Vec3::Zero(), scale);
      const auto shaded = shading(mesh, {{"stiffness_N_per_m", stiffness / scale}});
      const auto plain = god_object(mesh, stiffness / scale);
      const auto at = make_embree_surface(mesh);
      Random random(22);
      double sum_shaded = 0.0;
      double sum_plain = 0.0;
      for (int i = 0; i < 800; ++i) {
        // Hardly below the surface: the foot point on a tilted facet is off by tilt times depth.
        const Vec3 way = random.direction();
        const Vec3 touch = at->first_crossing(0.031 * scale * way, 0.02 * scale * way).value().p_W_m;
        for (const auto& [renderer, sum] : {std::pair(shaded.get(), &sum_shaded), {plain.get(), &sum_plain}}) {
          Hand hand(*renderer);
          hand.to(0.031 * scale * way);
          const double error = angle(hand.to(touch - 1e-7 * scale * way).f_W_N, way);
          *sum += error * error;
        }
      }
      shaded_error.push_back(std::sqrt(sum_shaded / 800));
      plain_error.push_back(std::sqrt(sum_plain / 800));
    }
    for (std::size_t i = 0; i + 1 < shaded_error.size(); ++i) {
      // Of first order only along the lines where the octahedron's faces met, whose share falls with the size.
      EXPECT_GT(shaded_error[i] / shaded_error[i + 1], 2.4) << "scale " << scale;
      EXPECT_NEAR(plain_error[i] / plain_error[i + 1], 2.0, 0.3) << "scale " << scale;
    }
    EXPECT_LT(shaded_error.back(), 0.1 * plain_error.back());
  }
}

TEST(ForceShading, LeavesEdgesBeyondTheCreaseAngleSharp) {
  const TriangleMesh mesh = testing::cube(0.02);  // 90 degrees
  const auto plain = god_object(mesh, stiffness);
  const auto sharp = shading(mesh);
  const auto round = shading(mesh, {{"crease_angle_rad", 1.6}});
  Hand one(*plain);
  Hand two(*sharp);
  Hand three(*round);
  for (int i = 0; i < 400; ++i) {
    const Vec3 p(-0.019 + 9e-5 * i, 0.003, 0.0195);
    const Vec3 expected = one.to(p).f_W_N;
    ASSERT_LE((two.to(p).f_W_N - expected).norm(), 64 * eps * stiffness * 0.02) << i;
    const Vec3 other = three.to(p).f_W_N;
    if (i == 1) {
      EXPECT_GT(angle(other, expected), 0.3) << "rounded, the edge tilts the force beside it";
    }
  }
}

TEST(ForceShading, TurnsWithoutJumpsAcrossSmoothEdges) {
  const auto body = synthetic::make_surface("sphere");
  const TriangleMesh mesh = body->tessellate(500).mesh;
  for (const double radius : {0.0, 0.001}) {
    const auto jumps = [&](rendering::Renderer& renderer) {
      Hand hand(renderer);
      double most = 0.0;
      Vec3 last = Vec3::Zero();
      for (const Vec3& p : rounds(*body, 5e-4, radius, 1, 20000)) {
        const StepResult now = hand.to(p);
        if (now.contact && last.squaredNorm() > 0.0) most = std::max(most, angle(now.f_W_N, last));
        last = now.f_W_N;
      }
      return most;
    };
    const double plain = jumps(*god_object(mesh, stiffness, radius));
    const double shaded = jumps(*shading(mesh, {{"tip_radius_m", radius}}));
    EXPECT_LT(shaded, 0.2 * plain + 1e-3) << "radius " << radius;
    if (radius == 0.0) {
      EXPECT_GT(plain, 0.05);
    }
  }
}

// The turned force is not conservative: what it gives back in many rounds about a body, in parts of k d times the way.
TEST(ForceShading, GivesLittleEnergyBackInManyRoundsAndNoneWithFriction) {
  for (const std::string name : {"sphere", "bumpy", "duck"}) {
    const auto body = synthetic::make_surface(name);
    const TriangleMesh mesh = body->tessellate(3000).mesh;
    constexpr double press_depth = 8e-4;
    for (const double radius : {0.0, 0.001}) {
      const auto tips = rounds(*body, press_depth, radius, 10, 2000);
      const auto given = [&](const std::map<std::string, double>& mu) {
        auto parameters = mu;
        parameters["tip_radius_m"] = radius;
        const auto renderer = shading(mesh, parameters);
        Hand hand(*renderer);
        hand.to(tips.front() + 0.01 * tips.front().normalized());
        double energy_J = 0.0;
        double scale_J = 0.0;
        for (std::size_t i = 0; i + 1 < tips.size(); ++i) {
          const StepResult now = hand.to(tips[i]);
          const Vec3 d = tips[i + 1] - tips[i];
          energy_J += now.f_W_N.dot(d);
          scale_J += now.f_W_N.norm() * d.norm();
        }
        EXPECT_GT(scale_J, 0.0);
        return energy_J / scale_J;
      };
      EXPECT_LT(given({}), 0.01) << name << " radius " << radius;
      EXPECT_LT(given({{"mu_static", 0.3}, {"mu_dynamic", 0.2}}), -0.15) << name << " radius " << radius;
    }
  }
}

}  // namespace
}  // namespace touchstone::renderers
