#include "experiments/seed_cases.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "experiments/seeded_experiments.h"
#include "harness/base/error.h"
#include "harness/testing/built_program.h"

namespace touchstone::experiments {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

const std::atomic<bool> never = false;

// An error that shrinks with the seed; there is none for a seed that 5 divides, and 13 cannot be run.
SeededExperiment toy(std::uint64_t seeds) {
  SeededExperiment own;
  own.name = "toy";
  own.settings = "{}";
  own.first_seed = 4;
  own.seeds = seeds;
  own.values = {"error [N]", "lag [m]"};
  own.findings = {"small", "quick"};
  own.timed_finding = 1;
  own.run = [](std::uint64_t number, const runs::PartDone&) {
    const std::uint64_t seed = 4 + number;
    if (seed == 13) throw BadData("an unlucky seed");
    return SeedResult{{seed % 5 == 0 ? std::nan("") : 1.0 / static_cast<double>(seed), 0.1},
                      {seed > 6, seed % 2 == 0},
                      "{\"seed\":" + std::to_string(seed) + "}",
                      "{}"};
  };
  return own;
}

void run(const SeededExperiment& experiment, runs::CaseStore& store, runs::CaseShard shard, unsigned threads) {
  store.start_run({});
  runs::run_cases(seed_job(experiment), store, shard, threads, never);
}

TEST(SeedCases, TheSpreadIsTheSameFromAnyThreadsAndParts) {
  const SeededExperiment experiment = toy(9);
  runs::CaseStore whole(runs::CaseStore::in_memory, seed_table(experiment));
  run(experiment, whole, {}, 1);
  const auto seeds = stored_seeds(experiment, whole);
  ASSERT_EQ(seeds.size(), 9U);
  EXPECT_EQ(seeds[3].result.values[0], 1.0 / 7.0);
  EXPECT_TRUE(std::isnan(seeds[1].result.values[0]));
  EXPECT_EQ(seeds[8].result.document, "{\"seed\":12}");
  EXPECT_THAT(seeds[3].result.findings, ElementsAre(true, false));
  const std::string table = spread_table(stored_spread(experiment, seeds));
  EXPECT_THAT(table, HasSubstr("Over 9 seeds"));
  runs::CaseStore parts(runs::CaseStore::in_memory, seed_table(experiment));
  for (const std::uint64_t k : {2U, 1U}) run(experiment, parts, {k, 2}, 3);
  EXPECT_EQ(spread_table(stored_spread(experiment, stored_seeds(experiment, parts))), table);
  EXPECT_EQ(parts.content_hash(), whole.content_hash());
}

TEST(SeedCases, MoreSeedsGoOnAndOneThatFailsIsCountedNowhere) {
  runs::CaseStore store(runs::CaseStore::in_memory, seed_table(toy(3)));
  run(toy(3), store, {}, 1);
  store.start_run({});
  EXPECT_EQ(runs::run_cases(seed_job(toy(11)), store, {}, 2, never).before, 3U);
  const auto seeds = stored_seeds(toy(11), store);
  ASSERT_EQ(seeds.size(), 11U);
  EXPECT_EQ(seeds[9].error, "an unlucky seed");
  const SeedSpread spread = stored_spread(toy(11), seeds, {{1}, {0}});
  ASSERT_EQ(spread.values.size(), 1U);
  EXPECT_EQ(spread.values[0].name, "lag [m]");
  EXPECT_EQ(spread.values[0].of_seed.size(), 10U);
  EXPECT_EQ(spread.findings[0].held.size(), 10U);
  EXPECT_EQ(stored_seeds(toy(2), store).size(), 2U);
}

TEST(SeedCases, TheNumberOfSeedsIsNoPartOfWhatTheFileIsAboutButAllElseIs) {
  std::set<std::string> known;
  SeededExperiment own = toy(3);
  const auto is_new = [&] { return known.insert(seed_table(own).specification).second; };
  EXPECT_TRUE(is_new());
  own.seeds = 30;
  EXPECT_FALSE(is_new());
  own.first_seed = 5;
  EXPECT_TRUE(is_new());
  own.settings = "{\"triangles\":7}";
  EXPECT_TRUE(is_new());
  own.name = "other";
  EXPECT_TRUE(is_new());
}

// Names and statements stand before anything is run, and are as many as there are columns.
TEST(SeededExperiments, HaveColumnsOfTheirOwnAndWordsThatAskForThem) {
  for (const SeededExperiment& own : {seeded_voxel({}, 5), seeded_friction(1, 5), seeded_density(1, 5, false),
                                      seeded_density(1, 5, true), seeded_springs(1, 5)}) {
    const runs::CaseStore store(runs::CaseStore::in_memory, seed_table(own));  // refuses a column that stands twice
    EXPECT_GE(own.values.size(), 15U) << own.name;
    EXPECT_GE(own.findings.size(), 2U) << own.name;
    EXPECT_EQ(own.words[0], "experiment");
    EXPECT_THAT(own.words, ::testing::Contains("5")) << own.name;
    for (const std::string& finding : own.findings) EXPECT_THAT(finding, ::testing::Not(HasSubstr("nan"))) << own.name;
  }
  const SeededExperiment both = seeded_density(1, 2, false);
  EXPECT_EQ(seed_table(both).specification, seed_table(seeded_density(1, 2, true)).specification);
  for (const std::size_t v : density_part(false).values) EXPECT_THAT(both.values.at(v), HasSubstr("proxy"));
  EXPECT_EQ(density_part(true).values.size(), both.values.size());
  EXPECT_EQ(density_part(false).findings.size() + density_part(true).findings.size(), both.findings.size());
  EXPECT_THAT(seeded_voxel({}, 1).findings.at(timed_voxel_finding), HasSubstr("preprocessing"));
}

class SeededProgram : public testing::BuiltProgram {};

// The program of the studies under a name that is none of its commands says so, and does not start itself again.
TEST_F(SeededProgram, ALinkByAnotherNameIsNoCommand) {
  const auto studies = std::filesystem::path(program_).parent_path() / "touchstone-experiment";
  std::filesystem::create_symlink(studies, folder_ / "touchstone-another");
  const auto outcome =
      testing::run_command(fmt::format("PATH='{}':$PATH timeout 60 '{}' another", folder_.string(), program_), folder_);
  EXPECT_EQ(outcome.status, 2);
  EXPECT_THAT(outcome.err, HasSubstr("there is no command \"another\""));
}

TEST_F(SeededProgram, SlurmScriptsAskForTheSameSeeds) {
  const auto voxel = run("experiment voxel --seeds 3 --triangles 2000 --cases all.sqlite --engine slurm --dry-run");
  ASSERT_EQ(voxel.status, 0) << voxel.err;
  EXPECT_THAT(voxel.out, HasSubstr("--array=1-3\n"));
  EXPECT_THAT(voxel.out, HasSubstr("experiment voxel --seed 1 --seeds 3 --triangles 2000 --shard "));
  const auto shading = run("experiment shading --seeds 2 --seed 9 --out s --engine slurm --tasks 1 --dry-run");
  EXPECT_THAT(shading.out, HasSubstr("experiment shading --seed 9 --seeds 2 --shard \"$SLURM_ARRAY_TASK_ID/1\""));
  const auto springs = run("experiment springs --seeds 2 --first-seed 9 --cases s.sqlite --engine slurm --dry-run");
  EXPECT_THAT(springs.out, HasSubstr("experiment springs --first-seed 9 --seeds 2 --shard"));
  const auto friction = run("experiment friction --seeds 2 --dry-run");
  EXPECT_EQ(friction.out, "0\t{\"experiment\":\"friction\",\"seed\":1}\n1\t{\"experiment\":\"friction\",\"seed\":4}\n");
  EXPECT_FALSE(std::filesystem::exists(folder_ / "s"));
}

}  // namespace
}  // namespace touchstone::experiments
