// The proxy renderers over every surface of synthetic/, with Embree's queries and with CGAL's exact ones: the same
// answers, in the cone, never inside.
#include <gtest/gtest.h>

#include "harness/base/random.h"
#include "harness/surface/cgal/exact_surface.h"
#include "renderers/hand_for_test.h"
#include "synthetic/surface_catalogue.h"

namespace touchstone::renderers {
using surface::Surface;

namespace {

constexpr double stiffness = 500.0;
constexpr double eps = std::numeric_limits<double>::epsilon();

struct Subject {
  std::string renderer;
  double mu_static, mu_dynamic, radius_m;
};

std::vector<Subject> subjects() {
  return {{"god-object", 0, 0, 0},           {"god-object", 0, 0, 1e-3}, {"friction-cone", 0.5, 0.3, 0},
          {"friction-cone", 0.5, 0.3, 1e-3}, {"force-shading", 0, 0, 0}, {"force-shading", 0.5, 0.3, 1e-3}};
}

// From above, over the surface, pressed up to 0.8 mm deep, with taps.
std::vector<Vec3> strokes(const Surface& at, double radius_m, std::uint64_t seed) {
  Random random(seed);
  const Box3 box = at.bounds();
  const Vec3 half = 0.4 * box.sizes();
  std::vector<Vec3> tips;
  Vec3 over = box.center();
  Vec3 way = random.direction();
  for (int i = 0; i < 400; ++i) {
    if (i % 80 == 0) way = random.direction();
    over.x() = std::clamp(over.x() + 2e-4 * way.x(), box.center().x() - half.x(), box.center().x() + half.x());
    over.y() = std::clamp(over.y() + 2e-4 * way.y(), box.center().y() - half.y(), box.center().y() + half.y());
    const surface::SurfacePoint foot = at.closest({over.x(), over.y(), box.max().z() + 0.02});
    tips.push_back(foot.p_W_m + (radius_m - 8e-4 * std::sin(0.05 * i)) * foot.n_W);
  }
  return tips;
}

TEST(AllSurfaces, ProxiesGiveTheSameWithExactQueriesAndStayInTheConeAndOutside) {
  if (!surface::exact_surface_available()) GTEST_SKIP() << "built without CGAL";
  for (const auto& entry : synthetic::surface_catalogue()) {
    const surface::TriangleMesh mesh = synthetic::make_mesh(entry.name, {}, 600).mesh;
    const std::shared_ptr<const Surface> fast = make_embree_surface(mesh);
    const std::shared_ptr<const Surface> exact = make_exact_surface(mesh);
    for (const Subject& subject : subjects()) {
      SCOPED_TRACE(entry.name + ", " + subject.renderer + ", radius " + std::to_string(subject.radius_m));
      rendering::Model model =
          model_of(subject.renderer, {{"stiffness_N_per_m", stiffness}, {"tip_radius_m", subject.radius_m}});
      if (subject.mu_static > 0.0) {
        model.parameters["mu_static"] = subject.mu_static;
        model.parameters["mu_dynamic"] = subject.mu_dynamic;
      }
      const auto one = make_renderer(model, fast);
      const auto other = make_renderer(model, exact);
      Hand fast_hand(*one);
      Hand exact_hand(*other);
      std::size_t touching = 0;
      for (const Vec3& p : strokes(*fast, subject.radius_m, 41)) {
        const rendering::StepResult obtained = fast_hand.to(p);
        const rendering::StepResult expected = exact_hand.to(p);
        ASSERT_LE((obtained.f_W_N - expected.f_W_N).norm(), stiffness * 1e3 * eps * 0.1);
        ASSERT_TRUE(obtained.f_W_N.allFinite());
        if (!obtained.contact) continue;
        ++touching;
        const double normal_N = obtained.f_W_N.dot(obtained.n_W);
        ASSERT_GE(normal_N, -1e-10);
        ASSERT_LE((obtained.f_W_N - normal_N * obtained.n_W).norm(), subject.mu_static * normal_N * (1 + 1e-9) + 1e-6);
        ASSERT_GE(fast->signed_distance(obtained.contact_W_m) - subject.radius_m, -1e-10);
      }
      EXPECT_GT(touching, 100U);
    }
  }
}

}  // namespace
}  // namespace touchstone::renderers
