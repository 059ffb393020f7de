// The atlas of tools: its rows are the errors of the exact cases, its picture has a cell for each, and neither depends
// on how the cases were run.
#include "tool_atlas/tool_atlas.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <nlohmann/json.hpp>

#include "contacts/known_contacts.h"
#include "harness/base/error.h"
#include "harness/testing/built_program.h"
#include "tool_atlas/tool_atlas_report.h"
#include "tool_renderers/tool_catalogue.h"

namespace touchstone::tool_atlas {
namespace {

using ::testing::HasSubstr;

const std::atomic<bool> never = false;

ToolAtlasGrid small_tools() {
  ToolAtlasGrid grid;
  grid.renderers = {"god-object-tool", "voxmap-pointshell"};
  grid.contacts = {"box-corner", "peg"};
  grid.sizes = {0.5, 1.0};
  grid.clearances_m = {1e-4, 2e-4, 1e-3};
  grid.stiffnesses_N_per_m = {500, 1000};
  return grid;
}

std::vector<ToolAtlasCase> ran(const ToolAtlasGrid& grid, unsigned threads, std::uint64_t shards = 1) {
  runs::CaseStore store(runs::CaseStore::in_memory, tool_atlas_table(grid));
  for (std::uint64_t k = shards; k >= 1; --k)
    run_cases(tool_atlas_job(grid, tool_renderers::tool_renderer_catalogue()), store, {k, shards}, threads, never);
  return stored_cases(grid, store);
}

std::size_t occurrences(const std::string& text, const std::string& what) {
  std::size_t n = 0;
  for (auto at = text.find(what); at != std::string::npos; at = text.find(what, at + 1)) ++n;
  return n;
}

TEST(ToolAtlas, ACaseIsTheErrorOfItsExactCase) {
  const auto cases = ran(small_tools(), 2);
  ASSERT_EQ(cases.size(), 20U);
  std::size_t compared = 0;
  for (const ToolAtlasCase& own : cases) {
    EXPECT_EQ(own.error, "");
    if (own.renderer == "god-object-tool") {
      EXPECT_LT(own.jnd(), 1e-6) << own.contacts << " " << own.place();
    }
    // The table's own rows, by another way: named cases of usual size behind the usual coupling.
    const std::string name = own.contacts == "box-corner" && own.place() == 1.0 ? "box-corner"
                             : own.contacts == "peg" && own.place() == 1e-4     ? "peg-0.1mm"
                                                                                : "";
    if (name.empty() || own.stiffness_N_per_m != 1000) continue;
    const tool::KnownContacts known = contacts::known_contacts(name, {});
    const auto entries = tool_renderers::tool_renderer_catalogue();
    const auto renderer =
        tool::make_tool_renderer(tool::find_tool_renderer(entries, own.renderer), known.tool, known.object_W, {});
    const tool::ToolErrors errors = tool::errors_of(*renderer, own.renderer, known);
    EXPECT_EQ(own.errors.max_force_N, errors.max_force_N);
    EXPECT_EQ(own.errors.max_torque_jnd, errors.max_torque_jnd);
    EXPECT_EQ(own.jnd(), std::max(errors.max_force_jnd, errors.max_torque_jnd));
    ++compared;
  }
  EXPECT_EQ(compared, 4U);
}

TEST(ToolAtlas, ThePictureHasACellForEachCaseInTheColourOfItsError) {
  const auto cases = ran(small_tools(), 2);
  const std::string svg = tool_atlas_picture(cases);
  std::size_t above_2 = 0, above_1 = 0;
  for (const ToolAtlasCase& own : cases) {
    above_2 += own.jnd() > 2.0 ? 1U : 0U;
    above_1 += own.jnd() > 1.0 && own.jnd() <= 2.0 ? 1U : 0U;
  }
  EXPECT_GT(above_2, 0U) << "voxels of half a millimetre in a hole with 0.1 mm";
  EXPECT_EQ(occurrences(svg, "fill=\"#D55E00\""), above_2);
  EXPECT_EQ(occurrences(svg, "fill=\"#E69F00\""), above_1);
  EXPECT_EQ(occurrences(svg, "fill=\"#DDEEE7\""), cases.size() - above_1 - above_2);
  const auto json = nlohmann::json::parse(tool_atlas_to_json(cases));
  EXPECT_EQ(json.at("cases").size(), cases.size());
  const std::string sentence = tool_atlas_sentence(cases);
  EXPECT_THAT(sentence, HasSubstr("god-object-tool is off by more than a person notices (1 JND) in 0 of 10 cases"));
  EXPECT_THAT(sentence, HasSubstr(fmt::format("in {} of 10 cases, most in peg (", above_1 + above_2)));
}

TEST(ToolAtlas, PartsAndThreadsChangeNothing) {
  ToolAtlasGrid grid = small_tools();
  grid.renderers = {"god-object-tool"};
  EXPECT_EQ(tool_atlas_to_json(ran(grid, 1, 3)), tool_atlas_to_json(ran(grid, 2)));
}

TEST(ToolAtlas, ACaseThatCannotBeRunIsARowWithItsError) {
  ToolAtlasGrid grid = small_tools();
  grid.contacts = {"box-corner", "teapot"};
  grid.renderers = {"god-object-tool"};
  const auto cases = ran(grid, 1);
  ASSERT_EQ(cases.size(), 8U);
  EXPECT_TRUE(cases[0].ran());
  EXPECT_THAT(cases[4].error, HasSubstr("teapot"));
  EXPECT_EQ(occurrences(tool_atlas_picture(cases), ">?</text>"), 4U);
  EXPECT_THAT(tool_atlas_sentence(cases), HasSubstr("in 0 of 4 cases"));
  EXPECT_THAT(tool_atlas_sentence(cases), HasSubstr("4 could not be run"));
  EXPECT_THROW(case_at(grid, 8), std::out_of_range);
}

TEST(ToolAtlas, AnAnswerThatIsNoNumberIsNoticedAndTheWorst) {
  ToolAtlasGrid grid = small_tools();
  grid.renderers = {"god-object-tool"};
  auto cases = ran(grid, 1);
  cases[2].errors.max_force_jnd = std::nan("");
  EXPECT_THAT(tool_atlas_sentence(cases), HasSubstr("(1 JND) in 1 of 10 cases"));
  EXPECT_THAT(tool_atlas_sentence(cases), HasSubstr(": nan JND"));
  EXPECT_EQ(occurrences(tool_atlas_picture(cases), "#D55E00"), 1U);
}

TEST(ToolAtlas, AShapeThatThereIsNotIsRefused) {
  EXPECT_THROW(static_cast<void>(contacts::make_exact_case("box-corner", {1.0, 1e-4})), UsageError);
  EXPECT_THROW(static_cast<void>(contacts::make_exact_case("peg")), UsageError);
  EXPECT_THROW(static_cast<void>(contacts::make_exact_case("box-corner", {0.0, {}})), UsageError);
  EXPECT_THROW(static_cast<void>(contacts::make_exact_case("box-corner", {std::nan(""), {}})), UsageError);
  EXPECT_THROW(static_cast<void>(contacts::make_exact_case("peg", {1.0, -1e-4})), UsageError);
}

class ToolAtlasProgram : public testing::BuiltProgram {};

TEST_F(ToolAtlasProgram, WritesItsFilesAndGoesOnWhereItWas) {
  const std::string asked =
      "tool atlas --renderers god-object-tool --contacts box-corner --sizes 1 --stiffnesses 1000 --out atlas";
  const auto first = run(asked);
  EXPECT_EQ(first.status, 0) << first.err;
  EXPECT_THAT(first.out, HasSubstr("god-object-tool is off by more than a person notices (1 JND) in 0 of 1"));
  for (const char* const name : {"report.html", "tables.md", "atlas.json", "maps.svg", "atlas.sqlite"})
    EXPECT_TRUE(std::filesystem::exists(folder_ / "atlas" / name)) << name;
  EXPECT_THAT(run(asked).err, HasSubstr("0 cases ran, 0 of them failed; 1 were there already"));
  EXPECT_EQ(run("tool atlas --renderers teapot").status, 2);
}

}  // namespace
}  // namespace touchstone::tool_atlas
