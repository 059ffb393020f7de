// Each gate alone decides, under its code, and findings.json says by what number.
#include "harness/discrepancy/verdict_gates.h"

#include <gmock/gmock.h>

#include <functional>
#include <limits>
#include <nlohmann/json.hpp>
#include <set>

#include "harness/discrepancy/findings.h"

namespace touchstone::discrepancy {
namespace {

// A search that found what was missing, and passes every gate.
Findings passing() {
  Findings f;
  f.gap.holdout_before_N = 0.40;
  f.gap.holdout_after_N = 0.10;
  f.search.goodness = 1.0;
  f.search.goodness_threshold = 1.5;
  f.search.structured_threshold = 1.2;
  f.search.found.emplace_back().name = "coulomb-friction";
  return f;
}

struct Fails {
  std::string code;
  std::function<void(Findings&)> spoil;
};

const std::vector<Fails>& failures() {
  static const std::vector<Fails> all{
      {"data-fault", [](Findings& f) { f.search.data_fault = "the force pulls."; }},
      {"line-left",
       [](Findings& f) {
         f.search.spectrum.peaks.emplace_back().name = "mains hum";
         f.search.spectrum.share = 0.5;
       }},
      {"noise-exceeded", [](Findings& f) { f.search.goodness = 1.6; }},
      {"structure-left",
       [](Findings& f) {
         f.search.goodness = 1.3;
         f.search.structure = {"depth", 50.0, 0.3, 0.1};
       }},
      {"fast-residual",
       [](Findings& f) {
         f.search.spectrum.raw_N = 0.3;
         f.search.spectrum.null_N = 0.1;
       }},
      {"law-holds",
       [](Findings& f) {
         f.search.law.pieces.emplace_back();
         f.search.law_share = 0.4;
         f.search.law_gain = 90.0;
         f.search.law_error = 10.0;
       }},
      {"indistinguishable",
       [](Findings& f) {
         Rival& rival = f.search.found.front().rivals.emplace_back();
         rival.name = "viscous-friction";
         rival.indistinguishable = true;
       }},
      {"error-rises", [](Findings& f) { f.gap.holdout_after_N = 0.41; }},
      {"value-questioned",
       [](Findings& f) {
         f.search.questions = {{"coulomb-friction", "it is large"}};
       }},
  };
  return all;
}

TEST(VerdictGates, AllPassedIsExplainedOrConsistent) {
  Findings explained = passing();
  conclude(explained, {});
  EXPECT_EQ(explained.code, "effects-explain");
  EXPECT_EQ(explained.verdict, FindingsVerdict::explained);
  Findings consistent = passing();
  consistent.search.found.clear();
  conclude(consistent, {});
  EXPECT_EQ(consistent.code, "nothing-missing");
  EXPECT_EQ(consistent.verdict, FindingsVerdict::consistent);
  for (const VerdictGate& gate : consistent.gates) EXPECT_TRUE(gate.passed) << gate.code;
}

TEST(VerdictGates, EachAloneDecidesUnderItsCode) {
  std::set<std::string_view> tried{"repeat-exceeded"};
  for (const Fails& one : failures()) {
    Findings f = passing();
    one.spoil(f);
    conclude(f, {});
    EXPECT_EQ(f.code, one.code);
    EXPECT_EQ(f.verdict,
              one.code == "indistinguishable" ? FindingsVerdict::not_identifiable : FindingsVerdict::unexplained);
    for (const VerdictGate& gate : f.gates) {
      EXPECT_EQ(gate.passed, gate.code != one.code) << one.code << ": " << gate.code;
      if (gate.code == one.code) {
        EXPECT_GT(gate.value, gate.limit) << gate.code;
      }
    }
    tried.insert(f.code);
  }
  for (const VerdictGate& gate : verdict_gates(passing())) EXPECT_TRUE(tried.contains(gate.code)) << gate.code;
}

// What the user calls good enough acquits of all but wrong data and effects that cannot be told apart; what a fingertip
// does not notice does so only where that was asked for.
TEST(VerdictGates, AToleranceAcquitsAndNeverAccuses) {
  const std::set<std::string> stays{"data-fault", "indistinguishable"};
  for (const Fails& one : failures()) {
    const auto judged = [&](auto set) {
      Findings f = passing();
      one.spoil(f);
      set(f.gap);
      conclude(f, {});
      return f;
    };
    const bool may = !stays.contains(one.code);
    const Findings within = judged([](ForceGap& gap) { gap.tolerance_N = 0.5; });
    EXPECT_EQ(within.code, may ? "within-tolerance" : one.code);
    EXPECT_EQ(within.verdict == FindingsVerdict::explained, may) << one.code;
    EXPECT_EQ(judged([](ForceGap& gap) { gap.tolerance_N = 0.01; }).code, one.code);
    EXPECT_EQ(judged([](ForceGap& gap) { gap.left_jnd = 0.3; }).code, one.code) << "said, not asked for";
    const auto asked = [](double jnd) {
      return [jnd](ForceGap& gap) { gap.left_jnd = jnd, gap.unnoticed_passes = true; };
    };
    EXPECT_EQ(judged(asked(0.3)).code, may ? "not-noticed" : one.code);
    EXPECT_EQ(judged(asked(1.3)).code, one.code);
    EXPECT_EQ(judged(asked(std::numeric_limits<double>::quiet_NaN())).code, one.code);
    // What a floor acquits of hides nothing that it does not.
    Findings both = passing();
    one.spoil(both);
    failures()[6].spoil(both);
    both.gap.tolerance_N = both.gap.repeat_floor_N = 0.5;
    conclude(both, {});
    EXPECT_EQ(both.code, one.code == "data-fault" ? one.code : failures()[6].code);
  }
  Findings beyond = passing();
  beyond.gap.tolerance_N = 0.01;
  beyond.gap.left_jnd = 4.0;
  conclude(beyond, {});
  EXPECT_EQ(beyond.code, "effects-explain") << "noise leaves no less";
}

TEST(VerdictGates, WhatIsLeftIsSaidBesideEachFloor) {
  Findings f = passing();
  f.search.goodness = 9.0;
  f.gap.left_jnd = 0.3;
  conclude(f, {});
  EXPECT_THAT(f.explanation,
              ::testing::HasSubstr("What is left is 0.3 of what a fingertip just notices at these forces "
                                   "(RMS over the samples); if that is good enough, search with "
                                   "--tolerance noticed."));
  f = passing();
  f.search.goodness = 9.0;
  f.gap.tolerance_N = 0.5;
  conclude(f, {});
  EXPECT_THAT(f.explanation, ::testing::HasSubstr("no more is left than the tolerance allows"));
  EXPECT_THAT(f.explanation, ::testing::HasSubstr("is within the tolerance of 0.5 N"));
  const auto json = nlohmann::json::parse(findings_to_json(f, ""));
  EXPECT_EQ(json.at("gap").at("tolerance"), 0.5);
  EXPECT_EQ(json.at("gates").back().at("code"), "tolerance-exceeded");
}

// Of two the earlier, and a repeat acquits of what noise alone accuses, and of nothing else.
TEST(VerdictGates, TheFirstDecidesAndARepeatAcquits) {
  const std::set<std::string> stays{"data-fault", "line-left", "indistinguishable", "value-questioned"};
  for (std::size_t i = 0; i < failures().size(); ++i) {
    Findings f = passing();
    failures()[i].spoil(f);
    f.gap.repeat_floor_N = 0.5;
    conclude(f, {});
    const bool acquitted = !stays.contains(failures()[i].code);
    EXPECT_EQ(f.code, acquitted ? "within-repeat" : failures()[i].code);
    EXPECT_EQ(f.verdict == FindingsVerdict::explained, acquitted) << failures()[i].code;
    Findings two = passing();
    for (std::size_t k = failures().size(); k-- > i;) failures()[k].spoil(two);
    conclude(two, {});
    EXPECT_EQ(two.code, failures()[i].code);
  }
}

TEST(VerdictGates, FindingsSayByWhatNumber) {
  Findings f = passing();
  f.search.goodness = 1.6;
  conclude(f, {});
  const auto json = nlohmann::json::parse(findings_to_json(f, ""));
  EXPECT_EQ(json.at("code"), "noise-exceeded");
  const auto& gate = json.at("gates").at(2);
  EXPECT_EQ(gate.at("code"), "noise-exceeded");
  EXPECT_EQ(gate.at("value"), 1.6);
  EXPECT_EQ(gate.at("limit"), 1.5);
  EXPECT_FALSE(gate.at("passed"));
}

}  // namespace
}  // namespace touchstone::discrepancy
