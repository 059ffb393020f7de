// Every renderer of the catalogue on every shape of the conformance suite. A new one gets it all by a line here; the
// last test fails for a renderer that has none.
#include "harness/surface/cgal/exact_surface.h"
#include "renderers/conformance_subjects_for_test.h"

namespace touchstone::renderers {
using namespace touchstone::testing;  // the suite
namespace {

std::string model(const std::string& renderer, const std::string& rest = "") {
  return R"({"schema": "touchstone-model/1", "renderer": ")" + renderer + "\"" + (rest.empty() ? "" : ", " + rest) +
         "}";
}

// An engine that computes while the servo loop goes on: each answer is that of the step before, which it declares.
class LateRenderer : public rendering::Renderer {
 public:
  explicit LateRenderer(std::unique_ptr<rendering::Renderer> renderer) : renderer_(std::move(renderer)) {}

 private:
  void do_reset() override {
    renderer_->reset();
    held_ = {};
  }
  rendering::StepResult do_step(const rendering::TipState& tip) noexcept override {
    return std::exchange(held_, renderer_->step(tip));
  }

  std::unique_ptr<rendering::Renderer> renderer_;
  rendering::StepResult held_;
};

RendererSubject late(RendererSubject subject) {
  subject.name += "_late";
  subject.lag_samples = 1;
  subject.make = [inner = subject.make](std::shared_ptr<const surface::Surface> surface, double unit) {
    return std::make_unique<LateRenderer>(inner(std::move(surface), unit));
  };
  return subject;
}

std::vector<RendererSubject> subjects() {
  const std::string friction =
      R"("effects": [{"name": "coulomb-friction", "parameters": {"mu_static": 0.4, "mu_dynamic": 0.3}}])";
  auto implicit = subject_of("implicit", model("implicit", R"("parameters": {"resolution": 32})"), 500.0);
  implicit.thinnest_m = 2.0 * 0.04 / 25.0;  // two samples
  const std::string cone = R"("parameters": {"mu_static": 0.4, "mu_dynamic": 0.3})";
  const std::string cone_ball = R"("parameters": {"mu_static": 0.4, "mu_dynamic": 0.3, "tip_radius_m": 0.001})";
  std::vector<RendererSubject> all{
      subject_of("god_object", model("god-object"), 500.0),
      subject_of("god_object_ball", model("god-object", R"("parameters": {"tip_radius_m": 0.001})"), 500.0, 0.0, 0.001),
      subject_of("god_object_friction", model("god-object", friction), 500.0, 0.4),
      subject_of("penalty", model("penalty"), 500.0),
      subject_of("penalty_ball", model("penalty", R"("parameters": {"tip_radius_m": 0.001})"), 500.0, 0.0, 0.001),
      subject_of("friction_cone", model("friction-cone", cone), 500.0, 0.4),
      subject_of("friction_cone_ball", model("friction-cone", cone_ball), 500.0, 0.4, 0.001),
      subject_of("force_shading", model("force-shading"), 500.0),
      subject_of("force_shading_ball", model("force-shading", R"("parameters": {"tip_radius_m": 0.001})"), 500.0, 0.0,
                 0.001),
      subject_of("force_shading_friction", model("force-shading", cone), 500.0, 0.4),
      subject_of("spring_linear", model("spring-linear"), 500.0),
      subject_of("spring_quadratic", model("spring-quadratic"), 200.0),
      subject_of("voxel", model("voxel", R"("parameters": {"resolution": 32})"), 500.0),
      subject_of("voxel_sparse", model("voxel-sparse", R"("parameters": {"resolution": 32})"), 500.0),
      implicit,
      late(subject_of("god_object", model("god-object"), 500.0)),
  };
  if (surface::exact_surface_available()) {
    all.push_back(subject_of("god_object_exact_queries", model("god-object"), 500.0));
    all.back().queries = surface::make_exact_surface;
    all.back().queries_allocate = true;
  }
  return all;
}

TEST(ConformanceOfTheCatalogue, EveryRendererIsASubject) {
  const auto known = subjects();
  for (const auto& entry : renderer_catalogue()) {
    std::string name = entry.name;
    std::replace(name.begin(), name.end(), '-', '_');
    EXPECT_TRUE(std::any_of(known.begin(), known.end(), [&](const RendererSubject& subject) {
      return subject.name == name;
    })) << entry.name;
  }
}

}  // namespace
}  // namespace touchstone::renderers

TOUCHSTONE_RENDERER_CONFORMANCE(Catalogue, touchstone::renderers::subjects());
