#include "harness/base/error.h"
#include "harness/metrics/catalogue.h"
#include "harness/pipeline/evaluation/campaign.h"
#include "harness/pipeline/evaluation/inputs.h"
#include "harness/pipeline/evaluation/run.h"
#include "harness/pipeline/evaluation/sample_scan_for_test.h"
#include "harness/pipeline/evaluation/sensor_window.h"
#include "harness/rendering/measured_renderer.h"
#include "harness/report/result_json.h"
#include "harness/surface/embree_surface.h"

namespace touchstone::pipeline {
using metrics::TimeRanges;
using recording::Recording;
using report::EvaluationResult;

namespace {

double value(const EvaluationResult& result, const std::string& name) {
  const metrics::MetricResult& metric = find_result(result.metrics, name);
  EXPECT_EQ(metric.status, metrics::MetricStatus::ok) << name << ": " << metric.note;
  return metric.value;
}

// The round trip of the 2006 paper, section 3.1: a frictionless scan rendered at any stiffness gives the measured
// forces and the out-trajectory back, whatever unit the mesh came in.
TEST(Evaluation, AFrictionlessScanComesBackToRounding) {
  const auto folder = fresh_folder("touchstone-evaluation");
  for (const auto& [unit, unit_m] : {std::pair{"m", 1.0}, std::pair{"mm", 1e-3}, std::pair{"km", 1e3}}) {
    for (const double stiffness : {50.0, 500.0, 1e5}) {
      const EvaluationRequest request = write_scan(folder, scan(0.0), stiffness, unit, unit_m);
      const EvaluationResult result = run_evaluation(built_in(), request, "");
      // Rounding of a coordinate of 0.1 m, times the stiffness.
      const double bound = 16.0 * 2.2e-16 * 0.1 * stiffness + 1e-15;
      // Below the contact threshold a force is no contact and none is rendered: those samples keep their error.
      EXPECT_LE(value(result, "max_force_error"), request.contact_threshold_N + bound) << unit << ' ' << stiffness;
      EXPECT_LE(value(result, "max_position_error"), 1e-15);
      EXPECT_EQ(value(result, "onsets"), 5.0);
      EXPECT_EQ(value(result, "releases"), 5.0);
      EXPECT_EQ(value(result, "missed_onsets"), 0.0);
      EXPECT_EQ(value(result, "spurious_onsets"), 0.0);
    }
  }
}

TEST(Campaign, WhatManySayIsSaidOnceAndOfWhom) {
  const auto one = [](const char* column, std::vector<std::string> messages) {
    return Evaluated{"", "duck / scan: over the back", column, {}, {}, std::move(messages)};
  };
  const std::vector<Evaluated> group{one("penalty", {"noisy", "lost"}), one("god-object", {"noisy"}),
                                     one("voxel", {"blind", "noisy", "lost"})};
  EXPECT_EQ(group_messages(group),
            "duck / scan: noisy\nduck / scan, penalty, voxel: lost\nduck / scan, voxel: blind\n");
  const Evaluated of_file{"", "a.csv", "k", {}, {}, {"a.csv: 3 times are jittered", "far away"}};
  EXPECT_EQ(group_messages(std::span(&of_file, 1)), "a.csv: 3 times are jittered\na.csv: far away\n");
  EXPECT_EQ(group_messages({}), "");
}

TEST(Evaluation, MeasuredPositionsOfACompliantObject) {
  const auto folder = fresh_folder("touchstone-measured");
  EvaluationRequest request = write_scan(folder, scan(700.0), 700.0);
  request.in_trajectory = recording::InTrajectoryMode::measured;
  EXPECT_LE(value(run_evaluation(built_in(), request, ""), "max_force_error"), 1e-10);
  // Twice the stiffness: the error is the force itself, and so is the reference.
  request.model.parameters["stiffness_N_per_m"] = 1400.0;
  const EvaluationResult twice = run_evaluation(built_in(), request, "");
  EXPECT_NEAR(value(twice, "rms_force_error"), *find_result(twice.metrics, "rms_force_error").reference, 1e-9);
}

TEST(Evaluation, WritesARenderedFileAResultAndAReport) {
  const auto folder = fresh_folder("touchstone-files");
  const EvaluationResult result = evaluate_into(built_in(), write_scan(folder, scan(0.0), 500.0), folder / "out");
  const recording::RenderedTrajectory rendered = recording::load_rendered(folder / "out" / "rendered.csv");
  EXPECT_EQ(rendered.size(), 10'000u);
  const EvaluationResult read = report::load_result(folder / "out" / "result.json");
  EXPECT_EQ(value(read, "rms_force_error"), value(result, "rms_force_error"));
  EXPECT_EQ(read.provenance.inputs.size(), 2u);
  EXPECT_TRUE(std::filesystem::exists(folder / "out" / "report.html"));
  EXPECT_FALSE(read.object.vertices_W_m.empty());
}

TEST(Evaluation, SaysWhatAPersonWouldNotice) {
  EvaluationRequest request = write_scan(fresh_folder("touchstone-perceived"), scan(0.0), 500.0);
  const EvaluationResult all = run_evaluation(built_in(), request, "");
  EXPECT_EQ(find_result(all.metrics, "rms_force_error_jnd").unit, "JND");
  EXPECT_LT(value(all, "max_force_error_jnd"), 1.0) << "what is below the contact threshold cannot be felt";
  EXPECT_EQ(value(all, "noticeable_share"), 0.0);
  EXPECT_GT(value(all, "force_structural_similarity"), 0.9);
  request.metrics = {"noticeable_share"};
  const EvaluationResult one = run_evaluation(built_in(), request, "");
  ASSERT_EQ(one.metrics.size(), 1u);
  EXPECT_EQ(one.metrics.front().name, "noticeable_share");
  request.metrics = {"perception", "rms_force_error"};
  EXPECT_GT(run_evaluation(built_in(), request, "").metrics.size(), 8u);
}

TEST(Evaluation, TimeRangesChooseWhatTheMetricsSee) {
  const auto folder = fresh_folder("touchstone-ranges");
  Recording recording = scan(0.0);
  for (std::size_t i = 5000; i < 6000; ++i) recording.f_W_N[i].x() = 2.0;
  EvaluationRequest request = write_scan(folder, recording, 500.0);
  request.time_ranges = TimeRanges::parse("0:5,6:10", "--time-range");
  EXPECT_LT(value(run_evaluation(built_in(), request, ""), "max_force_error"), 0.06);
  request.time_ranges = TimeRanges::parse("5:6", "--time-range");
  EXPECT_NEAR(value(run_evaluation(built_in(), request, ""), "rms_force_error_x"), 2.0, 1e-12);
  request.time_ranges = TimeRanges::parse("50:60", "--time-range");
  EXPECT_THROW(run_evaluation(built_in(), request, ""), BadData);
}

TEST(Evaluation, InstrumentEntriesActInTheComparisonOnly) {
  const auto folder = fresh_folder("touchstone-instrument");
  Recording recording = scan(700.0);
  for (Vec3& f : recording.f_W_N) f += Vec3(0.2, -0.1, 0.0);
  EvaluationRequest request = write_scan(folder, recording, 700.0);
  request.in_trajectory = recording::InTrajectoryMode::measured;
  EXPECT_NEAR(value(run_evaluation(built_in(), request, ""), "rms_force_error"), std::hypot(0.2, 0.1), 1e-9);
  request.model.instrument.push_back({"force-bias", {{"fx_N", 0.2}, {"fy_N", -0.1}, {"fz_N", 0.0}}, "/instrument/0"});
  const EvaluationResult result = run_evaluation(built_in(), request, folder / "rendered.csv");
  EXPECT_LE(value(result, "max_force_error"), 1e-9);
  for (const Vec3& f : recording::load_rendered(folder / "rendered.csv").f_W_N) EXPECT_EQ(f.x(), 0.0);
}

TEST(Evaluation, AMeshInMillimetresReadAsMetresIsAskedAbout) {
  const auto folder = fresh_folder("touchstone-mm");
  // The plate at a height of half a metre: in the wrong unit it is half a kilometre up.
  Recording recording = scan(0.0);
  for (Vec3& p : recording.motion.p_W_m) p.z() += 0.5;
  EvaluationRequest request = write_scan(folder, recording, 500.0);
  surface::TriangleMesh mesh = plate();
  for (Vec3& v : mesh.vertices_W_m) v.z() += 0.5;
  save_mesh(mesh, folder / "mesh.obj", 1e-3);
  try {
    run_evaluation(built_in(), request, "");
    FAIL();
  } catch (const BadData& error) {
    EXPECT_NE(std::string(error.what()).find("mm"), std::string::npos) << error.what();
  }
}

TEST(Evaluation, SizesThatHardlyFitAreSaid) {
  const auto folder = fresh_folder("touchstone-sizes");
  EvaluationRequest request = write_scan(folder, scan(0.0), 500.0, "mm", 1e-3);
  EXPECT_TRUE(run_evaluation(built_in(), request, "").messages.empty());
  request.mesh_unit = "m";
  const auto messages = run_evaluation(built_in(), request, "").messages;
  EXPECT_TRUE(
      std::ranges::any_of(messages, [](const std::string& one) { return one.find("mm") != std::string::npos; }));
}

TEST(Evaluation, TorqueIsSaidNotToBeJudged) {
  const auto folder = fresh_folder("touchstone-torque");
  Recording recording = scan(0.0);
  const EvaluationRequest without = write_scan(folder, recording, 500.0);
  EXPECT_TRUE(run_evaluation(built_in(), without, "").messages.empty());
  recording.torque_W_Nm.assign(recording.size(), Vec3(0.0, 0.01, 0.0));
  const EvaluationRequest request = write_scan(folder, recording, 500.0);
  const auto messages = run_evaluation(built_in(), request, "").messages;
  ASSERT_EQ(messages.size(), 1U);
  EXPECT_NE(messages[0].find("touchstone tool compare"), std::string::npos) << messages[0];
}

TEST(Evaluation, ReversedForcesAreNoticedAndTheFlipIsOffered) {
  const auto folder = fresh_folder("touchstone-sign");
  Recording recording = scan(0.0);
  for (Vec3& f : recording.f_W_N) f = -f;
  EvaluationRequest request = write_scan(folder, recording, 500.0);
  try {
    run_evaluation(built_in(), request, "");
    FAIL();
  } catch (const BadData& error) {
    EXPECT_NE(std::string(error.what()).find("--flip-force"), std::string::npos) << error.what();
  }
  request.flip_force = true;
  EXPECT_LT(value(run_evaluation(built_in(), request, ""), "max_force_error"), 0.06);
}

// Window by window gives what the whole recording at once gives, also across the seams.
TEST(SensorWindow, SeamsDoNotShow) {
  rendering::Model model;
  model.renderer = "god-object";
  model.parameters["stiffness_N_per_m"] = 500.0;
  model.instrument = {{"time-lag", {{"lag_s", 0.0137}}, "/instrument/0"},
                      {"tool-inertia", {{"mass_kg", 0.05}}, "/instrument/1"},
                      {"force-bias", {{"fx_N", 0.1}, {"fy_N", 0.2}, {"fz_N", 0.3}}, "/instrument/2"}};
  const rendering::MeasuredRenderer comparison = built_in().make_measured(model, make_embree_surface(plate()));
  std::vector<double> t_s;
  std::vector<Vec3> p, expected, streamed;
  std::vector<Quat> q;
  SensorWindow window(comparison,
                      [&](const ComparedSample& sample) { streamed.push_back(sample.metric.f_rendered_W_N); });
  Random random(9);
  for (int i = 0; i < 70'000; ++i) {
    ComparedSample sample;
    sample.metric.t_s = 0.001 * i;
    sample.metric.f_rendered_W_N = random.direction();
    sample.p_W_m = Vec3(0.05 * std::sin(0.01 * i), 0.0, 0.0);
    t_s.push_back(sample.metric.t_s);
    p.push_back(sample.p_W_m);
    q.push_back(sample.q_WS);
    expected.push_back(sample.metric.f_rendered_W_N);
    window.add(sample);
  }
  window.finish();
  comparison.apply({t_s, p, q}, expected);
  ASSERT_EQ(streamed.size(), expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i) ASSERT_LE((streamed[i] - expected[i]).norm(), 1e-11) << i;
}

}  // namespace
}  // namespace touchstone::pipeline
