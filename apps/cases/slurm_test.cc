#include "apps/cases/slurm.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace touchstone::apps {
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
  const std::string script = slurm_script(request({"sweep", "/my data/spec.json"}), {1, 2, 3, 7, 9, 10});
  EXPECT_THAT(script, HasSubstr("--array=1-3,7,9-10\n"));
  EXPECT_THAT(script, HasSubstr("--job-name=touchstone-sweep\n"));
  EXPECT_THAT(script, HasSubstr("#SBATCH --partition=short\n"));
  EXPECT_THAT(script, HasSubstr("'/opt/it'\\''s here/touchstone' sweep '/my data/spec.json' --shard"));
  EXPECT_THAT(script, HasSubstr("--shard \"$SLURM_ARRAY_TASK_ID/12\" --threads 2"));
  EXPECT_THAT(script, HasSubstr("--cases '/data/all.sqlite.parts'/\"$SLURM_ARRAY_TASK_ID\".sqlite\n"));
}

TEST(SlurmScript, HasTheWordsOfTheCommand) {
  const std::string script = slurm_script(request({"experiment", "voxel", "--seed", "7", "$(reboot)", ""}), {5});
  EXPECT_THAT(script, HasSubstr("--array=5\n"));
  EXPECT_THAT(script, HasSubstr("--job-name=touchstone-experiment\n"));
  EXPECT_THAT(script, HasSubstr("touchstone' experiment voxel --seed 7 '$(reboot)' '' --shard"));
}

}  // namespace
}  // namespace touchstone::apps
