// What a motion cannot show is reported as open: a place across a straight line, friction one way only, a mass that
// nothing weighs.
#include "harness/discrepancy/identifiability.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "harness/discrepancy/catalogue_for_test.h"
#include "harness/discrepancy/findings.h"
#include "harness/discrepancy/plane_for_test.h"
#include "harness/discrepancy/two_recordings_for_test.h"

namespace touchstone::discrepancy {
using recording::Recording;
using rendering::Model;
using rendering::Prediction;

namespace {

// A softer or stiffer place on a plane.
class BumpPredictor final : public rendering::Predictor {
 public:
  explicit BumpPredictor(MotionColumns motion) : motion_(motion), plane_(std::move(motion)) {}
  Prediction predict(const Model& model) override {
    Prediction prediction = plane_.predict(model);
    const rendering::NamedParameters* const map = find_entry(model, "stiffness-map");
    for (std::size_t i = 0; map != nullptr && i < motion_.size(); ++i) {
      const auto& p = map->parameters;
      const Vec3 from(motion_.p_W_m[i].x() - p.at("x_m"), motion_.p_W_m[i].y() - p.at("y_m"), 0.0);
      const double w = p.at("width_m");
      prediction.f_W_N[i] *= 1.0 + p.at("amplitude") * std::exp(-0.5 * from.squaredNorm() / (w * w));
    }
    return prediction;
  }

 private:
  MotionColumns motion_;
  PlanePredictor plane_;
};

// To and fro along x, and along y by so much.
MotionColumns scan(double y_m, double unit) {
  MotionColumns motion;
  for (int i = 0; i < 3000; ++i) {
    const double t = 0.004 * i;
    motion.t_s.push_back(t);
    motion.p_W_m.emplace_back(unit * 0.02 * std::sin(1.3 * t), unit * y_m * std::sin(2.9 * t + 0.4),
                              unit * (-0.001 - 0.0003 * std::sin(7.0 * t)));
  }
  return motion;
}

FitData blocks_of(const Recording& recording, rendering::Predictor& predictor, double noise_N) {
  FitData data;
  data.predictor = &predictor;
  data.blocks = make_blocks(recording.motion, 1.0 / 30.0);
  data.measured_N = block_means(data.blocks, recording.f_W_N);
  data.noise.assign(data.blocks.size(), {Vec3::UnitZ(), noise_N, noise_N, Vec3::Zero()});
  return data;
}

const std::vector<rendering::Candidate>& known() {
  static const std::vector<rendering::Candidate> all = whole_catalogue();
  return all;
}

std::vector<std::string> names(const std::vector<Undetermined>& undetermined) {
  std::vector<std::string> out;
  for (const Undetermined& one : undetermined) out.push_back(one.parameter);
  return out;
}

class IdentifiableAtScale : public ::testing::TestWithParam<double> {};

TEST_P(IdentifiableAtScale, APlaceAcrossAStraightLineIsOpen) {
  const double unit = GetParam();
  Model model;
  model.renderer = "plane";
  model.parameters["stiffness_N_per_m"] = 900.0 / unit;
  model.effects.push_back(
      {"stiffness-map", {{"amplitude", 0.6}, {"x_m", 0.004 * unit}, {"y_m", 0.0}, {"width_m", 0.006 * unit}}, ""});
  const double extent = 0.04 * unit;
  const std::vector<FreeParameter> parameters{log_base_parameter("stiffness_N_per_m", 90.0 / unit, 9000.0 / unit),
                                              linear_parameter("stiffness-map", "amplitude", 1.0, -0.99, 100.0),
                                              linear_parameter("stiffness-map", "x_m", extent, -extent, extent),
                                              linear_parameter("stiffness-map", "y_m", extent, -extent, extent),
                                              log_parameter("stiffness-map", "width_m", 0.02 * extent, 0.35 * extent)};
  for (const double y_m : {0.0, 0.015}) {
    Recording recording;
    recording.motion = scan(y_m, unit);
    BumpPredictor predictor(recording.motion);
    recording.f_W_N = predictor.predict(model).f_W_N;
    const auto open = names(
        find_undetermined(blocks_of(recording, predictor, 0.02), recording, model, parameters, EffectLibrary(known())));
    if (y_m == 0.0) {
      EXPECT_THAT(open, ::testing::ElementsAre("amplitude", "y_m"));  // small on the line, or large off it
    } else {
      EXPECT_THAT(open, ::testing::IsEmpty());
    }
  }
}

TEST_P(IdentifiableAtScale, FrictionAlongAnAxisNeedsStrokesBothWays) {
  const double unit = GetParam();
  Recording recording;
  // Strokes along x, and a steady way along y.
  for (int i = 0; i < 3000; ++i) {
    const double t = 0.004 * i;
    recording.motion.t_s.push_back(t);
    recording.motion.p_W_m.emplace_back(unit * 0.02 * std::sin(1.3 * t), unit * 0.0004 * t, unit * -0.001);
  }
  Model model;
  model.parameters["stiffness_N_per_m"] = 900.0 / unit;
  PlanePredictor predictor(recording.motion);
  const Prediction prediction = predictor.predict(model);
  EXPECT_GT(both_ways_share(recording, prediction, 0), 0.3);
  EXPECT_EQ(both_ways_share(recording, prediction, 1), 0.0);
}

TEST_P(IdentifiableAtScale, ThereInOnePlaceAndBackInAnotherIsNotBothWays) {
  const double unit = GetParam();
  Model model;
  model.parameters["stiffness_N_per_m"] = 900.0 / unit;
  for (const bool same_place : {true, false}) {
    Recording recording;
    for (int i = 0; i < 8000; ++i) {  // along y for 40 mm, then back, on the same line or 15 mm beside it
      const double t_s = 0.002 * i;
      const double y_m = t_s < 8.0 ? 0.005 * t_s : 0.005 * (16.0 - t_s);
      recording.motion.t_s.push_back(t_s);
      recording.motion.p_W_m.push_back(unit * Vec3(t_s < 8.0 || same_place ? 0.0 : 0.015, y_m, -1e-3));
    }
    PlanePredictor predictor(recording.motion);
    const double share = both_ways_share(recording, predictor.predict(model), 1);
    if (same_place) {
      EXPECT_GT(share, 0.95);
    } else {
      EXPECT_EQ(share, 0.0);
    }
  }
}

TEST_P(IdentifiableAtScale, AnEffectWithoutASizeIsNotFound) {
  const double unit = GetParam();
  Recording recording;
  recording.motion = hand(0.0, unit);
  Model model;
  model.parameters["stiffness_N_per_m"] = 900.0 / unit;
  model.effects.push_back({"viscous-friction", {{"coefficient_N_s_per_m", 1.0}}, ""});
  for (Vec3& p : recording.motion.p_W_m) p = Vec3(0.0, 0.0, p.z());  // never slides
  PlanePredictor predictor(recording.motion);
  recording.f_W_N = predictor.predict(model).f_W_N;
  const std::vector<FreeParameter> parameters{
      log_base_parameter("stiffness_N_per_m", 90.0 / unit, 9000.0 / unit),
      linear_parameter("viscous-friction", "coefficient_N_s_per_m", 1.0, 0.0, 1e4)};
  const auto open =
      find_undetermined(blocks_of(recording, predictor, 0.02), recording, model, parameters, EffectLibrary(known()));
  EXPECT_THAT(names(open), ::testing::ElementsAre("coefficient_N_s_per_m"));
  EXPECT_THAT(without_size(open, parameters), ::testing::ElementsAre("viscous-friction"));
}

TEST_P(IdentifiableAtScale, AShiftAlongTheSurfaceFarBeyondATrackersIsQuestioned) {
  const double unit = GetParam();
  Recording recording;
  recording.motion = hand(0.0, unit);
  Model model;
  model.parameters["stiffness_N_per_m"] = 900.0 / unit;
  PlanePredictor predictor(recording.motion);
  const Prediction prediction = predictor.predict(model);
  for (const double dx_m : {0.0005, 0.02}) {
    model.instrument = {
        {"registration",
         {{"dx_m", dx_m * unit}, {"dy_m", 0.0}, {"dz_m", 1e-4 * unit}, {"rx_rad", 0.0}, {"ry_rad", 0.0}},
         ""}};
    EXPECT_EQ(question_values(recording, prediction, model, {}, {}, 5e-5 * unit, EffectLibrary(known())).size(),
              dx_m > 0.01 ? 1U : 0U);
  }
}

// Pressed in by 1 mm, with a coefficient of 0.3: the object gives way by up to 0.45 mm (Mindlin 1949).
TEST_P(IdentifiableAtScale, ALongerPathThanTheObjectGivesWayIsQuestioned) {
  const double unit = GetParam();
  Recording recording;
  for (int i = 0; i < 1000; ++i) {
    recording.motion.t_s.push_back(0.004 * i);
    recording.motion.p_W_m.push_back(unit * Vec3(1e-5 * i, 0.0, -1e-3));
  }
  Model model;
  model.parameters["stiffness_N_per_m"] = 900.0 / unit;
  const Prediction prediction = PlanePredictor(recording.motion).predict(model);
  for (const double path_m : {1e-4, 4e-4, 8e-4, 2e-3}) {
    model.effects = {
        {"coulomb-friction", {{"mu_static", 0.3}, {"mu_dynamic", 0.3}, {"presliding_m", path_m * unit}}, ""}};
    const auto questions = question_values(recording, prediction, model, {}, {}, 1e-5 * unit, EffectLibrary(known()));
    EXPECT_EQ(questions.size(), path_m > 6e-4 ? 1U : 0U) << path_m;
  }
}

INSTANTIATE_TEST_SUITE_P(Units, IdentifiableAtScale, ::testing::Values(1e-3, 1.0, 1e3));

TEST(TimeLimit, GivesTheBestAnswerSoFarAndWhatWasNotTried) {
  const InstrumentDescription instrument = small_noise(1.0);
  Model start;
  start.renderer = "plane";
  start.parameters["stiffness_N_per_m"] = 850.0;
  Model truth = start;
  truth.parameters["stiffness_N_per_m"] = 900.0;
  truth.instrument.push_back({"force-bias", {{"fx_N", 0.4}, {"fy_N", 0.2}, {"fz_N", 0.3}}, ""});
  const auto measure = [&](double phase, std::uint64_t seed) {
    const MotionColumns path = hand(phase, 1.0);
    return measured(path, PlanePredictor(path).predict(truth).f_W_N, instrument, seed);
  };
  const TwoRecordings recordings(measure(0.0, 1), measure(1.1, 2), instrument, start,
                                 [](const MotionColumns& motion) { return std::make_unique<PlanePredictor>(motion); });
  const rendering::ParameterDeclaration force{"", "N", -1e3, 1e3, 0.0, ""};
  std::vector<rendering::Candidate> library{
      {"force-bias", rendering::Side::instrument, {force, force, force}, traits_of("force-bias")}};
  library[0].parameters[0].name = "fx_N";
  library[0].parameters[1].name = "fy_N";
  library[0].parameters[2].name = "fz_N";
  for (const double limit_s : {0.0, 1e6}) {
    SearchSettings settings;
    settings.time_limit_s = limit_s;
    Findings findings;
    findings.search = search_effects(recordings.data, start, library, settings, [](const std::string&) {});
    conclude(findings, library);
    const bool ended = limit_s > 0.0;
    EXPECT_EQ(findings.search.found.size(), ended ? 1U : 0U);
    EXPECT_EQ(findings.search.not_tried.empty(), ended);
    // Not even the fits that widen the intervals: what comes after the limit is what the verdict needs.
    EXPECT_EQ(findings.search.draws.empty(), !ended);
    const auto& left_out = findings.search.not_tried;
    EXPECT_EQ(std::ranges::count(left_out, "simulated recordings for the intervals"), ended ? 0 : 1);
    EXPECT_EQ(findings.verdict, ended ? FindingsVerdict::explained : FindingsVerdict::unexplained);
    const bool said = findings.explanation.find("force-bias as effect number 1") != std::string::npos;
    EXPECT_EQ(said, !ended) << findings.explanation;
    if (ended) {
      EXPECT_NEAR(findings.search.model.parameters.at("stiffness_N_per_m"), 900.0, 20.0);
    }
  }
}

}  // namespace
}  // namespace touchstone::discrepancy
