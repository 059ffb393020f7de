// What the catalogue accepts is searched: bounds of a fit are the catalogue's, but for what a scan must resolve.
#include "harness/discrepancy/candidate_starts.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "harness/discrepancy/plane_for_test.h"
#include "harness/rendering/smooth_field.h"

namespace touchstone::discrepancy {
namespace {

struct Declared {
  std::string effect;
  Side side;
  std::vector<ParameterDeclaration> parameters;
};

// Bounds that no effect has by itself.
const std::vector<Declared> all_declared{
    {"tool-weight", Side::instrument, {{"mass_kg", "kg", 0.0, 77.0, 0.0, ""}}},
    {"tool-inertia", Side::instrument, {{"mass_kg", "kg", 0.0, 78.0, 0.0, ""}}},
    {"time-lag", Side::instrument, {{"lag_s", "s", -0.9, 0.8, 0.0, ""}}},
    {"anisotropic-friction", Side::contact, {{"mu_x", "1", 0.0, 6.0, 0.0, ""}, {"mu_y", "1", 0.0, 7.0, 0.0, ""}}},
    {"power-law-stiffness", Side::contact, {{"exponent", "1", 0.1, 8.0, 1.0, ""}}},
};

// A plane pressed by hand, in a world of the unit GetParam().
class CatalogueBounds : public ::testing::TestWithParam<double> {
 protected:
  void SetUp() override {
    recording.motion = hand(0.0, GetParam());
    model.parameters["stiffness_N_per_m"] = 900.0 / GetParam();
    prediction = PlanePredictor(recording.motion).predict(model);
    recording.f_W_N = prediction.f_W_N;
    scales = measure_scales(recording, prediction, 0.01, model.parameters.at("stiffness_N_per_m"), 0.0);
  }
  Recording recording;
  Model model;
  Prediction prediction;
  RecordingScales scales;
};

TEST_P(CatalogueBounds, AreThoseOfTheFit) {
  for (const Declared& declared : all_declared) {
    const Candidate candidate{declared.effect, declared.side, declared.parameters};
    const CandidateFit fit = candidate_fit(candidate, scales, recording, prediction);
    for (const ParameterDeclaration& parameter : declared.parameters) {
      for (const FreeParameter& free : fit.parameters) {
        if (free.name != parameter.name) continue;
        Model fitted = model;
        (declared.side == Side::contact ? fitted.effects : fitted.instrument).push_back(fit.starts.front());
        free.set(fitted, free.lower);
        EXPECT_NEAR(find_entry(fitted, declared.effect)->parameters.at(free.name), parameter.minimum, 1e-12)
            << declared.effect;
        free.set(fitted, free.upper);
        EXPECT_NEAR(find_entry(fitted, declared.effect)->parameters.at(free.name), parameter.maximum, 1e-12)
            << declared.effect;
      }
    }
  }
}

// On a soft object a tip sticks over as much as the object gives way sideways: 1.5 mu times the depth (Mindlin 1949).
TEST_P(CatalogueBounds, LetATipStickAsFarAsTheObjectGivesWaySideways) {
  const Candidate friction{"coulomb-friction",
                           Side::contact,
                           {{"mu_static", "1", 0.0, 5.0, 0.0, ""}, {"mu_dynamic", "1", 0.0, 5.0, 0.0, ""}}};
  const CandidateFit fit = candidate_fit(friction, scales, recording, prediction);
  double longest_m = 0.0;
  for (const FreeParameter& free : fit.parameters) {
    if (free.name == "presliding_m") longest_m = std::exp(free.upper);
  }
  EXPECT_GT(scales.depth_m, 0.0);
  EXPECT_GE(longest_m, 1.5 * scales.depth_m);
  EXPECT_LE(longest_m, 2.0 * scales.depth_m);
}

// An indentation at one place (a cell under an AFM): its extent of zero once made a field of endlessly many columns.
TEST_P(CatalogueBounds, OfAnIndentationAtOnePlaceNothingAlongTheSurfaceIsTried) {
  std::vector<Declared> along_surface{
      {"stiffness-map", Side::contact, {{"amplitude", "1", -1.0, 5.0, 0.0, ""}}},
      {"tip-radius", Side::contact, {{"radius_m", "m", 0.0, 1.0, 0.0, ""}}},
      {"stiffness-field", Side::contact, rendering::field_parameters("1", 0.9, "")},
      {"height-field", Side::instrument, rendering::field_parameters("m", 1.0, "")},
  };
  for (const double noise_m : {0.0, 1e-5 * GetParam()}) {
    Recording indentation = recording;
    for (std::size_t i = 0; i < indentation.motion.size(); ++i)
      indentation.motion.p_W_m[i].head<2>() = Eigen::Vector2d::Constant((i % 2 == 0 ? 2.0 : -2.0) * noise_m);
    const Prediction there = PlanePredictor(indentation.motion).predict(model);
    const RecordingScales known =
        measure_scales(indentation, there, 0.01, model.parameters.at("stiffness_N_per_m"), noise_m);
    EXPECT_FALSE(known.over_surface());
    for (const Declared& declared : along_surface) {
      const Candidate candidate{declared.effect, declared.side, declared.parameters};
      EXPECT_TRUE(candidate_fit(candidate, known, indentation, there).starts.empty()) << declared.effect;
      EXPECT_TRUE(candidate_fit(candidate, known, indentation, there).parameters.empty()) << declared.effect;
      EXPECT_FALSE(candidate_fit(candidate, scales, recording, prediction).parameters.empty()) << declared.effect;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Units, CatalogueBounds, ::testing::Values(1e-3, 1.0, 1e3));

}  // namespace
}  // namespace touchstone::discrepancy
