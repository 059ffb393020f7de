#include "harness/renderer_faults/scorecard.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <nlohmann/json.hpp>

#include "harness/renderer_faults/entry_engine.h"
#include "renderers/catalogue.h"

namespace touchstone::renderer_faults {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

Scorecard a_card() {
  Scorecard card;
  card.engine = "mine";
  card.cases_wanted = true;
  card.summary = "F < k & d";
  card.diagnosis.findings.push_back(
      {"delay", "one sample late", "a block", 1.0, "samples", "", {{"filter", "it leaves 40 %"}}});
  card.diagnosis.clean = {"noise"};
  card.diagnosis.declared = {{"standoff", "it rounds"}};
  card.diagnosis.failed = {{"allocation", "no memory"}};
  const auto add = [&](const std::string& name, const std::string& shape) -> CaseScore& {
    card.cases.emplace_back();
    card.cases.back().name = name;
    card.cases.back().shape = shape;
    return card.cases.back();
  };
  CaseScore& scan = add("sphere-scan", "sphere");
  scan.reference = "exact";
  scan.samples = 1000;
  scan.mean_N = 0.01;
  scan.rms_N = 0.1;
  scan.max_N = 0.2;
  scan.jump_N = 0.05;
  scan.right_N = 2.0;
  scan.max_jnd = 0.5;
  scan.felt = true;
  CaseScore& crashed = add("torus-spiral", "torus");
  crashed.problem = "it crashed";
  crashed.exact = crashed.felt = true;
  CaseScore& inside = add("plane-stroke", "plane");
  inside.problem = "it starts inside";
  inside.skipped = true;
  return card;
}

TEST(Scorecard, TheJsonHasEveryVerdictAndWhatToFixFirst) {
  const auto json = nlohmann::json::parse(scorecard_to_json(a_card()));
  EXPECT_EQ(json["schema"], "touchstone-scorecard/1");
  EXPECT_EQ(json["fix_first"], "delay");
  EXPECT_EQ(json["findings"][0]["unit"], "samples");
  EXPECT_EQ(json["findings"][0]["considered"][0]["name"], "filter");
  EXPECT_THAT(scorecard_to_text(a_card()), HasSubstr("considered too: filter (it leaves 40 %)"));
  EXPECT_THAT(scorecard_to_html({a_card()}), HasSubstr("considered too: filter (it leaves 40 %)"));
  EXPECT_EQ(json["declared"][0]["reason"], "it rounds");
  EXPECT_EQ(json["could_not_run"][0]["name"], "allocation");
  EXPECT_EQ(json["passed"]["cases"], 3);
  EXPECT_EQ(json["passed"]["skipped"], 1);
  EXPECT_EQ(json["passed"]["felt"], 1) << "a case that could not run passes nothing";
  EXPECT_EQ(json["passed"]["exact"], 0);
  EXPECT_EQ(json["cases"][0]["force_jump_N"], 0.05);
  EXPECT_EQ(json["cases"][1]["problem"], "it crashed");
  EXPECT_TRUE(json["cost"].is_null());
}

// A second case of the shape, a hundred times as large and long: the mean is of all samples, the rest of the worst
// case.
// Found is found: a fault, an error that a hand would notice, what could not run.
TEST(Scorecard, OnlyWhatIsAllowedDoesNotCount) {
  Scorecard card = a_card();
  card.cases_wanted = true;
  EXPECT_EQ(verdict_of(card), CardVerdict::failed);
  card.allowed = {"delay", "allocation", "torus-spiral"};
  EXPECT_EQ(verdict_of(card), CardVerdict::passed) << scorecard_to_text(card);
  EXPECT_EQ(nlohmann::json::parse(scorecard_to_json(card))["fix_first"], "");
  card.cases.front().felt = false;
  EXPECT_EQ(verdict_of(card), CardVerdict::failed);
  EXPECT_EQ(nlohmann::json::parse(scorecard_to_json(card))["fix_first"], "case sphere-scan");
  card.allowed.push_back("sphere-scan");
  EXPECT_EQ(verdict_of(card), CardVerdict::passed);
  card.allowed.push_back("noise");
  EXPECT_THAT(scorecard_to_text(card), HasSubstr("allowed and not found: noise"));
}

// Causes first, with what follows below them; what is allowed takes along what follows from it.
TEST(Scorecard, WhatFollowsStandsBelowItsCause) {
  Scorecard card;
  card.engine = "mine";
  card.diagnosis.findings = {{"held-answer", "62.5 Hz", "a block", 16.0, "samples"},
                             {"hysteresis", "5 % less", "a block", 0.05, "1"},
                             {"standoff", "touches nothing", "a block", 0.0, "m", "held-answer"}};
  card.diagnosis.said = {{"late-contact", "within its epsilon", "a block", 1e-5, "m"}};
  const std::string text = scorecard_to_text(card);
  EXPECT_THAT(text, HasSubstr("mine: 2 faults found"));
  EXPECT_THAT(text, HasSubstr("  held-answer: 62.5 Hz\n    follows from it: standoff: touches nothing\n  hysteresis:"));
  EXPECT_THAT(text, HasSubstr("said, late-contact: within its epsilon"));
  const auto json = nlohmann::json::parse(scorecard_to_json(card));
  EXPECT_EQ(json["findings"][2]["follows_from"], "held-answer");
  EXPECT_EQ(json["said"][0]["name"], "late-contact");
  EXPECT_THAT(scorecard_to_html({card}), HasSubstr("follows from held-answer"));
  card.allowed = {"held-answer"};
  EXPECT_EQ(verdict_of(card), CardVerdict::failed);
  card.allowed.push_back("hysteresis");
  EXPECT_EQ(verdict_of(card), CardVerdict::passed) << text;
}

// Nothing ran: neither green nor red. Without cases the diagnosis alone decides.
TEST(Scorecard, WhereEveryCaseIsSkippedNothingIsKnown) {
  Scorecard card;
  card.cases_wanted = true;
  EXPECT_EQ(verdict_of(card), CardVerdict::skipped);
  card.cases = {a_card().cases.back()};
  ASSERT_TRUE(card.cases.front().skipped);
  EXPECT_EQ(verdict_of(card), CardVerdict::skipped);
  EXPECT_THAT(scorecard_to_text(card), HasSubstr("no golden case ran"));
  card.diagnosis.findings = a_card().diagnosis.findings;
  EXPECT_EQ(verdict_of(card), CardVerdict::failed);
  card.cases_wanted = false;
  EXPECT_EQ(verdict_of(card), CardVerdict::failed);
  card.diagnosis.findings.clear();
  EXPECT_EQ(verdict_of(card), CardVerdict::passed);
}

TEST(Scorecard, TheTableOfShapesHasErrorsAsSharesOfTheRightForce) {
  Scorecard card = a_card();
  CaseScore large = card.cases.front();
  large.samples = 3000;
  large.mean_N = 0.2;
  large.max_N = 4.0;
  large.jump_N = 8.0;
  large.right_N = 200.0;
  card.cases.push_back(large);
  Scorecard without;
  without.engine = "other";
  const std::string table = scorecard_to_markdown({card, without});
  EXPECT_THAT(table, HasSubstr("| shape | mine | other |\n|---|---|---|\n"));
  EXPECT_THAT(table, HasSubstr("| sphere | 0.2 / 10 / 4 | |\n")) << table;
  EXPECT_THAT(table, HasSubstr("| torus | could not run | |\n"));
  EXPECT_THAT(table, HasSubstr("| plane | skipped | |\n"));
  EXPECT_THAT(table, HasSubstr("| faults | delay | none |\n"));
}

TEST(Scorecard, TheTableOfShapesHasNoExponents) {
  Scorecard card = a_card();
  card.cases.front().mean_N = 1e-17;
  card.cases.front().max_N = 2.468;
  card.cases.front().jump_N = 0.0;
  EXPECT_THAT(scorecard_to_markdown({card}), HasSubstr("| sphere | <0.001 / 123 / 0 |"));
}

TEST(Scorecard, AnErrorThatIsNoNumberIsNotZeroInTheTable) {
  Scorecard card = a_card();
  card.cases.front().mean_N = std::numeric_limits<double>::quiet_NaN();
  card.cases.front().jump_N = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(scorecard_to_markdown({card}), HasSubstr("| sphere | nan / 10 / nan |"));
}

TEST(Scorecard, ThePageShowsEveryDetectorForEveryEngine) {
  const std::string page = scorecard_to_html({a_card(), a_card()});
  for (const Detector& detector : detectors()) EXPECT_THAT(page, HasSubstr(detector.name));
  EXPECT_THAT(page, HasSubstr("F &lt; k &amp; d"));
  EXPECT_THAT(page, HasSubstr("it crashed"));
  EXPECT_THAT(page, Not(HasSubstr("<script")));
  EXPECT_THAT(scorecard_to_text(a_card()), HasSubstr("fix first: delay"));
  EXPECT_THAT(scorecard_to_text(a_card()), HasSubstr("golden cases: 0 of 2 exact, 1 felt (within 1 JND), 1 skipped"));
}

TEST(Scorecard, CostIsMeasuredOverABallOfTheSizeAskedFor) {
  const rendering::RendererEntry& entry = renderers::find_renderer(
      rendering::parse_model(R"({"schema": "touchstone-model/1", "renderer": "god-object"})", ""));
  const CostScore cost = measure_cost(touchstone::renderer_faults::engine_of(entry, {}), 3);
  EXPECT_EQ(cost.triangles, 512U);
  EXPECT_EQ(cost.steps, 20'000U);
  EXPECT_GT(cost.median_us, 0.0);
  EXPECT_LE(cost.median_us, cost.p99_us);
  EXPECT_LE(cost.p99_us, cost.p999_us);
}

TEST(EntryEngine, AnEpsilonThatTheEntryDeclaresIsTaken) {
  rendering::RendererEntry entry;
  entry.name = "mine";
  entry.parameters = {{"stiffness_N_per_m", "N/m", 1.0, 1e4, 300.0, ""}, {"epsilon_m", "m", 0.0, 1.0, 1e-6, ""}};
  EXPECT_EQ(touchstone::renderer_faults::engine_of(entry, {}).epsilon_m, 1e-6);
  EXPECT_EQ(touchstone::renderer_faults::engine_of(entry, {}).stiffness_N_per_m, 300.0);
  EngineFacts facts;
  facts.epsilon_m = 1e-5;
  EXPECT_EQ(touchstone::renderer_faults::engine_of(entry, facts).epsilon_m, 1e-5);
  // Without such a parameter, what the entry declares.
  entry.parameters.pop_back();
  entry.epsilon_m = 3e-7;
  EXPECT_EQ(touchstone::renderer_faults::engine_of(entry, {}).epsilon_m, 3e-7);
}

TEST(EntryEngine, ALagThatTheEntryDeclaresIsTaken) {
  touchstone::rendering::RendererEntry entry;
  entry.name = "mine";
  entry.parameters = {{"stiffness_N_per_m", "N/m", 1.0, 1e4, 300.0, ""}, {"lag_samples", "1", 0.0, 4.0, 1.0, ""}};
  EXPECT_EQ(touchstone::renderer_faults::engine_of(entry, {}).lag_samples, 1);
  entry.parameters.pop_back();
  EXPECT_EQ(touchstone::renderer_faults::engine_of(entry, {}).lag_samples, 0);
}

}  // namespace
}  // namespace touchstone::renderer_faults
