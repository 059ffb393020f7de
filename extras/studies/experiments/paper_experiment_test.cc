#include "experiments/paper_experiment.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "harness/base/error.h"
#include "harness/recording/recording_file.h"
#include "harness/surface/mesh_file.h"

namespace touchstone::experiments {
namespace {

PaperScan bundled_plane() {
  const char* const source = std::getenv("TOUCHSTONE_SOURCE_DIR");
  const recording::Dataset dataset =
      recording::load_dataset(std::filesystem::path(source == nullptr ? "." : source) / "synthetic/bundled/plane");
  return {"plane", recording::load_recording(dataset.path_of("scan.csv")),
          surface::load_mesh(dataset.path_of(dataset.mesh_file), 1e-3), dataset.stiffness_N_per_m};
}

// On a plane every frictionless renderer gives the normal force back, shaded or not. The patch is open: nothing is said
// of densities.
TEST(PaperExperiment, OnAPlaneShadingAndVoxelsChangeNothing) {
  const PaperResult result = run_paper_experiments(bundled_plane(), {});
  ASSERT_EQ(result.voxel.size(), 3u);
  for (const PaperRow& row : result.voxel) EXPECT_NEAR(row.error_N, result.voxel.front().error_N, 1e-3) << row.renderer;
  ASSERT_EQ(result.density.size(), 1u);
  for (const PaperDensity& one : result.density) {
    EXPECT_NEAR(one.plain_N, result.density.back().plain_N, 1e-3);
    EXPECT_NEAR(one.shaded_N, one.plain_N, 1e-3);
    EXPECT_LT(one.plain_normal_N, 1e-3);
  }
  EXPECT_NEAR(result.fitted_mu, 0.20, 0.02) << "the coefficient that the recording was made with";
  EXPECT_LT(result.with_N, 0.7 * result.without_N);
  ASSERT_EQ(result.findings.size(), 6u);
  EXPECT_TRUE(result.findings[2].holds.value_or(false)) << "friction";
  for (std::size_t f = 3; f < 6; ++f) EXPECT_FALSE(result.findings[f].holds.has_value());
}

// The right law leaves the instruments' noise; on a plane the input carries the normal force, so that its part of it is
// given back; and no experiment is below what the right law scores.
TEST(PaperExperiment, EveryTableHasItsFloor) {
  const PaperResult result = run_paper_experiments(bundled_plane(), {});
  EXPECT_LT(result.floors.normal_part.rms_N, 0.3 * result.floors.all.rms_N);
  EXPECT_GT(result.with_N, result.floors.second_half.low95_N);
  EXPECT_GT(result.voxel.front().error_N, result.floors.all.high95_N) << "friction is what the proxy lacks";
  const std::string text = paper_text({result});
  EXPECT_THAT(text, ::testing::HasSubstr(fmt::format("{:.4f}", result.floors.all.rms_N)));
  const auto json = nlohmann::json::parse(paper_to_json({result}, {}));
  EXPECT_EQ(json["scans"][0]["floors"]["second_half"]["error_N"], result.floors.second_half.rms_N);
}

// One definition for all four, any other by option; the proxy of experiment 1 is the finest mesh of experiment 3.
TEST(PaperExperiment, AllFourShareOneDefinition) {
  const PaperScan scan = bundled_plane();
  PaperOptions options;
  const PaperResult all = run_paper_experiments(scan, options);
  EXPECT_EQ(all.voxel.front().error_N, all.density.back().plain_N);
  double squares = 0.0;
  for (const Vec3& f : scan.recording.f_W_N) squares += f.squaredNorm();
  EXPECT_NEAR(all.measured_N, std::sqrt(squares / static_cast<double>(scan.recording.size())), 1e-12);
  options.average = Average::mean;
  options.counted = Counted::contact;
  const PaperResult contact = run_paper_experiments(scan, options);
  EXPECT_EQ(contact.voxel.front().error_N, contact.density.back().plain_N);
  EXPECT_NE(contact.voxel.front().error_N, all.voxel.front().error_N);
}

// Errors near the floor: what shading can take is what lies above it. A finer mesh that is worse is no stable one.
TEST(PaperExperiment, FindingsSayWhatTheFloorLeavesAndWhichMeshDecides) {
  PaperResult r;
  r.voxel.resize(3);
  r.floors.normal_part.rms_N = 0.3;
  r.density = {{200, 0.9, 0.9, 1.0, 0.9},
               {1000, 0.5, 0.5, 0.5, 0.4},
               {6000, 0.4, 0.4, 0.34, 0.31},
               {16000, 0.4, 0.4, 0.32, 0.3}};
  const auto shading = [&] { return paper_findings(r).back(); };
  // (0.25 - 0.16) / (0.25 - 0.09) at 1000 triangles, 0.0195 / 0.0256 at 6000.
  EXPECT_EQ(shading().holds, true);
  EXPECT_THAT(shading().here, ::testing::HasSubstr("least at 1000 triangles: 56 %"));
  r.density[2].shaded_normal_N = 0.338;
  EXPECT_EQ(shading().holds, false);
  EXPECT_THAT(shading().here, ::testing::HasSubstr("least at 6000 triangles: 5 %"));
  r.floors.normal_part.rms_N = 0.6;
  EXPECT_FALSE(shading().holds.has_value());

  const auto stable = [&] { return paper_findings(r)[3]; };
  EXPECT_EQ(stable().holds, true);
  EXPECT_THAT(stable().here, ::testing::HasSubstr("1.25 times at most, at 1000 triangles"));
  r.density[2].plain_N = 3.0;
  EXPECT_EQ(stable().holds, false);
  EXPECT_THAT(stable().here, ::testing::HasSubstr("at 6000 triangles"));
}

TEST(PaperExperiment, ARecordingWithoutForcesIsRefused) {
  PaperScan scan = bundled_plane();
  scan.recording.f_W_N.clear();
  EXPECT_THROW(run_paper_experiments(scan, {}), BadData);
}

}  // namespace
}  // namespace touchstone::experiments
