// What a person would not notice passes as felt although it is not exact, and what one would notice does not.
#include "harness/golden/felt_verdict.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <limits>
#include <string>

#include "harness/base/error.h"
#include "harness/golden/case_runner.h"
#include "harness/golden/comparison/column_file.h"
#include "harness/golden/golden_file.h"
#include "harness/recording/recording_file.h"
#include "renderers/catalogue.h"
#include "synthetic/generators.h"
#include "synthetic/surface_catalogue.h"
#include "synthetic/surfaces/exact_contact.h"

namespace touchstone::golden {
using recording::RenderedTrajectory;

namespace {

GoldenCase felt_case(const std::string& name) {
  return load_case(std::filesystem::path(std::getenv("TOUCHSTONE_SOURCE_DIR")) / "golden" / name);
}

FeltError judged(const GoldenCase& golden, const std::string& model, const RenderedTrajectory& run,
                 const FeltTolerance& tolerance) {
  return felt_error({renderers::built_in_catalogue(), synthetic::built_in_generators()}, golden, model, run, tolerance);
}

class Felt : public ::testing::Test {
 protected:
  const GoldenCase golden_ = felt_case("sphere-scan");
  RenderedTrajectory run_ = recording::load_rendered(golden_.expected("god-object"));

  [[nodiscard]] FeltError felt(const FeltTolerance& tolerance = {}) const {
    return judged(golden_, "god-object", run_, tolerance);
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

// Sample by sample 0.5 N to one side and to the other: a mean error of 0.5 N, and jumps of 1 N. A constant error has
// none.
TEST_F(Felt, MeanAndJumpOfTheErrorAreThoseThatWerePlanted) {
  const FeltError before = felt();
  const auto planted = [&](double even_N, double odd_N) {
    auto right = run_;
    for (std::size_t i = 0; i < run_.size(); ++i) run_.f_W_N[i].x() += i % 2 == 0 ? even_N : odd_N;
    const FeltError error = felt();
    run_ = right;
    return error;
  };
  const FeltError saw = planted(0.5, -0.5);
  EXPECT_NEAR(saw.mean_N, 0.5, before.mean_N);
  EXPECT_NEAR(saw.jump_N, 1.0, before.jump_N);
  const FeltError constant = planted(0.5, 0.5);
  EXPECT_NEAR(constant.mean_N, 0.5, before.mean_N);
  EXPECT_NEAR(constant.jump_N, before.jump_N, 1e-12);
  EXPECT_LT(before.jump_N, 0.1);
  EXPECT_GT(before.right_N, 1.0);
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

// Past a sharp edge the right force jumps by 2 N from one sample to the next. Which of the two shows it is not felt;
// later is.
TEST_F(Felt, AJumpOfTheRightForceMayComeASampleLate) {
  const GoldenCase keen = felt_case("wedge-keen");
  const RenderedTrajectory right = recording::load_rendered(keen.expected("god-object"));
  std::size_t jump = 1;
  for (std::size_t i = 1; i < right.size(); ++i) {
    const auto step_N = [&](std::size_t at) { return (right.f_W_N[at] - right.f_W_N[at - 1]).norm(); };
    if (step_N(i) > step_N(jump)) jump = i;
  }
  RenderedTrajectory run = right;
  run.f_W_N[jump] = right.f_W_N[jump - 1];
  const FeltError late = judged(keen, "god-object", run, {});
  EXPECT_GT(late.max_N, 1.5);
  EXPECT_TRUE(late.passed) << to_sentence(late, {});
  run.f_W_N[jump + 1] = right.f_W_N[jump - 1];
  EXPECT_FALSE(judged(keen, "god-object", run, {}).passed);
  // Nor does a jump excuse what is neither its beginning nor its end.
  run = right;
  run.f_W_N[jump] = 0.5 * (right.f_W_N[jump] + right.f_W_N[jump - 1]);
  EXPECT_FALSE(judged(keen, "god-object", run, {}).passed);
}

// The golden is our own renderer's: to agree with it is no excuse where the exact answer is known.
TEST_F(Felt, AGoldenWithTheSameFaultDoesNotExcuseIt) {
  GoldenCase faulty = golden_;
  faulty.folder = std::filesystem::path(::testing::TempDir()) / "felt-faulty-golden";
  std::filesystem::create_directories(faulty.folder / "expected");
  for (Vec3& f : run_.f_W_N) f *= 1.5;
  write_golden(faulty.expected("god-object"), run_, {});
  const FeltError error = judged(faulty, "god-object", run_, {});
  EXPECT_EQ(error.reference, "exact");
  EXPECT_FALSE(error.passed) << to_sentence(error, {});
}

// The mesh of the duck is up to 2.8 mm off the smooth body somewhere (1.4 N), at these tips 0.2 N at most.
TEST_F(Felt, TheMeshIsAllowedWhatItIsOffAtTheTipAndNoMore) {
  const GoldenCase duck = felt_case("duck-scan");
  RenderedTrajectory run = recording::load_rendered(duck.expected("god-object"));
  const FeltError right = judged(duck, "god-object", run, {});
  EXPECT_TRUE(right.passed) << to_sentence(right, {});
  EXPECT_GT(right.max_N, 0.2);
  const auto touching = std::ranges::find(run.contact, std::uint8_t{1}) - run.contact.begin();
  run.f_W_N[static_cast<std::size_t>(touching) + 20].x() += 0.5;
  EXPECT_FALSE(judged(duck, "god-object", run, {}).passed);
}

// Of every case the mesh's right answer passes, and the greater part is judged without a golden.
TEST_F(Felt, RightAnswersPassOnEveryCase) {
  std::size_t by_exact = 0;
  std::size_t by_golden = 0;
  for (const auto& entry : std::filesystem::directory_iterator(golden_.folder.parent_path())) {
    if (!entry.is_directory()) continue;
    const GoldenCase one = load_case(entry.path());
    for (const std::string model : {"god-object", "god-object-ball"}) {
      if (!std::filesystem::exists(one.expected(model))) continue;
      const FeltError error = judged(one, model, recording::load_rendered(one.expected(model)), {0.5, 0.0});
      EXPECT_TRUE(error.passed) << one.name << ' ' << model << ": " << to_sentence(error, {0.5, 0.0});
      by_exact += error.by_exact;
      by_golden += error.by_golden;
    }
  }
  EXPECT_GT(by_exact, by_golden);
  EXPECT_GT(by_golden, 0U);
}

// Past the middle of a plate the closest point is on the far side; the right answer still pushes back.
TEST_F(Felt, PoppingThroughAPlateFailsByTheGolden) {
  const GoldenCase plate = felt_case("shell-push");
  RenderedTrajectory run = recording::load_rendered(plate.expected("god-object"));
  const FeltError right = judged(plate, "god-object", run, {});
  EXPECT_EQ(right.reference, "both");
  EXPECT_TRUE(right.passed) << to_sentence(right, {});
  const auto analytic = synthetic::make_surface(plate.surface.generator, plate.surface.parameters);
  for (std::size_t i = 0; i < run.size(); ++i)
    run.f_W_N[i] = plate.scale * synthetic::exact_contact(*analytic, run.tip_W_m[i] / plate.scale, 500.0, 0.0).f_W_N;
  EXPECT_FALSE(judged(plate, "god-object", run, {}).passed) << "the closest point's answer";
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
  EXPECT_THROW((void)judged(without, "god-object", run_, {}), BadData);
}

}  // namespace
}  // namespace touchstone::golden
