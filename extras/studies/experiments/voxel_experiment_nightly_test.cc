// The paper's findings about proxy and voxels, on several seeds: those that hold here are pinned, and the two that do
// not are pinned as not holding.
#include <gtest/gtest.h>

#include <iostream>

#include "experiments/voxel_experiment.h"

namespace touchstone::experiments {
namespace {

class VoxelExperimentSeed : public ::testing::TestWithParam<std::uint64_t> {};

TEST_P(VoxelExperimentSeed, TheFindingsOfThePaper) {
  VoxelExperimentOptions options;
  options.seed = GetParam();
  options.resolutions = {32, 64};
  const VoxelExperiment experiment = run_voxel_experiment(options);
  std::cout << voxel_table(experiment);
  ASSERT_EQ(experiment.rows.size(), 5U);
  EXPECT_GT(experiment.in_contact, 1000U);
  for (const VoxelRow& row : experiment.rows) {
    ASSERT_TRUE(std::isfinite(row.rms_N) && row.rms_N > 0.0) << row.renderer;
    ASSERT_TRUE(std::isfinite(row.own_rms_N)) << row.renderer;
    ASSERT_TRUE(row.operations.has_value()) << row.renderer;
    EXPECT_EQ(row.operations->steps, experiment.samples);
  }
  for (const int resolution : {32, 64}) {
    const VoxelRow& dense = *experiment.find("voxel", resolution);
    const VoxelRow& sparse = *experiment.find("voxel-sparse", resolution);
    EXPECT_EQ(dense.f_W_N, sparse.f_W_N);
    EXPECT_EQ(dense.operations->counts, sparse.operations->counts);
    EXPECT_LT(sparse.timing.memory_bytes.value(), dense.timing.memory_bytes.value() / 2);
  }
  // Against the smooth body the god-object is the nearest and each halving of the voxel helps.
  EXPECT_LT(experiment.find("god-object", 0)->own_rms_N, experiment.find("voxel", 64)->own_rms_N);
  EXPECT_LT(experiment.find("voxel", 64)->own_rms_N, experiment.find("voxel", 32)->own_rms_N);
  // In the order of the table; the sixth is a time and is reported only. At 32^3 a voxel of this body is 3.6 mm wide
  // and the error not comparable any more.
  ASSERT_EQ(experiment.findings.size(), 8U);
  const auto holds = [&](std::size_t i) { return experiment.findings[i].holds; };
  EXPECT_TRUE(holds(1)) << experiment.findings[1].here;
  EXPECT_TRUE(holds(2)) << experiment.findings[2].here;
  EXPECT_TRUE(holds(3)) << experiment.findings[3].here;
  EXPECT_TRUE(holds(4)) << experiment.findings[4].here;
  EXPECT_TRUE(holds(5)) << experiment.findings[5].here;
  EXPECT_FALSE(holds(7)) << "ours keeps a record per triangle";
}

INSTANTIATE_TEST_SUITE_P(Seeds, VoxelExperimentSeed, ::testing::Values(1, 2, 3));

}  // namespace
}  // namespace touchstone::experiments
