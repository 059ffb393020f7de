// A scorecard of a renderer of tools says what is wrong by name, holds a renderer that breaks down, and its page and
// JSON hold the same.
#include "tool_reports/tool_scorecard.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <variant>

#include "contacts/known_contacts.h"
#include "tool_renderers/tool_catalogue.h"

namespace touchstone::tool_reports {
namespace {

const tool::ToolRendererEntry& god_object() {
  return tool::find_tool_renderer(tool_renderers::tool_renderer_catalogue(), "god-object-tool");
}

std::vector<tool::KnownContacts> corner() { return {contacts::known_contacts("box-corner", {})}; }

TEST(ToolScorecard, WhatIsNoNumberIsNotClean) {
  ToolScorecard card;
  EXPECT_TRUE(clean(card));
  card.errors.resize(3);
  card.errors[0].contacts = "small";
  card.errors[1].contacts = "none";
  card.errors[1].max_torque_Nm = card.errors[1].max_torque_jnd = std::nan("");
  card.errors[2].contacts = "large";
  card.errors[2].max_torque_jnd = 5.0;
  EXPECT_FALSE(clean(card));
  EXPECT_THAT(tool_scorecard_to_text(card), ::testing::HasSubstr("nan JND, in none"));
}

// Another renderer's answer with something done to it.
class Changed : public tool::ToolRenderer {
 public:
  Changed(std::unique_ptr<tool::ToolRenderer> inner, bool breaks) : inner_(std::move(inner)), breaks_(breaks) {}

 protected:
  void do_reset() override { inner_->reset(); }
  [[nodiscard]] std::string do_failure() const override { return "it fell over"; }
  tool::ToolResult do_step(const tool::ToolState& state, double /*dt_s*/) noexcept override {
    tool::ToolResult result = inner_->step(state);
    result.torque_W_Nm = -result.torque_W_Nm;
    if (breaks_ && result.contact) result.status = tool::ToolStatus::failed;
    return result;
  }

 private:
  std::unique_ptr<tool::ToolRenderer> inner_;
  bool breaks_;
};

tool::ToolRendererEntry changed(bool breaks) {
  tool::ToolRendererEntry entry = god_object();
  entry.name = "changed";
  entry.make = [breaks](const rendering::Parameters& parameters, const tool::Tool& tool,
                        const surface::TriangleMesh& object_W,
                        const tool::Coupling& coupling) -> std::unique_ptr<tool::ToolRenderer> {
    return std::make_unique<Changed>(god_object().make(parameters, tool, object_W, coupling), breaks);
  };
  return entry;
}

TEST(ToolScorecard, OfARendererThatIsRight) {
  const ToolScorecard card = score_tool(god_object(), {}, corner(), true);
  EXPECT_TRUE(clean(card)) << tool_scorecard_to_text(card);
  ASSERT_EQ(card.errors.size(), 1U);
  EXPECT_LE(card.errors[0].max_torque_Nm, 1e-9);
  ASSERT_TRUE(card.cost.has_value());
  EXPECT_GT(card.cost->steps, 3000U);
  EXPECT_GT(card.cost->contacts, 0.5);
  const auto json = nlohmann::json::parse(tool_scorecard_to_json(card));
  EXPECT_TRUE(json["clean"].get<bool>());
  EXPECT_EQ(json["checks"].size(), card.findings.size());
  EXPECT_EQ(json["cases"][0]["name"], "box-corner");
  EXPECT_EQ(json["cost"]["steps"].get<std::size_t>(), card.cost->steps);
}

TEST(ToolScorecard, AFaultIsNamed) {
  const ToolScorecard card = score_tool(changed(false), {}, corner(), false);
  EXPECT_FALSE(clean(card));
  EXPECT_THAT(tool_scorecard_to_text(card), ::testing::HasSubstr("torque-sign"));
  EXPECT_GT(card.errors[0].max_torque_jnd, 1.0);
  const std::array<ToolScorecard, 2> both{score_tool(god_object(), {}, {}, false), card};
  const report::Page page = tool_scorecard_page(both, {});
  EXPECT_THAT(page.subtitle, ::testing::HasSubstr("1 of 2 renderers"));
  const auto& table = std::get<report::Table>(page.sections[0].blocks[0]);
  ASSERT_EQ(table.columns, (std::vector<std::string>{"check", "god-object-tool", "changed"}));
  ASSERT_EQ(table.rows.size(), card.findings.size());
  EXPECT_THAT(table.rows[0].cells[1].text, ::testing::StartsWith("ok"));
  EXPECT_THAT(table.rows[0].cells[2].text, ::testing::StartsWith("WRONG, torque-sign"));
}

TEST(ToolScorecard, ARendererThatBreaksDownIsAProblemInTheCard) {
  const ToolScorecard card = score_tool(changed(true), {}, corner(), true);
  EXPECT_FALSE(clean(card));
  ASSERT_EQ(card.problems.size(), 3U) << "checks, case, timing";
  EXPECT_EQ(card.problems[1].contacts, "box-corner");
  EXPECT_THAT(card.problems[1].what, ::testing::HasSubstr("it fell over"));
  EXPECT_FALSE(card.cost.has_value());
  EXPECT_THAT(tool_scorecard_to_text(card), ::testing::HasSubstr("it fell over"));
}

}  // namespace
}  // namespace touchstone::tool_reports
