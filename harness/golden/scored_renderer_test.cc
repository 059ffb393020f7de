// A renderer in the place of a golden case's own.
#include "harness/golden/scored_renderer.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <deque>

#include "harness/base/error.h"
#include "harness/testing/temporary_folder.h"
#include "renderers/catalogue.h"
#include "synthetic/generators.h"

namespace touchstone::golden {

namespace {

using ::testing::HasSubstr;

Catalogues catalogues() { return {renderers::built_in_catalogue(), synthetic::built_in_generators()}; }

std::shared_ptr<const rendering::RendererEntry> entry_named(const std::string& name) {
  rendering::Model model;
  model.renderer = name;
  return std::make_shared<const rendering::RendererEntry>(renderers::find_renderer(model));
}

GoldenCase case_named(const std::string& name) {
  return load_case(std::filesystem::path(std::getenv("TOUCHSTONE_SOURCE_DIR")) / "golden" / name);
}
GoldenCase plane_taps() { return case_named("plane-taps"); }

class ScoredRenderer : public ::testing::Test {
 protected:
  renderer_faults::Scorecard score(const std::string& renderer, const std::vector<GoldenCase>& cases,
                                   ScoreRequest request = {}) {
    request.cost = false;
    request.options = "as given ";
    request.out = folder_.path();
    return score_renderer(catalogues(), entry_named(renderer), request, cases);
  }
  testing::TemporaryFolder folder_;
};

// One card, since looking for every fault takes a while: the case's own renderer, a case that cannot run, and a case
// without the model.
TEST_F(ScoredRenderer, TheCasesOwnRendererPassesAndWhatCannotRunIsAProblem) {
  GoldenCase broken = plane_taps();
  broken.surface.mesh = "nowhere.obj";
  broken.surface.generator.clear();
  GoldenCase without = plane_taps();
  without.models.erase("god-object");
  const renderer_faults::Scorecard card = score("god-object", {plane_taps(), broken, without});
  ASSERT_EQ(card.cases.size(), 2U) << "a case without the model does not count";
  EXPECT_EQ(card.cases[0].name, "plane-taps");
  EXPECT_EQ(card.cases[0].problem, "");
  EXPECT_TRUE(card.cases[0].exact);
  EXPECT_TRUE(card.cases[0].felt);
  EXPECT_THAT(card.cases[1].problem, HasSubstr("nowhere.obj"));
  EXPECT_FALSE(card.cases[1].felt);
  EXPECT_TRUE(card.diagnosis.findings.empty()) << renderer_faults::scorecard_to_text(card);
  EXPECT_EQ(verdict_of(card), renderer_faults::CardVerdict::failed) << "what could not run is not green";
  EXPECT_EQ(card.options, "as given ");
  EXPECT_FALSE(card.cost.has_value());
}

// The tip is the case's, 1 mm in all of them, also where another was given for what is no golden case; a case of a
// point says nothing about a ball.
TEST_F(ScoredRenderer, ABallIsHeldAgainstCasesOfThatBall) {
  ScoreRequest request;
  request.model = "god-object-ball";
  request.facts.parameters = {{"tip_radius_m", 0.002}};
  const GoldenCase of_a_ball = case_named("crease-concave-approach");
  GoldenCase of_a_point = of_a_ball;
  of_a_point.models["god-object-ball"] = of_a_point.models.at("god-object");
  const renderer_faults::Scorecard card = score("god-object", {of_a_ball, of_a_point}, request);
  ASSERT_EQ(card.cases.size(), 2U);
  EXPECT_EQ(card.cases[0].problem, "");
  EXPECT_TRUE(card.cases[0].exact);
  EXPECT_THAT(card.cases[1].problem, HasSubstr("a ball of 0.002 m in radius, the case's of 0 m"));
  EXPECT_TRUE(card.cases[1].skipped);
  EXPECT_EQ(verdict_of(card), renderer_faults::CardVerdict::passed) << renderer_faults::scorecard_to_text(card);
}

// The god-object in a thread of its own, as an engine may have it: every answer is that of two samples before.
class Late final : public rendering::Renderer {
 public:
  explicit Late(std::unique_ptr<rendering::Renderer> inner) : inner_(std::move(inner)) {}

 private:
  void do_reset() override {
    inner_->reset();
    waiting_.clear();
  }
  rendering::StepResult do_step(const rendering::TipState& tip) noexcept override {
    waiting_.push_back(inner_->step(tip));
    if (waiting_.size() <= 2) return {};
    const rendering::StepResult answer = waiting_.front();
    waiting_.pop_front();
    return answer;
  }
  std::unique_ptr<rendering::Renderer> inner_;
  std::deque<rendering::StepResult> waiting_;
};

std::shared_ptr<const rendering::RendererEntry> late_by_two(double declared_samples) {
  rendering::RendererEntry entry = *entry_named("god-object");
  entry.name = "late-god-object";
  entry.parameters.push_back({"lag_samples", "1", 0.0, 100.0, declared_samples, "samples by which answers are late"});
  entry.make = [](const rendering::Parameters& parameters, std::shared_ptr<const surface::Surface> surface) {
    rendering::Model model =
        rendering::parse_model(R"({"schema": "touchstone-model/1", "renderer": "god-object"})", "late-god-object");
    model.parameters["stiffness_N_per_m"] = parameters.at("stiffness_N_per_m");
    return std::unique_ptr<rendering::Renderer>(
        std::make_unique<Late>(renderers::make_renderer(model, std::move(surface))));
  };
  entry.make_scene = nullptr;
  return std::make_shared<const rendering::RendererEntry>(entry);
}

// `check` and the scorecard wait for the answers of a renderer that says how late it is; of one that does not say it
// the answers of the moving tip count.
TEST_F(ScoredRenderer, GoldenCasesWaitForAnswersThatAreDeclaredToBeLate) {
  for (const char* const name : {"plane-taps", "sphere-scan"}) {
    ScoreRequest request;
    request.out = folder_.path();
    const auto on_time = score_case(catalogues(), entry_named("god-object"), request, case_named(name));
    const auto declared = score_case(catalogues(), late_by_two(2.0), request, case_named(name));
    EXPECT_EQ(declared.problem, "") << name;
    EXPECT_TRUE(declared.exact) << name << ": " << declared.max_N << " N";
    EXPECT_EQ(declared.max_N, on_time.max_N) << name;
    const auto undeclared = score_case(catalogues(), late_by_two(0.0), request, case_named(name));
    EXPECT_FALSE(undeclared.exact) << name;
    EXPECT_GT(undeclared.max_N, declared.max_N) << name;
  }
}

// Both know only themselves what they take: a fault, or a case.
TEST_F(ScoredRenderer, OnlyAFaultOrACaseCanBeAllowed) {
  ScoreRequest request;
  request.allowed = {"bad-luck"};
  EXPECT_THROW(score("god-object", {plane_taps()}, request), UsageError);
}

}  // namespace
}  // namespace touchstone::golden
