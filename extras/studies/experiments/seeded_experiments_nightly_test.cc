// Seeds of a real experiment, in one go and in parts: what the rows say is the same but for times.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "experiments/seeded_experiments.h"
#include "experiments/voxel_page.h"
#include "harness/report/page_html.h"

namespace touchstone::experiments {
namespace {

const std::atomic<bool> never = false;

VoxelExperimentOptions small() {
  VoxelExperimentOptions options;
  options.triangles = 2000;
  options.resolutions = {32, 64};
  return options;
}

TEST(SeededVoxel, PartsMergeToTheSameRowsAndAVoxelExperimentComesBackWhole) {
  const SeededExperiment experiment = seeded_voxel(small(), 2);
  std::vector<std::string> hashes;
  for (const std::uint64_t shards : {1U, 2U}) {
    runs::CaseStore store(runs::CaseStore::in_memory, seed_table(experiment));
    for (std::uint64_t k = shards; k >= 1; --k) {
      store.start_run({});
      runs::run_cases(seed_job(experiment), store, {k, shards}, 2, never);
    }
    hashes.push_back(store.content_hash());
    EXPECT_EQ(store.failed(), 0U);
    const auto seeds = stored_seeds(experiment, store);
    ASSERT_EQ(seeds.size(), 2U);
    for (const StoredSeed& own : seeds) {
      const VoxelExperiment e = voxel_from(own.result.document, own.result.times);
      EXPECT_EQ(e.options.seed, 1 + own.number);
      EXPECT_EQ(voxel_document(e, own.number == 0), own.result.document);
      EXPECT_EQ(voxel_times(e), own.result.times);
      EXPECT_EQ(e.find("voxel", 64)->rms_N, own.result.values.at(6));
      EXPECT_GT(e.rows.front().timing.mean_us, 0.0);
    }
    const auto first = voxel_from(seeds[0].result.document, seeds[0].result.times);
    EXPECT_EQ(first.t_s.size(), first.samples);
    EXPECT_NE(page_to_html(voxel_page(first, {})).find("Magnitude of the force"), std::string::npos);
  }
  EXPECT_EQ(hashes[0], hashes[1]);
}

TEST(SeededVoxel, TheReportFromARowIsThatOfTheExperimentItself) {
  const VoxelExperiment e = run_voxel_experiment(small());
  const VoxelExperiment again = voxel_from(voxel_document(e, true), voxel_times(e));
  EXPECT_EQ(voxel_table(again), voxel_table(e));
  EXPECT_EQ(voxel_experiment_to_json(again), voxel_experiment_to_json(e));
  EXPECT_EQ(page_to_html(voxel_page(again, {})), page_to_html(voxel_page(e, {})));
}

}  // namespace
}  // namespace touchstone::experiments
