// Every renderer in the loop as theory says: on a plane it is the flat wall, stable below the limit and not above.
#include "servo/atlas.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <deque>

#include "harness/surface/embree_surface.h"
#include "renderers/catalogue.h"
#include "servo/flat_wall.h"
#include "servo/limits.h"
#include "synthetic/generators.h"

namespace touchstone::servo {
namespace {

LoopSetup exact_setup() {
  return make_setup("touch", "light", {{"mass_kg", 0.1}, {"friction_N", 0.0}, {"resolution_m", 0.0}}, 1);
}

const AtlasCase& case_named(const std::string& name) {
  return *std::ranges::find(atlas_cases(), name, &AtlasCase::name);
}

AtlasAnswer answer_of(const rendering::Model& model, const std::string& where, const LoopSetup& setup) {
  return atlas_answer(renderers::built_in_catalogue(), synthetic::built_in_generators(), model, case_named(where),
                      setup, {});
}

// What was right some steps ago, as an engine's model that rests in a thread of its own. Not passive.
class Late final : public rendering::Renderer {
 public:
  explicit Late(double stiffness) : wall_(stiffness) {}

 protected:
  void do_reset() override { answers_.clear(); }
  rendering::StepResult do_step(const rendering::TipState& tip) noexcept override {
    constexpr std::size_t steps = 4;
    answers_.push_back(wall_.step(tip));
    if (answers_.size() > steps) answers_.pop_front();
    return answers_.front();
  }

 private:
  FlatWall wall_;
  std::deque<rendering::StepResult> answers_;
};

rendering::Model late_model(double stiffness) {
  auto entry = std::make_shared<rendering::RendererEntry>();
  entry->name = "late";
  entry->parameters = renderers::renderer_catalogue().front().parameters;
  entry->make = [stiffness](const auto&, const auto&) { return std::make_unique<Late>(stiffness); };
  rendering::Model model = atlas_model(*entry, stiffness);
  model.provided = entry;
  return model;
}

// Colgate and Schenkel 1997: passive below K = 2 b / T, and so stable in any hand.
TEST(Atlas, APassiveRendererIsStableBelowTheLimitInAnyHandAndALateOneIsNot) {
  for (const char* const grip : {"light", "firm"}) {
    for (const double stiffness : {200.0, 2000.0, 10000.0}) {
      const LoopSetup setup = make_setup("falcon", grip, {}, 1);
      for (const auto& entry : renderers::renderer_catalogue()) {
        const AtlasAnswer answer = answer_of(atlas_model(entry, stiffness), "passive plane", setup);
        if (entry.name == "spring-quadratic") {
          EXPECT_THAT(answer.refused, ::testing::HasSubstr("stiffness_N_per_m"));
          continue;
        }
        EXPECT_EQ(answer.verdict, Verdict::stable)
            << entry.name << ", " << stiffness << " N/m, " << grip << ": " << sentence(answer.worst);
      }
      if (stiffness < 1000.0) continue;  // a hand's own damping makes up for it
      const AtlasAnswer late = answer_of(late_model(stiffness), "passive plane", setup);
      const auto found = atlas_findings({late}, {});
      ASSERT_FALSE(found.empty()) << stiffness << " N/m, " << grip << ": " << sentence(late.worst);
      EXPECT_EQ(found.front().name, "unstable-below-limit");
    }
  }
}

// A ball touches as far above the shapes as it is thick.
TEST(Atlas, ABallIsPressedAsAPointIs) {
  auto ball = std::make_shared<rendering::RendererEntry>(renderers::renderer_catalogue().front());
  ball->name = "ball";
  std::ranges::find(ball->parameters, "tip_radius_m", &rendering::ParameterDeclaration::name)->initial = 3e-3;
  rendering::Model model = atlas_model(*ball, 1000.0);
  model.provided = ball;
  const LoopSetup setup = make_setup("touch-x", "light", {}, 1);
  for (const char* const where : {"passive plane", "plane"}) {
    const AtlasAnswer point = answer_of(atlas_model(renderers::renderer_catalogue().front(), 1000.0), where, setup),
                      thick = answer_of(model, where, setup);
    EXPECT_EQ(thick.verdict, Verdict::stable) << sentence(thick.worst);
    EXPECT_NEAR(thick.worst.kick_N, point.worst.kick_N, 0.01) << where;
    EXPECT_NEAR(thick.worst.judged_s, point.worst.judged_s, 0.01) << where;
  }
}

AtlasAnswer made(const std::string& where, Verdict verdict, double buzz_jnd, double kick_jnd) {
  AtlasAnswer out;
  out.where = where;
  out.verdict = verdict;
  out.worst.buzz.jnd = buzz_jnd;
  out.worst.kick_jnd = kick_jnd;
  return out;
}

TEST(Atlas, FindingsAreWhatAHandFeelsAndTheGodObjectDoesNotDo) {
  std::vector<AtlasAnswer> reference, answers;
  for (const AtlasCase& own : atlas_cases()) reference.push_back(made(own.name, Verdict::stable, 0.2, 0.1));
  EXPECT_TRUE(atlas_findings(reference, reference).empty());

  answers = {made("plane", Verdict::stable, 0.9, 0.9), made("ridge", Verdict::buzzes, 1.5, 0.0),
             made("v-groove", Verdict::unstable, 3.0, 0.0), made("plane, friction 0.4", Verdict::buzzes, 2.0, 0.0),
             made("step of 1 mm", Verdict::cannot_tell, 9.0, 1.3)};
  const auto found = atlas_findings(answers, reference);
  ASSERT_EQ(found.size(), 3U);
  EXPECT_EQ(found[0].name, "buzz-with-friction");
  EXPECT_EQ(found[1].name, "buzz-at-edges");
  EXPECT_THAT(found[1].where, ::testing::ElementsAre("v-groove", "ridge"));
  EXPECT_EQ(found[1].jnd, 3.0);
  EXPECT_EQ(found[2].name, "kick");
  EXPECT_EQ(found[0].follows_from, "");

  // Where the plane buzzes already, the edges follow.
  answers.push_back(made("passive plane", Verdict::buzzes, 1.1, 0.0));
  const auto everywhere = atlas_findings(answers, reference);
  ASSERT_EQ(everywhere.size(), 4U);
  EXPECT_EQ(everywhere[0].name, "unstable-below-limit");
  EXPECT_EQ(everywhere[2].follows_from, "unstable-below-limit");

  // A stiffness that the god-object is not stable with either.
  for (AtlasAnswer& own : reference) own.verdict = Verdict::unstable;
  EXPECT_EQ(atlas_findings(answers, reference).size(), 1U);
}

TEST(Atlas, EveryRendererIsStableBelowTheLimitAndNotAboveIt) {
  const LoopSetup setup = exact_setup();
  const double limit = critical_gain(setup.parameters)->stiffness_N_per_m;
  for (const auto& entry : renderers::renderer_catalogue()) {
    if (entry.name == "spring-quadratic") continue;  // it has no stiffness
    for (const auto& [share, stable] : {std::pair{0.4, true}, {2.0, false}}) {
      const AtlasAnswer answer = atlas_answer(renderers::built_in_catalogue(), synthetic::built_in_generators(),
                                              atlas_model(entry, share * limit), case_named("plane"), setup, {});
      EXPECT_EQ(answer.refused, "");
      EXPECT_EQ(answer.verdict == Verdict::stable, stable)
          << entry.name << " at " << share << " of the limit: " << sentence(answer.worst);
    }
  }
}

TEST(Atlas, AGodObjectOnAPlaneOfTrianglesIsTheFlatWall) {
  const LoopSetup setup = exact_setup();
  const auto& generators = synthetic::built_in_generators();
  const auto mesh = generators.mesh("plane", {}, 10000).mesh;
  const auto renderer = renderers::make_renderer(atlas_model(renderers::renderer_catalogue().front(), 1000.0),
                                                 surface::make_embree_surface(mesh));
  const MotionColumns path = atlas_path(*generators.surface("plane", {}), setup.parameters);
  FlatWall wall(1000.0);
  const LoopTrace on_mesh = run_loop(*renderer, path, setup.parameters),
                  on_wall = run_loop(wall, path, setup.parameters);
  ASSERT_EQ(on_mesh.size(), on_wall.size());
  double worst_m = 0.0;
  for (std::size_t i = 0; i < on_mesh.size(); ++i)
    worst_m = std::max(worst_m, (on_mesh.tip_W_m[i] - on_wall.tip_W_m[i]).norm());
  fmt::print("largest difference of the tip over {} ticks: {:.1e} m\n", on_mesh.size(), worst_m);
  EXPECT_LT(worst_m, 1e-12);
}

}  // namespace
}  // namespace touchstone::servo
