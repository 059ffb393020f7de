// What a person would not notice passes as felt although it is not exact, and what one would notice does not.
#include "apps/felt_verdict.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <limits>

#include "apps/golden_runner.h"
#include "harness/base/error.h"
#include "harness/baseline/column_file.h"
#include "harness/recording/recording_file.h"

namespace touchstone::apps {
namespace {

GoldenCase felt_case(const std::string& name) {
  return load_case(std::filesystem::path(std::getenv("TOUCHSTONE_SOURCE_DIR")) / "golden" / name);
}

class Felt : public ::testing::Test {
 protected:
  const GoldenCase golden_ = felt_case("sphere-scan");
  RenderedTrajectory run_ = load_rendered(golden_.expected("god-object"));

  [[nodiscard]] FeltError felt(const FeltTolerance& tolerance = {}) const {
    return felt_error(golden_, "god-object", run_, tolerance);
  }
  [[nodiscard]] Verdict exact() const {
    return compare(load_columns(golden_.expected("god-object")), columns_of(run_, "run"), golden_.tolerance).verdict;
  }
};

TEST_F(Felt, AStandoffOfATenthOfAMicrometrePasses) {
  for (std::size_t i = 0; i < run_.size(); ++i) {
    const double force_N = run_.f_W_N[i].norm();
    if (force_N > 0.0) run_.f_W_N[i] *= 1.0 + 1e-7 * 500.0 / force_N;
  }
  EXPECT_EQ(exact(), Verdict::worse);
  const FeltError error = felt();
  EXPECT_TRUE(error.passed) << to_sentence(error, {});
  EXPECT_EQ(error.reference, "exact");
}

TEST_F(Felt, SevenNewtonSidewaysDoNot) {
  run_.f_W_N[700].x() += 7.0;
  const FeltError error = felt();
  EXPECT_FALSE(error.passed);
  EXPECT_NEAR(error.max_N, 7.0, 0.5);
  EXPECT_EQ(error.worst_t_s, run_.t_s[700]);
  EXPECT_THAT(to_sentence(error, {}), ::testing::HasSubstr("fails from the exact answer"));
}

TEST_F(Felt, ForceThatIsLostDoesNotAndNeitherDoesNaN) {
  auto lost = run_;
  for (Vec3& f : run_.f_W_N) f.setZero();
  EXPECT_FALSE(felt().passed);
  run_ = lost;
  run_.f_W_N[10].y() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(felt().passed);
}

TEST_F(Felt, ADeclaredEpsilonIsALengthTimesTheStiffness) {
  for (std::size_t i = 0; i < run_.size(); ++i) run_.f_W_N[i].x() += 1.0;
  EXPECT_FALSE(felt().passed);
  // 1 N at the case's stiffness, and what the facets of the mesh add.
  const double stiffness_N_per_m = 500.0;
  EXPECT_TRUE(felt({1.0, 1.0 / stiffness_N_per_m}).passed);
}

TEST_F(Felt, AnotherLengthIsBadData) {
  run_.f_W_N.pop_back();
  run_.tip_W_m.pop_back();
  run_.t_s.pop_back();
  run_.contact.pop_back();
  run_.contact_W_m.pop_back();
  EXPECT_NO_THROW((void)felt()) << "the exact answer is known at every tip";
  GoldenCase without = golden_;
  without.surface.generator.clear();
  EXPECT_THROW((void)felt_error(without, "god-object", run_, {}), BadData);
}

}  // namespace
}  // namespace touchstone::apps
