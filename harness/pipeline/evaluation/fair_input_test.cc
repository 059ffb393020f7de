// Which input a renderer gets: right for its kind, of a tip that it can have, said in the result, and the same for all
// that are compared.
#include "harness/base/error.h"
#include "harness/metrics/catalogue.h"
#include "harness/pipeline/evaluation/campaign.h"
#include "harness/pipeline/evaluation/inputs.h"
#include "harness/pipeline/evaluation/run.h"
#include "harness/pipeline/evaluation/sample_scan_for_test.h"
#include "harness/rendering/in_trajectory.h"
#include "harness/report/result_json.h"

namespace touchstone::pipeline {
using recording::InTrajectoryMode;
using recording::Recording;
using report::EvaluationResult;

namespace {

constexpr double true_mu = 0.25;

double value_of(const EvaluationResult& result, const std::string& name) {
  const metrics::MetricResult& metric = find_result(result.metrics, name);
  EXPECT_EQ(metric.status, metrics::MetricStatus::ok) << name << ": " << metric.note;
  return metric.value;
}

// One stroke along y over the plate at 2 N with friction `mu`, from a touch-down that is at once full: ten seconds, of
// which a test leaves out the first.
Recording stroke(double mu) {
  Recording recording;
  recording.source = "stroke";
  for (int i = 0; i < 10'000; ++i) {
    const double t = 0.001 * i;
    recording.motion.t_s.push_back(t);
    recording.motion.p_W_m.emplace_back(0.05, 0.02 + 0.005 * t, 0.0);
    const double normal = 2.0 + 0.5 * std::sin(t);
    recording.f_W_N.emplace_back(0.0, -mu * normal, normal);
  }
  return recording;
}

EvaluationRequest friction_request(const std::string& folder, const Recording& recording, double mu) {
  EvaluationRequest request = write_scan(fresh_folder(folder), recording, 500.0);
  request.model.renderer = "friction-cone";
  request.model.parameters["mu_static"] = request.model.parameters["mu_dynamic"] = mu;
  request.time_ranges = metrics::TimeRanges::parse("1:10", "--time-range");
  return request;
}

// The derivation of in_trajectory.h: a proxy with friction that gets the whole force answers it at the measured place;
// fed equation 2 it stays mu F_n / k behind.
TEST(FairInput, AProxyWithFrictionNeedsTheWholeForce) {
  EvaluationRequest request = friction_request("touchstone-whole-force", stroke(true_mu), true_mu);
  request.in_trajectory = InTrajectoryMode::whole_force;
  const EvaluationResult whole = run_evaluation(built_in(), request, "");
  // The force changes by 0.5 mN in a step, which moves the border of the cone by that much.
  EXPECT_LT(value_of(whole, "max_force_error"), 1e-3);
  EXPECT_LT(value_of(whole, "max_position_error"), 1e-6);
  request.in_trajectory = InTrajectoryMode::synthesize;
  const EvaluationResult normal = run_evaluation(built_in(), request, "");
  // 2 N on average: mu F_n / k is 1 mm.
  EXPECT_GT(value_of(normal, "rms_position_error"), 0.9 * true_mu * 2.0 / 500.0);
}

// A ball recorded the stroke, its centre 3 mm above the plate; renderers get the point at which it touched. Nothing is
// wrong with that.
TEST(FairInput, ABallWhosePointOfContactIsAskedForIsNotMisplaced) {
  Recording ball = stroke(true_mu);
  for (Vec3& p : ball.motion.p_W_m) p.z() += 0.003;
  EvaluationRequest request = friction_request("touchstone-ball-point", ball, true_mu);
  request.tip_radius_m = 0.0;
  request.probe_radius_m = 0.003;
  EXPECT_TRUE(load_inputs(built_in(), request).messages.empty());
  request.probe_radius_m = 0.0;
  EXPECT_FALSE(load_inputs(built_in(), request).messages.empty()) << "a point there is outside of the object";
}

// What is taken where the user chooses nothing.
TEST(FairInput, TheUsualInputIsTheRenderers) {
  rendering::Model cone = friction_request("touchstone-usual", stroke(true_mu), true_mu).model;
  EXPECT_TRUE(has_friction_in_proxy(built_in(), cone));
  cone.parameters["mu_static"] = cone.parameters["mu_dynamic"] = 0.0;
  EXPECT_FALSE(has_friction_in_proxy(built_in(), cone));
  EXPECT_TRUE(has_friction_in_proxy(built_in(), cone, std::vector<std::string>{"mu_dynamic"})) << "it is fitted";
  cone.renderer = "god-object";
  cone.parameters = {{"stiffness_N_per_m", 500.0}};
  EXPECT_FALSE(has_friction_in_proxy(built_in(), cone));
  EXPECT_EQ(usual_in_trajectory(true), InTrajectoryMode::whole_force);
  EXPECT_EQ(usual_in_trajectory(false), InTrajectoryMode::synthesize);
}

// And the other way round: without friction in the proxy equation 2 leads to the measured place, the whole force
// |F_t| / k beside it.
TEST(FairInput, AProxyWithoutFrictionNeedsTheNormalForce) {
  EvaluationRequest request = friction_request("touchstone-normal-force", stroke(true_mu), 0.0);
  request.in_trajectory = InTrajectoryMode::synthesize;
  EXPECT_LT(value_of(run_evaluation(built_in(), request, ""), "max_position_error"), 1e-12);
  request.in_trajectory = InTrajectoryMode::whole_force;
  EXPECT_NEAR(value_of(run_evaluation(built_in(), request, ""), "mean_position_error"), true_mu * 2.0 / 500.0, 1e-4);
}

// Without friction in the recording both are the same input.
TEST(FairInput, WithoutFrictionBothAreTheSame) {
  EvaluationRequest request = friction_request("touchstone-both", stroke(0.0), 0.0);
  request.in_trajectory = InTrajectoryMode::whole_force;
  const report::RenderedInput whole = run_evaluation(built_in(), request, "").input;
  request.in_trajectory = InTrajectoryMode::synthesize;
  EXPECT_EQ(whole.hash, run_evaluation(built_in(), request, "").input.hash);
}

std::filesystem::path bundled(const std::string& name) {
  const char* const source = std::getenv("TOUCHSTONE_SOURCE_DIR");
  return std::filesystem::path(source == nullptr ? "." : source) / "synthetic/bundled" / name;
}

std::vector<PlannedEvaluation> planned(const std::string& dataset, EvaluationRequest base,
                                       const std::vector<std::string>& renderers, bool chosen = false) {
  std::vector<PlannedEvaluation> out = plan_dataset(built_in(), bundled(dataset), {}, {}, base, chosen);
  std::erase_if(out, [&](const PlannedEvaluation& one) {
    return std::ranges::count(renderers, one.request.model.renderer) == 0;
  });
  return out;
}

// The model that made the bundled duck's recording, with its coefficient of friction.
TEST(FairInput, TheDucksOwnModelScoresHalfWithTheWholeForce) {
  EvaluationRequest base;
  base.in_trajectory = InTrajectoryMode::whole_force;
  base.tip_radius_m = 0.0015;
  base.metrics = {"rms_force_error", "position_episodes"};
  const auto plan = planned("duck", base, {"friction-cone"}, true);
  ASSERT_EQ(plan.size(), 1u);
  const double whole = value_of(run_evaluation(built_in(), plan.front().request, ""), "rms_force_error");
  EvaluationRequest normal = plan.front().request;
  normal.in_trajectory = InTrajectoryMode::synthesize;
  EXPECT_LT(whole, 0.5 * value_of(run_evaluation(built_in(), normal, ""), "rms_force_error"));
}

TEST(FairInput, EveryResultSaysItsInput) {
  EvaluationRequest request = friction_request("touchstone-said", stroke(true_mu), true_mu);
  request.in_trajectory = InTrajectoryMode::whole_force;
  const auto folder = fresh_folder("touchstone-said-out");
  const EvaluationResult result = evaluate_into(built_in(), request, folder);
  const EvaluationResult read = report::load_result(folder / "result.json");
  EXPECT_EQ(read.input, result.input);
  EXPECT_EQ(read.input.in_trajectory, "whole-force");
  EXPECT_EQ(read.input.hash.size(), 32u);
  const auto setting = std::ranges::find(read.settings, "In-trajectory", [](const auto& one) { return one.first; });
  ASSERT_NE(setting, read.settings.end());
  EXPECT_NE(setting->second.find("whole measured force"), std::string::npos) << setting->second;
}

// A renderer of balls, as plug-ins have them, is not fed points that it takes for balls of its own default.
TEST(FairInput, ARendererOfBallsDoesNotEnterAsAPoint) {
  EvaluationRequest request = write_scan(fresh_folder("touchstone-ball-only"), scan(0.0), 500.0);
  request.model.renderer = "god-object";
  rendering::RendererEntry balls = built_in().find(request.model);
  const auto radius = std::ranges::find(balls.parameters, "tip_radius_m", &rendering::ParameterDeclaration::name);
  radius->minimum = 1e-9;
  radius->initial = 0.0025;
  request.model.provided = std::make_shared<const rendering::RendererEntry>(balls);
  request.tip_radius_m = 0.0;
  EXPECT_FALSE(can_have_tip(built_in(), request.model, 0.0));
  EXPECT_TRUE(can_have_tip(built_in(), request.model, 0.0025));
  EXPECT_THROW(run_evaluation(built_in(), request, ""), TipNotRepresentable);
}

// A renderer of points gets no ball's centre: it does not enter, and all enter with the point of contact.
TEST(FairInput, ATipThatARendererCannotHaveKeepsItOut) {
  EvaluationRequest request = write_scan(fresh_folder("touchstone-tip"), scan(0.0), 500.0);
  request.model.renderer = "voxel";
  request.tip_radius_m = 0.0015;
  try {
    run_evaluation(built_in(), request, "");
    FAIL();
  } catch (const TipNotRepresentable& error) {
    EXPECT_NE(std::string(error.what()).find("--tip-radius 0"), std::string::npos) << error.what();
  }
  request.tip_radius_m = 0.0;
  EXPECT_NO_THROW(run_evaluation(built_in(), request, ""));
  EvaluationRequest base;
  base.metrics = {"rms_force_error"};
  auto plan = planned("plane", base, {"voxel", "god-object"});
  for (PlannedEvaluation& one : plan) {  // deeper than any press: 6 of 32 voxels along 120 mm are 22 mm
    if (one.column != "voxel") continue;
    one.request.model.parameters["reach_voxels"] = one.request.model.parameters["margin_voxels"] = 6.0;
  }
  ASSERT_EQ(plan.size(), 4u) << "ball and point of contact, two renderers each";
  std::vector<Evaluated> done;
  for (const PlannedEvaluation& one : plan) {
    done.push_back(evaluate_planned(built_in(), one, fresh_folder("touchstone-tip-" + std::to_string(done.size()))));
  }
  for (const Evaluated& one : done) {
    const bool ball = one.group.find("ball of") != std::string::npos;
    EXPECT_EQ(one.does_not_enter.empty(), !(ball && one.column == "voxel")) << one.group << ' ' << one.column;
  }
  // On a plate the voxels hold the plane itself, so that with the same input the two score the same.
  pipeline::Board board = board_of(done, "");
  pipeline::rank_board(board, false);
  ASSERT_EQ(board.tasks.size(), 2u);
  ASSERT_EQ(board.tasks[1].ranked.size(), 2u);
  EXPECT_NEAR(board.tasks[1].entries[0].scores.rms_force_error_N, board.tasks[1].entries[1].scores.rms_force_error_N,
              1e-9);
}

TEST(FairInput, DifferentInputsAreNotCompared) {
  const auto folder = fresh_folder("touchstone-different");
  std::vector<Evaluated> done;
  for (const double stiffness : {500.0, 700.0}) {
    PlannedEvaluation one;
    one.request = write_scan(folder, scan(0.0), stiffness);
    one.group = "scan";
    one.column = std::to_string(static_cast<int>(stiffness));
    done.push_back(evaluate_planned(built_in(), one, folder / one.column));
  }
  const pipeline::Board board = board_of(done, folder);
  ASSERT_EQ(board.tasks.size(), 2u);
  EXPECT_NE(summary_table(done).find("Different inputs are not compared"), std::string::npos);
  pipeline::Board together = board;
  together.tasks.front().entries.push_back(together.tasks.back().entries.front());
  EXPECT_THROW(pipeline::rank_board(together, false), UsageError);
}

// Counted over the same positions as the replay; a plate of two triangles takes the same on each machine.
TEST(FairInput, OperationsAreCountedInAnEvaluation) {
  EvaluationRequest request = write_scan(fresh_folder("touchstone-counted"), scan(0.0), 500.0);
  const EvaluationResult all = run_evaluation(built_in(), request, "");
  const double total = value_of(all, "total_operations");
  EXPECT_NEAR(value_of(all, "mean_operations"), total / 10'000.0, 1e-9);
  EXPECT_GE(value_of(all, "max_operations"), value_of(all, "median_operations"));
  EXPECT_GT(value_of(all, "median_operations"), 0.0);
  request.metrics = {"max_operations"};
  const EvaluationResult one = run_evaluation(built_in(), request, "");
  ASSERT_EQ(one.metrics.size(), 1u);
  EXPECT_EQ(value_of(one, "max_operations"), value_of(all, "max_operations"));
}

}  // namespace
}  // namespace touchstone::pipeline
