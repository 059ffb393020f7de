// The three quickest of the samples; the night runs all of them.
#include "harness/pipeline/discrepancy/sample_check.h"

namespace touchstone::pipeline {
namespace {

TEST_F(DiscrepancySamples, NothingMissing) {
  TOUCHSTONE_SHARED_DATA_OR_SKIP(samples, "discrepancy-sample");
  check(samples, "pw2huf7x");
}

TEST_F(DiscrepancySamples, CannotTellWeightFromBias) {
  TOUCHSTONE_SHARED_DATA_OR_SKIP(samples, "discrepancy-sample");
  check(samples, "f8mdh85b");
  EXPECT_TRUE(std::filesystem::exists(folder_ / "next.csv"));
}

TEST_F(DiscrepancySamples, DampingAndTheModelRunsInAnOrdinaryReplay) {
  TOUCHSTONE_SHARED_DATA_OR_SKIP(samples, "discrepancy-sample");
  check(samples, "atxjb5pb");
  const auto place = samples / "atxjb5pb";
  ASSERT_EQ(run(fmt::format("replay --model {0}/model.json --mesh {1}/mesh.obj --trajectory {1}/holdout.csv --out "
                            "{0}/replayed.csv",
                            folder_.string(), place.string())),
            0)
      << read_file(folder_ / "err.txt");
  const recording::RenderedTrajectory replayed = recording::load_rendered(folder_ / "replayed.csv");
  const recording::Recording measured = recording::load_recording(place / "holdout.csv");
  ASSERT_EQ(replayed.size(), measured.size());
  double sum = 0.0;
  for (std::size_t i = 0; i < measured.size(); ++i) sum += (measured.f_W_N[i] - replayed.f_W_N[i]).squaredNorm();
  const auto findings = nlohmann::json::parse(read_file(folder_ / "findings.json"));
  EXPECT_NEAR(std::sqrt(sum / static_cast<double>(measured.size())),
              findings.at("gap").at("holdout").at("after").get<double>(), 1e-9);
}

}  // namespace
}  // namespace touchstone::pipeline
