// The atlas as cases: what it says does not depend on how, where and in how many goes they were run.
#include "atlas/atlas_cases.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "atlas/atlas_report.h"
#include "harness/report/page_html.h"
#include "harness/report/page_markdown.h"
#include "harness/testing/built_program.h"

namespace touchstone::atlas {
namespace {

using ::testing::HasSubstr;

const std::atomic<bool> never = false;

AtlasGrid small_grid() {
  AtlasGrid grid;
  grid.renderers = {"god-object", "penalty"};
  grid.side_angles_rad = {0.6, 1.4};
  grid.thicknesses_m = {1e-4};
  grid.stiffnesses_N_per_m = {200, 1600};
  grid.mus = {0.0, 0.5};
  return grid;
}

// Everything that is made of the rows.
std::string all_of_the_report(const AtlasGrid& grid, const runs::CaseStore& store) {
  const auto cases = stored_cases(grid, store);
  const report::Page page = atlas_page(cases, {});
  return atlas_table(cases) + atlas_to_json(cases) + atlas_picture(cases, Scene::bump) +
         atlas_picture(cases, Scene::shell) + page_to_html(page) + tables_to_markdown(page);
}

void run(const AtlasGrid& grid, runs::CaseStore& store, runs::CaseShard shard, unsigned threads) {
  AtlasWorld world(grid);
  store.start_run({});
  runs::run_cases(atlas_job(grid, world), store, shard, threads, never);
}

TEST(AtlasGrid, EveryCombinationHasOneNumberInTheOrderOfTheMaps) {
  const AtlasGrid grid = small_grid();
  ASSERT_EQ(case_count(grid), 24U);
  std::set<std::string> seen;
  for (std::uint64_t n = 0; n < case_count(grid); ++n) seen.insert(describe_case(grid, n));
  EXPECT_EQ(seen.size(), 24U);
  EXPECT_EQ(describe_case(grid, 0),
            R"({"scene":"bump","renderer":"god-object","side_angle_rad":0.6,"stiffness_N_per_m":200.0,"mu":0.0})");
  EXPECT_EQ(describe_case(grid, 23),
            R"({"scene":"shell","renderer":"penalty","thickness_m":0.0001,"stiffness_N_per_m":1600.0,"mu":0.5})");
  EXPECT_THROW(case_at(grid, 24), std::out_of_range);
}

TEST(AtlasCases, TheReportIsTheSameFromAnyThreadsPartsAndGoes) {
  const AtlasGrid grid = small_grid();
  const runs::CaseTable table = atlas_case_table(grid);
  runs::CaseStore whole(runs::CaseStore::in_memory, table);
  run(grid, whole, {}, 1);
  const std::string report = all_of_the_report(grid, whole);
  EXPECT_THAT(report, HasSubstr("penalty"));
  for (const unsigned threads : {1U, 4U}) {
    runs::CaseStore parts(runs::CaseStore::in_memory, table);
    for (const std::uint64_t k : {3U, 1U, 2U}) run(grid, parts, {k, 3}, threads);
    EXPECT_EQ(all_of_the_report(grid, parts), report);
    EXPECT_EQ(parts.content_hash(), whole.content_hash());
  }
  for (const AtlasCase& own : stored_cases(grid, whole)) {
    const auto alone = run_case(own.scene, own.renderer, own.sharpness, own.stiffness_N_per_m, own.mu);
    EXPECT_EQ(letters(alone.found), letters(own.found));
    EXPECT_EQ(alone.found.largest_lag_m, own.found.largest_lag_m);
  }
}

TEST(AtlasCases, ACaseThatCannotBeRunIsARowWithItsErrorAndIsSeenInEveryReport) {
  AtlasGrid grid = small_grid();
  grid.stiffnesses_N_per_m = {200, -1};  // the renderers refuse
  runs::CaseStore store(runs::CaseStore::in_memory, atlas_case_table(grid));
  run(grid, store, {}, 2);
  const auto cases = stored_cases(grid, store);
  ASSERT_EQ(cases.size(), 24U);
  EXPECT_EQ(failed_cases(cases), 12U);
  EXPECT_EQ(store.failed(), 12U);
  for (const AtlasCase& own : cases) {
    EXPECT_EQ(letters(own) == "?", own.stiffness_N_per_m < 0.0);
    if (own.stiffness_N_per_m < 0.0) {
      EXPECT_THAT(own.error, HasSubstr("stiffness_N_per_m"));
    }
  }
  EXPECT_THAT(atlas_table(cases), HasSubstr("failed to run"));
  EXPECT_THAT(atlas_to_json(cases), HasSubstr("\"error\""));
  EXPECT_THAT(atlas_to_json(cases), HasSubstr("\"faults\": \""));
  EXPECT_THAT(atlas_picture(cases, Scene::bump), HasSubstr(">?</text>"));
  EXPECT_THAT(page_to_html(atlas_page(cases, {})), HasSubstr("Cases that could not be run"));
}

TEST(AtlasCases, OnlyTheSameGridIsTheSameFile) {
  std::set<std::string> known;
  AtlasGrid grid = small_grid();
  const auto is_new = [&] { return known.insert(atlas_case_table(grid).specification).second; };
  EXPECT_TRUE(is_new());
  EXPECT_FALSE(is_new());
  grid.force_N = std::nextafter(1.5, 2.0);
  EXPECT_TRUE(is_new());
  grid.mus = {0.5, 0.0};
  EXPECT_TRUE(is_new());
  grid.thicknesses_m = {};
  EXPECT_TRUE(is_new());
  EXPECT_EQ(case_count(grid), 16U);
}

const std::string asked =
    "atlas --renderers god-object,voxel --angles 0.4,1.2 --thicknesses 0.001 --stiffnesses 200,800,1600 --mus 0,0.5 ";

class AtlasProgram : public testing::BuiltProgram {
 protected:
  [[nodiscard]] std::string read(const std::string& name) const { return read_file(folder_ / name); }
  void expect_same_files(const std::string& one, const std::string& other) const {
    for (const char* const name : {"/atlas.json", "/bump.svg", "/shell.svg"})
      EXPECT_EQ(read(one + name), read(other + name));
    const auto tables = [&](const std::string& folder) {
      const std::string text = read(folder + "/tables.md");
      return text.substr(0, text.find("### Inputs"));  // the last: where the rows stand
    };
    EXPECT_EQ(tables(one), tables(other));
    EXPECT_THAT(tables(one), HasSubstr("pops through"));
  }
};

TEST_F(AtlasProgram, PartsMergedAndARunThatWasKilledGiveTheFilesOfOneGo) {
  ASSERT_EQ(run(asked + "--out whole --threads 1").status, 0);
  for (const char* const k : {"1", "2"})
    ASSERT_EQ(run(fmt::format("{} --cases {}.sqlite --shard {}/2", asked, k, k)).status, 0);
  const auto half = run(asked + "--merge 1.sqlite --cases half.sqlite --out half");
  EXPECT_EQ(half.status, 1);
  EXPECT_THAT(half.out, HasSubstr("18 cases are missing: 18 19"));
  const auto merged = run(asked + "--merge 2.sqlite 1.sqlite --out merged");
  EXPECT_EQ(merged.status, 0) << merged.err;
  expect_same_files("whole", "merged");
  // Killed wherever it is then.
  testing::run_command(
      fmt::format("sh -c \"'{}' {} --out killed & sleep 0.3; kill -9 \\$!; wait; true\"", program_, asked), folder_);
  const auto again = run(asked + "--out killed");
  EXPECT_EQ(again.status, 0) << again.err;
  expect_same_files("whole", "killed");
  const auto there = run(asked + "--out killed");
  EXPECT_EQ(there.status, 0);
  EXPECT_THAT(there.err, HasSubstr("0 cases ran, 0 of them failed; 36 were there already"));
}

TEST_F(AtlasProgram, AnotherGridIsRefusedWithWhatToDo) {
  const std::string one = "atlas --renderers penalty --angles 0.4 --thicknesses 0.001 --stiffnesses 800 --out atlas ";
  ASSERT_EQ(run(one + "--mus 0").status, 0);
  const std::string before = read("atlas/atlas.json");
  const auto other = run(one + "--mus 0.5");
  EXPECT_EQ(other.status, 3);
  EXPECT_THAT(other.err, HasSubstr("atlas/atlas.sqlite: holds the results of another grid; give another --cases"));
  EXPECT_EQ(read("atlas/atlas.json"), before);
}

TEST_F(AtlasProgram, ItsSlurmScriptAsksForTheSameGrid) {
  const auto shown = run(asked + "--out atlas --engine slurm --tasks 3 --threads 2 --dry-run");
  ASSERT_EQ(shown.status, 0) << shown.err;
  EXPECT_THAT(shown.out, HasSubstr("#SBATCH --array=1-3\n"));
  EXPECT_THAT(
      shown.out,
      HasSubstr("atlas --renderers god-object,voxel --angles 0.4,1.2 --thicknesses 0.001 --stiffnesses "
                "200,800,1600 --mus 0,0.5 --force 1.5 --shard \"$SLURM_ARRAY_TASK_ID/3\" --threads 2 --cases "));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "atlas"));
  EXPECT_EQ(run(asked + "--engine slurm --dry-run").status, 2);
}

}  // namespace
}  // namespace touchstone::atlas
