// Counted renderers: the same forces to the bit as the plain ones, on every shape, and counts that repeat.
#include <gtest/gtest.h>

#include "harness/base/random.h"
#include "harness/rendering/operations.h"
#include "harness/testing/tiny_meshes.h"
#include "renderers/hand_for_test.h"
#include "synthetic/surface_catalogue.h"

namespace touchstone::renderers {
using rendering::CountedRenderer;
using rendering::Model;
using rendering::StepResult;
using rendering::TipState;
using surface::Surface;

namespace {

std::vector<Vec3> tips_about(const Surface& surface, std::uint64_t seed, int count) {
  Random random(seed);
  const Box3 box = surface.bounds();
  const double size = box.sizes().maxCoeff();
  std::vector<Vec3> tips;
  surface::SurfacePoint foot = surface.closest(box.max() + 0.2 * Vec3(0.3, 0.2, 1.0) * size);
  for (int i = 0; i < count; ++i) {
    if (i % 100 == 0) foot = surface.closest(box.center() + size * random.direction());
    const double depth = size * 0.02 * std::sin(0.1 * i);
    tips.push_back(foot.p_W_m - depth * foot.n_W);
    foot = surface.closest(foot.p_W_m + 2e-3 * size * random.direction());
  }
  return tips;
}

rendering::TipSource source_of(const std::vector<Vec3>& tips) {
  return [&tips, next = std::size_t{0}](TipState& tip) mutable {
    if (next == tips.size()) return false;
    tip.p_W_m = tips[next++];
    tip.t_s = static_cast<double>(next) * 1e-3;
    return true;
  };
}

struct Subject {
  std::string name;
  std::string renderer;
  double tip_radius = 0.0;  // of a body of some 60 mm
  double mu = 0.0;
};
void PrintTo(const Subject& subject, std::ostream* out) { *out << subject.name; }

Model model_of_subject(const Subject& subject, double scale) {
  Model model = model_of(subject.renderer, {});
  if (subject.tip_radius > 0.0) model.parameters["tip_radius_m"] = scale * subject.tip_radius;
  if (subject.mu > 0.0) {
    model.parameters["mu_static"] = 1.5 * subject.mu;
    model.parameters["mu_dynamic"] = subject.mu;
  }
  // Takes samples of the whole body: few of them say as much here.
  for (const auto& parameter : find_renderer(model).parameters) {
    if (parameter.name == "resolution") model.parameters["resolution"] = 20.0;
  }
  return model;
}

class CountedRendererOf : public ::testing::TestWithParam<Subject> {};

TEST_P(CountedRendererOf, GivesTheSameBitsAndTheSameCountsAgain) {
  for (const char* shape : {"duck", "v-groove", "thin-shell", "gauss", "extrusion"}) {
    for (const double scale : {1e-3, 1.0, 1e3}) {
      const std::shared_ptr<const Surface> surface = make_embree_surface(surface::moved(
          synthetic::make_mesh(shape, {}, 1500).mesh, awkward_rotation(), scale * Vec3(1, 2, 3) * 0.01, scale));
      const Model model = model_of_subject(GetParam(), scale);
      const auto plain = make_renderer(model, surface);
      const CountedRenderer counted = make_counted_renderer(model, surface);
      ASSERT_NE(counted.renderer, nullptr) << counted.not_counted;
      EXPECT_EQ(counted.not_counted, "");
      const auto tips = tips_about(*surface, 3, 1500);
      plain->reset();
      int touching = 0;
      for (std::size_t i = 0; i < tips.size(); ++i) {
        const TipState tip{static_cast<double>(i) * 1e-3, tips[i], Quat::Identity()};
        const StepResult a = plain->step(tip);
        const StepResult b = counted.renderer->step(tip);
        ASSERT_EQ(a.f_W_N, b.f_W_N) << shape << " scale " << scale << " step " << i;
        ASSERT_EQ(a.contact_W_m, b.contact_W_m);
        ASSERT_EQ(a.n_W, b.n_W);
        ASSERT_EQ(a.contact, b.contact);
        touching += a.contact ? 1 : 0;
      }
      // Of a shell thinner than its samples the implicit renderer feels little, as it declares.
      const bool implicit = GetParam().renderer == "implicit";
      const bool too_thin = implicit && std::string_view(shape) == "thin-shell";
      EXPECT_GT(touching, too_thin ? 20 : implicit ? 200 : 300) << shape;
      const rendering::OperationReport once = count_operations(*counted.renderer, source_of(tips));
      const rendering::OperationReport again =
          count_operations(*make_counted_renderer(model, surface).renderer, source_of(tips));
      EXPECT_EQ(once.counts, again.counts);
      EXPECT_EQ(once.steps, tips.size());
      EXPECT_GT(once.mean, 5.0);
      EXPECT_LE(once.median, static_cast<double>(once.max));
    }
  }
}

std::vector<Subject> subjects() {
  std::vector<Subject> found;
  for (const auto& entry : renderer_catalogue()) {
    if (entry.make_counted == nullptr) continue;
    std::string name = entry.name;
    std::replace(name.begin(), name.end(), '-', '_');
    found.push_back({name, entry.name});
    const auto takes = [&](std::string_view parameter) {
      return std::ranges::any_of(entry.parameters, [&](const auto& p) { return p.name == parameter; });
    };
    if (!takes("tip_radius_m")) continue;
    found.push_back({name + "_ball", entry.name, 1e-3});
    if (takes("mu_static")) found.push_back({name + "_friction_ball", entry.name, 1e-3, 0.3});
  }
  return found;
}

INSTANTIATE_TEST_SUITE_P(Catalogue, CountedRendererOf, ::testing::ValuesIn(subjects()),
                         [](const auto& of) { return of.param.name; });

TEST(CountedRenderer, FrictionAndOpenMeshesToTheBit) {
  const std::shared_ptr<const Surface> sheet = make_embree_surface(testing::grid(0.05, 10));
  for (const auto& [renderer, mu, radius] : {std::tuple{"friction-cone", 0.0, 0.0},
                                             {"friction-cone", 0.3, 0.0},
                                             {"force-shading", 0.3, 0.0},
                                             {"friction-cone", 0.0, 2e-3},
                                             {"friction-cone", 0.3, 2e-3},
                                             {"force-shading", 0.3, 2e-3}}) {
    const Model model = model_of(renderer, {{"mu_static", 1.5 * mu}, {"mu_dynamic", mu}, {"tip_radius_m", radius}});
    const auto plain = make_renderer(model, sheet);
    const CountedRenderer counted = make_counted_renderer(model, sheet);
    ASSERT_NE(counted.renderer, nullptr);
    Random random(5);
    Vec3 tip(0.0, 0.0, 0.002);
    for (int i = 0; i < 20000; ++i) {
      tip += 1e-4 * random.direction() - 1e-2 * Vec3(tip.x(), tip.y(), tip.z() + 1e-3);
      if (i % 500 == 0) tip = {random.uniform(-0.06, 0.06), random.uniform(-0.06, 0.06), 0.002};
      const TipState now{static_cast<double>(i) * 1e-3, tip, Quat::Identity()};
      const StepResult a = plain->step(now);
      const StepResult b = counted.renderer->step(now);
      ASSERT_EQ(a.f_W_N, b.f_W_N) << i;
      ASSERT_EQ(a.contact_W_m, b.contact_W_m) << i;
    }
  }
}

TEST(CountedRenderer, SaysWhatIsNotCounted) {
  const std::shared_ptr<const Surface> mesh = make_embree_surface(testing::cube(0.02));
  // Three triangles at one edge.
  surface::TriangleMesh fin;
  fin.vertices_W_m = {{0, 0, 0}, {0.01, 0, 0}, {0, 0.01, 0}, {0, -0.01, 0}, {0, 0, 0.01}};
  fin.triangles = {{0, 1, 2}, {1, 0, 3}, {0, 1, 4}};
  const std::shared_ptr<const Surface> irregular = make_embree_surface(fin);
  const CountedRenderer point = make_counted_renderer(model_of("god-object", {}), irregular);
  EXPECT_EQ(point.renderer, nullptr);
  EXPECT_EQ(point.not_counted, "the renderer god-object on a mesh with triangles that cannot be walked on");
  // A ball does not walk.
  const CountedRenderer ball = make_counted_renderer(model_of("god-object", {{"tip_radius_m", 1e-3}}), irregular);
  EXPECT_NE(ball.renderer, nullptr);
  EXPECT_EQ(ball.not_counted, "");
  const CountedRenderer analytic = make_counted_renderer(model_of("implicit", {}), synthetic::make_surface("sphere"));
  EXPECT_EQ(analytic.renderer, nullptr);
  EXPECT_EQ(analytic.not_counted, "the arithmetic of an analytic surface");
  Model friction = model_of("penalty", {});
  friction.effects.push_back({"coulomb-friction", {{"mu_static", 0.3}, {"mu_dynamic", 0.3}}, "/effects/0"});
  const CountedRenderer with = make_counted_renderer(friction, mesh);
  EXPECT_NE(with.renderer, nullptr);
  EXPECT_EQ(with.not_counted, "the effects of the contact");
}

// Steps that are counted by hand, from the formulas in ball_proxy.cc.
TEST(CountedRenderer, ABallsStepsOverATriangleAreWhatTheyAreByHand) {
  constexpr double ball_radius = 0.0078125;  // 2^-7: nothing is rounded
  surface::TriangleMesh one;
  one.vertices_W_m = {{-1.0, -1.0, 0.0}, {1.0, -1.0, 0.0}, {0.0, 1.0, 0.0}};
  one.triangles = {{0, 1, 2}};
  const CountedRenderer counted = make_counted_renderer(
      model_of("god-object", {{"stiffness_N_per_m", 500.0}, {"tip_radius_m", ball_radius}}), make_embree_surface(one));
  ASSERT_NE(counted.renderer, nullptr);
  auto step = [&, t_s = 0.0](double z) mutable {
    const OperationCounts before = operations_on_this_thread();
    const StepResult result = counted.renderer->step({t_s += 1e-3, Vec3(0.0, 0.0, z), Quat::Identity()});
    return std::pair(result.f_W_N.z(), operations_on_this_thread() - before);
  };
  counted.renderer->reset();
  step(0.5);
  step(0.5);  // has gathered what is near: nothing
  {
    // Rounding at the tip and at the centre: 3 comparisons and a product each, and the larger of the two. Whether
    // anything is gathered, a comparison; whether the centre is covered: a distance (5 sums, 3 products, a root) and a
    // comparison. Without contact the goal is the tip: its offset (3), how far it is (5 sums, 5 products, 1
    // comparison), the least distance (1); then the way's length (5, 3 and a root), and whether the goal is covered
    // (5, 3, a root, a comparison).
    const auto [force, counts] = step(0.5005);
    EXPECT_EQ(force, 0.0);
    EXPECT_EQ(counts, (OperationCounts{5 + 3 + 5 + 1 + 5 + 5, 2 + 3 + 5 + 3 + 3, 0, 3, 7 + 1 + 1 + 1 + 1}));
  }
  // Onto the sheet, and on it once more.
  for (const double z : {0.015625, 0.0078125, 0.00732421875}) step(z);
  const double z = 0.0068359375;
  const auto [force, counts] = step(z);
  EXPECT_EQ(force, 500.0 * (ball_radius - z));
  OperationCounts by_hand{0, 2, 0, 0, 7};  // roundings, as before
  const auto plus = [&](std::uint64_t add, std::uint64_t multiply, std::uint64_t square_root, std::uint64_t compare) {
    by_hand += {add, multiply, 0, square_root, compare};
  };
  plus(6, 3, 0, 1);           // gliding on the face that holds it: the pull out of it, not negative
  plus(5, 3, 0, 1);           // the centre is in front
  plus(3, 3, 0, 0);           // the goal
  plus(5, 5, 0, 1);           // not too far
  plus(5 + 6 + 5, 9, 0, 3);   // within its borders
  plus(1, 0, 0, 0);           // the least distance of what else it can meet there: nothing
  plus(3 + 3, 0, 0, 0);       // the push, for the force and for the normal
  plus(5 + 16, 3 + 9, 0, 4);  // the normal: the closest point of the triangle
  plus(2, 3 + 3, 1, 0);       // the force, and the depth
  EXPECT_EQ(counts, by_hand);
  EXPECT_EQ(counts.total(), 126U);
}

}  // namespace
}  // namespace touchstone::renderers
