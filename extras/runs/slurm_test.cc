#include "slurm.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace touchstone::runs {
namespace {

using testing::HasSubstr;

SlurmRequest request(std::vector<std::string> words) {
  SlurmRequest own;
  own.program = "/opt/it's here/touchstone";
  own.words = std::move(words);
  own.file_option = "--cases";
  own.out = "/data/all.sqlite";
  own.shards = 12;
  own.cores_per_task = 2;
  own.options = "--partition=short";
  return own;
}

TEST(SlurmScript, NamesShardsAndQuotesWhatAShellWouldTakeApart) {
  const std::string script = slurm_script(request({"sweep", "/my data/spec.json"}), {0, {1, 2, 3, 7, 9, 10}});
  EXPECT_THAT(script, HasSubstr("--array=1-3,7,9-10\n"));
  EXPECT_THAT(script, HasSubstr("--job-name=touchstone-sweep\n"));
  EXPECT_THAT(script, HasSubstr("#SBATCH --partition=short\n"));
  EXPECT_THAT(script, HasSubstr("'/opt/it'\\''s here/touchstone' sweep '/my data/spec.json' --shard"));
  EXPECT_THAT(script, HasSubstr("--shard \"$SLURM_ARRAY_TASK_ID/12\" --threads 2"));
  EXPECT_THAT(script, HasSubstr("--cases '/data/all.sqlite.parts'/\"$SLURM_ARRAY_TASK_ID\".sqlite\n"));
}

TEST(SlurmScript, HasTheWordsOfTheCommand) {
  const std::string script = slurm_script(request({"experiment", "voxel", "--seed", "7", "$(reboot)", ""}), {0, {5}});
  EXPECT_THAT(script, HasSubstr("--array=5\n"));
  EXPECT_THAT(script, HasSubstr("--job-name=touchstone-experiment\n"));
  EXPECT_THAT(script, HasSubstr("touchstone' experiment voxel --seed 7 '$(reboot)' '' --shard"));
}

// slurm.conf(5): "The maximum job array task index value will be one less than MaxArraySize".
TEST(SlurmArrays, StayBelowTheLimitOfTheSite) {
  std::vector<std::uint64_t> shards;
  for (std::uint64_t i = 1; i <= 14; ++i) {
    if (i != 9) shards.push_back(i);
  }
  for (const std::uint64_t limit : {2U, 6U, 14U, 15U, 1001U}) {
    std::vector<std::uint64_t> seen;
    for (const SlurmArray& array : slurm_arrays(shards, limit)) {
      for (const std::uint64_t shard : array.shards) {
        EXPECT_LT(shard - array.offset, limit);
        seen.push_back(shard);
      }
    }
    EXPECT_EQ(seen, shards) << limit;
  }
  EXPECT_EQ(slurm_arrays(shards, 15).size(), 1U);
  EXPECT_EQ(slurm_arrays(shards, 6).size(), 3U);
  EXPECT_TRUE(slurm_arrays({}, 6).empty());
}

TEST(SlurmScript, AnArrayBeyondTheLimitCountsFromItsOffset) {
  SlurmRequest many = request({"sweep", "spec.json"});
  many.shards = 3000;
  const std::string script = slurm_script(many, {1001, {1001, 1002, 1005}});
  EXPECT_THAT(script, HasSubstr("--array=0-1,4\n"));
  EXPECT_THAT(script, HasSubstr("shard=$((1001 + SLURM_ARRAY_TASK_ID))\n"));
  EXPECT_THAT(script, HasSubstr("--shard \"$shard/3000\""));
  EXPECT_THAT(script, HasSubstr("/\"$shard\".sqlite\n"));
  EXPECT_THAT(script, HasSubstr("/1001+%a.log\n"));
}

}  // namespace
}  // namespace touchstone::runs
