#include "harness/pipeline/fitting/fit.h"

#include "harness/base/error.h"
#include "harness/pipeline/evaluation/inputs.h"
#include "harness/pipeline/evaluation/sample_scan_for_test.h"
#include "harness/pipeline/fitting/fit_report.h"
#include "harness/pipeline/fitting/minimise.h"
#include "harness/surface/embree_surface.h"
#include "harness/testing/shared_data.h"

namespace touchstone::pipeline {
using metrics::TimeRanges;
using recording::InTrajectoryMode;
using recording::Recording;
using rendering::Model;

namespace {

FitRequest stiffness_fit(const std::filesystem::path& folder, const Recording& recording,
                         const std::string& parameter) {
  FitRequest request;
  request.evaluation = write_scan(folder, recording, 400.0);
  request.evaluation.in_trajectory = InTrajectoryMode::measured;
  request.parameters = {parameter};
  return request;
}

TEST(Minimise, FindsTheLowestOfSeveralValleys) {
  const auto valleys = [](const std::vector<double>& u) {
    double sum = 0.0;
    for (const double x : u) sum += std::pow(x - 0.83, 2) + 0.02 * (1.0 - std::cos(40.0 * (x - 0.83)));
    return sum;
  };
  for (const std::size_t n : {1u, 2u}) {
    const Minimum found = minimise(valleys, std::vector<double>(n, 0.2));
    for (const double u : found.u) EXPECT_NEAR(u, 0.83, 1e-5) << n;
  }
  const Minimum edge = minimise([](const std::vector<double>& u) { return u[0]; }, {0.5});
  EXPECT_NEAR(edge.u[0], 0.0, 1e-9);
}

TEST(Fit, FindsTheStiffnessOfAnExactRecording) {
  const auto folder = fresh_folder("touchstone-fit");
  FitRequest request = stiffness_fit(folder, scan(730.0), "stiffness_N_per_m=100:5000");
  request.fit_range = TimeRanges::parse("even:2s", "--fit-range");
  request.score_range = TimeRanges::parse("odd:2s", "--score-range");
  const FitResult result = run_fit(built_in(), request);
  EXPECT_NEAR(result.estimates[0].value, 730.0, 730.0 * 1e-4);
  EXPECT_LT(result.score_after, 1e-4);
  EXPECT_GT(result.score_before, 0.1);
  EXPECT_EQ(result.fit_samples + result.score_samples, 10'000u);
  EXPECT_TRUE(result.warnings.empty()) << result.warnings.front();
  write_fit(result, folder);
  EXPECT_EQ(rendering::load_model(folder / "model.json").parameters.at("stiffness_N_per_m"), result.estimates[0].value);
}

// The interval holds what it says: over independent noisy recordings the truth lies in about 95 of 100.
TEST(Fit, IntervalsCoverTheTruthUnderCorrelatedNoise) {
  const auto folder = fresh_folder("touchstone-cover");
  Random random(17);
  int covered = 0;
  double width = 0.0;
  const int runs = 20;
  for (int run = 0; run < runs; ++run) {
    Recording recording = scan(730.0);
    Vec3 noise = Vec3::Zero();
    // Remembers about 50 samples.
    for (Vec3& f : recording.f_W_N) {
      noise = 0.98 * noise + 0.02 * Vec3(random.normal(), random.normal(), random.normal());
      f += noise;
    }
    const FitResult result = run_fit(built_in(), stiffness_fit(folder, recording, "stiffness_N_per_m=500:1000"));
    const Estimate& one = result.estimates[0];
    ASSERT_TRUE(one.interval_known) << result.interval_note;
    width += (one.high95 - one.low95) / runs;
    covered += one.low95 <= 730.0 && 730.0 <= one.high95;
  }
  // Of 20 at 95 %: 16 or fewer happen once in 400.
  EXPECT_GE(covered, 17);
  // Expected width: noise of 0.1 N that remembers 50 samples, 7500 samples of 0.65 N RMS in contact: 2 * 1.96 * 730 *
  // 0.1 sqrt(2 * 50 / 7500) / 0.65 = 51 N/m. Half or twice as much would be another method.
  EXPECT_GT(width, 26.0);
  EXPECT_LT(width, 102.0);
}

TEST(Fit, TwoParametersOfRendererAndEffect) {
  const auto folder = fresh_folder("touchstone-two");
  Recording recording = scan(730.0);
  FitRequest request = stiffness_fit(folder, recording, "stiffness_N_per_m=100:5000");
  request.evaluation.model.effects.push_back({"viscous-friction", {{"coefficient_N_s_per_m", 3.0}}, "/effects/0"});
  // The recording shows a stiffness of 730 N/m and a drag of 5 N s/m while touching.
  for (std::size_t i = 1; i < recording.size(); ++i) {
    const double dt = recording.motion.t_s[i] - recording.motion.t_s[i - 1];
    Vec3 v = (recording.motion.p_W_m[i] - recording.motion.p_W_m[i - 1]) / dt;
    v.z() = 0.0;
    if (recording.f_W_N[i].z() > 0.0) recording.f_W_N[i] -= 5.0 * v;
  }
  save_recording(folder / "rec.csv", recording);
  request.parameters.emplace_back("viscous-friction.coefficient_N_s_per_m=0:20");
  const FitResult result = run_fit(built_in(), request);
  EXPECT_NEAR(result.estimates[0].value, 730.0, 3.0);
  EXPECT_NEAR(result.estimates[1].value, 5.0, 0.3);
  EXPECT_LT(result.fit_after, 0.2 * result.fit_before);
}

TEST(Fit, SaysSoOnABoundAndWhereNothingIsDetermined) {
  const auto folder = fresh_folder("touchstone-bound");
  const FitResult bound = run_fit(built_in(), stiffness_fit(folder, scan(730.0), "stiffness_N_per_m=100:500"));
  ASSERT_FALSE(bound.warnings.empty());
  EXPECT_NE(bound.warnings[0].find("bound"), std::string::npos);
  EXPECT_FALSE(bound.estimates[0].interval_known);
  // No force at all beyond a bias: no stiffness fits better than another where nothing is touched.
  Recording air = scan(730.0);
  for (std::size_t i = 0; i < air.size(); ++i) {
    air.motion.p_W_m[i].z() = 0.001;
    air.f_W_N[i] = Vec3(0, 0, 0.01);
  }
  const FitResult flat = run_fit(built_in(), stiffness_fit(folder, air, "stiffness_N_per_m=100:1000"));
  EXPECT_TRUE(std::ranges::any_of(
      flat.warnings, [](const std::string& w) { return w.find("does not determine") != std::string::npos; }));
}

TEST(Fit, RefusesWhatMakesNoSense) {
  const auto folder = fresh_folder("touchstone-nonsense");
  const auto refused = [&](const std::string& parameter, const std::string& expected) {
    try {
      run_fit(built_in(), stiffness_fit(folder, scan(730.0), parameter));
      ADD_FAILURE() << parameter;
    } catch (const UsageError& error) {
      EXPECT_NE(std::string(error.what()).find(expected), std::string::npos) << error.what();
    }
  };
  refused("stifness_N_per_m", "stiffness_N_per_m");
  refused("stiffness_N_per_m=5:5", "nothing to search");
  refused("stiffness_N_per_m=a:5", "not a number");
  refused("coulomb-friction.mu_dynamic", "no such parameter");
  FitRequest synthesized = stiffness_fit(folder, scan(0.0), "stiffness_N_per_m=100:500");
  synthesized.evaluation.in_trajectory = InTrajectoryMode::synthesize;
  EXPECT_THROW(run_fit(built_in(), synthesized), UsageError);
  FitRequest position = stiffness_fit(folder, scan(730.0), "stiffness_N_per_m=100:500");
  position.metric = "rms_position_error";
  EXPECT_THROW(run_fit(built_in(), position), UsageError);
}

// The real palpation run: one spring, fitted on the even 6 s blocks and scored on the odd ones. An independent fit of
// the same kind leaves 0.418 N there. It had a spline surface that goes on where the data ends; here the mesh is a
// patch that is pressed by up to 4 mm near its edges, and its continuation by planes is a guess. Where the contact lies
// more than a millimetre inside the patch (four samples of five) 0.39 N are left, at the edges 0.57 N (closest point)
// and 0.71 N (god-object, which also remembers the way over the guessed part).
FitRequest palpation_fit(const std::filesystem::path& recording, const std::filesystem::path& mesh,
                         const std::string& renderer) {
  FitRequest request;
  request.evaluation.recording = recording;
  request.evaluation.mesh = mesh;
  request.evaluation.mesh_unit = "mm";
  request.evaluation.in_trajectory = InTrajectoryMode::measured;
  request.evaluation.model.renderer = renderer;
  request.evaluation.model.parameters["stiffness_N_per_m"] = 500.0;
  request.parameters = {"stiffness_N_per_m=50:5000"};
  request.fit_range = TimeRanges::parse("even:6s", "--fit-range");
  request.score_range = TimeRanges::parse("odd:6s", "--score-range");
  return request;
}

// The independent figure is that of a spring along the normal of the tangent plane under the tip, over a height field.
// The nearest point on so steep and deeply pressed a surface is another, and near the outline depends on how far the
// mesh is continued: over 9 to 30 mm the spring's score moves between 0.43 and 0.45 N, the god-object's by less than 1
// %.
TEST(Fit, PalpationStiffnessScoresLikeAnIndependentFit) {
  TOUCHSTONE_SHARED_DATA_OR_SKIP(recording, "palpation/ContPalpRAL18T1.csv");
  TOUCHSTONE_SHARED_DATA_OR_SKIP(mesh, "palpation/DERIVED_surface_ContPalpRAL18T1.obj");
  const double independent_N = 0.418;
  FitRequest wider = palpation_fit(recording, mesh, "spring-linear");
  wider.evaluation.extend_edges_m = 0.012;
  const FitResult spring = run_fit(built_in(), wider);
  EXPECT_NEAR(spring.score_after, independent_N, 0.05 * independent_N);
  const FitResult god_object = run_fit(built_in(), palpation_fit(recording, mesh, "god-object"));
  EXPECT_GT(god_object.score_after, 0.95 * independent_N);
  EXPECT_LT(god_object.score_after, 1.15 * independent_N);
  for (const FitResult* const result : {&spring, &god_object}) {
    EXPECT_TRUE(result->estimates[0].interval_known) << result->interval_note;
    EXPECT_TRUE(result->warnings.empty()) << result->warnings.front();
    EXPECT_LT(result->score_after, result->score_before);
  }
  // Two ways to the same spring: their intervals must meet.
  EXPECT_LT(spring.estimates[0].low95, god_object.estimates[0].high95);
  EXPECT_LT(god_object.estimates[0].low95, spring.estimates[0].high95);
}

TEST(Fit, FrictionIsSearchedByItsShortNameAndWithoutABreakAwayOfItsOwn) {
  Model model;
  model.renderer = "god-object";
  model.source = "here";
  model.parameters["stiffness_N_per_m"] = 400.0;
  model.effects = {{"coulomb-friction", {{"mu_dynamic", 0.2}}, "/effects/0"}};
  const FitParameter friction = parse_fit_parameter(built_in(), "mu_dynamic=0:1", model);
  EXPECT_EQ(friction.name, "coulomb-friction.mu_dynamic");
  EXPECT_EQ(with_values(model, {friction}, {0.7}).effects[0].parameters.count("mu_static"), 0u);
  model.effects[0].parameters["mu_static"] = 0.3;
  EXPECT_EQ(with_values(model, {friction}, {0.7}).effects[0].parameters.at("mu_static"), 0.7);
  EXPECT_EQ(with_values(model, {friction}, {0.1}).effects[0].parameters.at("mu_static"), 0.3);
  model.effects.push_back({"stribeck-friction", {{"mu_dynamic", 0.2}}, "/effects/1"});
  EXPECT_THROW(parse_fit_parameter(built_in(), "mu_dynamic=0:1", model), UsageError) << "two entries have one";
}

TEST(Fit, ARenderersOwnFrictionIsSearchedBeyondItsBreakAway) {
  Model model;
  model.renderer = "friction-cone";
  model.source = "here";
  model.parameters = {{"stiffness_N_per_m", 400.0}, {"mu_static", 0.15}, {"mu_dynamic", 0.15}};
  const FitParameter friction = parse_fit_parameter(built_in(), "mu_dynamic=0:1", model);
  const Model more = with_values(model, {friction}, {0.7});
  EXPECT_EQ(more.parameters.at("mu_static"), 0.7);
  EXPECT_NO_THROW(built_in().make(more, make_embree_surface(plate())));
  EXPECT_EQ(with_values(model, {friction}, {0.1}).parameters.at("mu_static"), 0.15);
}

// Dry friction explains what the spring alone cannot, on blocks that the fit did not see.
TEST(Fit, FrictionBringsThePalpationNearerOnUnseenBlocks) {
  TOUCHSTONE_SHARED_DATA_OR_SKIP(recording, "palpation/ContPalpRAL18T1.csv");
  TOUCHSTONE_SHARED_DATA_OR_SKIP(mesh, "palpation/DERIVED_surface_ContPalpRAL18T1.obj");
  FitRequest request = palpation_fit(recording, mesh, "god-object");
  const FitResult spring = run_fit(built_in(), request);
  request.evaluation.model.effects = {{"coulomb-friction", {{"mu_dynamic", 0.1}}, "/effects/0"}};
  request.parameters.emplace_back("mu_dynamic=0:1");
  const FitResult friction = run_fit(built_in(), request);
  EXPECT_LT(friction.score_after, spring.score_after);
}

}  // namespace
}  // namespace touchstone::pipeline
