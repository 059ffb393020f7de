// What the catalogue accepts is searched: bounds of a fit are the catalogue's, but for what a scan must resolve.
#include "harness/discrepancy/candidate_starts.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "harness/discrepancy/catalogue_for_test.h"
#include "harness/discrepancy/plane_for_test.h"
#include "harness/rendering/declared_effect.h"
#include "harness/rendering/smooth_field.h"

namespace touchstone::discrepancy {
using rendering::Candidate;
using rendering::Model;
using rendering::ParameterDeclaration;
using rendering::Side;

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
  recording::Recording recording;
  Model model;
  rendering::Prediction prediction;
  rendering::RecordingScales scales;
};

TEST_P(CatalogueBounds, AreThoseOfTheFit) {
  for (const Declared& declared : all_declared) {
    const Candidate candidate{declared.effect, declared.side, declared.parameters, traits_of(declared.effect)};
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
                           {{"mu_static", "1", 0.0, 5.0, 0.0, ""}, {"mu_dynamic", "1", 0.0, 5.0, 0.0, ""}},
                           traits_of("coulomb-friction")};
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
    recording::Recording indentation = recording;
    for (std::size_t i = 0; i < indentation.motion.size(); ++i)
      indentation.motion.p_W_m[i].head<2>() = Eigen::Vector2d::Constant((i % 2 == 0 ? 2.0 : -2.0) * noise_m);
    const rendering::Prediction there = PlanePredictor(indentation.motion).predict(model);
    const rendering::RecordingScales known =
        measure_scales(indentation, there, 0.01, model.parameters.at("stiffness_N_per_m"), noise_m);
    EXPECT_FALSE(known.over_surface());
    for (const Declared& declared : along_surface) {
      const Candidate candidate{declared.effect, declared.side, declared.parameters, traits_of(declared.effect)};
      EXPECT_TRUE(candidate_fit(candidate, known, indentation, there).starts.empty()) << declared.effect;
      EXPECT_TRUE(candidate_fit(candidate, known, indentation, there).parameters.empty()) << declared.effect;
      EXPECT_FALSE(candidate_fit(candidate, scales, recording, prediction).parameters.empty()) << declared.effect;
    }
  }
}

// Every effect that is a hypothesis begins where its own plan and bounds allow.
TEST_P(CatalogueBounds, OfThePlansAreKept) {
  for (const Candidate& candidate : whole_catalogue()) {
    const CandidateFit fit = candidate_fit(candidate, scales, recording, prediction);
    for (const rendering::NamedParameters& start : fit.starts) {
      for (const auto& [name, value] : start.parameters) {
        const auto found = std::ranges::find(candidate.parameters, name, &ParameterDeclaration::name);
        ASSERT_NE(found, candidate.parameters.end()) << candidate.name << " declares no " << name;
      }
      Model fitted = model;
      (candidate.side == Side::contact ? fitted.effects : fitted.instrument).push_back(start);
      for (const FreeParameter& free : fit.parameters) {
        EXPECT_EQ(free.moves_contact, candidate.traits.moves_contact);
        EXPECT_LT(free.lower, free.upper) << candidate.name << "." << free.name;
        EXPECT_GE(free.get(fitted), free.lower - 1e-9) << candidate.name << "." << free.name;
        EXPECT_LE(free.get(fitted), free.upper + 1e-9) << candidate.name << "." << free.name;
        const double u = 0.5 * (std::max(free.lower, -10.0) + std::min(free.upper, 10.0));
        Model other = fitted;
        free.set(other, u);
        EXPECT_NEAR(free.get(other), u, 1e-9 * std::abs(u) + 1e-12) << candidate.name << "." << free.name;
      }
    }
  }
}

// What a user declares is sought from each of its starts, within its bounds.
TEST_P(CatalogueBounds, OfADeclaredEffectAreItsOwn) {
  const auto law = std::make_shared<const rendering::DeclaredEffect>(rendering::parse_effect(
      R"J({"schema": "touchstone-effect/1", "name": "mine", "summary": "s", "source": "s", "acts_on": "friction",
          "parameters": {"a": {"unit": "N", "minimum": -2, "maximum": 3, "start": [0, 1]},
                         "v": {"unit": "m/s", "minimum": 1e-6, "maximum": 10, "start": [0.01, 0.1]}},
          "formula": {"along_N": "-a * tanh(speed_m_per_s / v)"}})J",
      "mine.json"));
  const CandidateFit fit =
      candidate_fit({law->name, Side::contact, law->parameters, law->traits, law}, scales, recording, prediction);
  ASSERT_EQ(fit.starts.size(), 4U);
  for (const rendering::NamedParameters& start : fit.starts) EXPECT_EQ(start.law, law);
  EXPECT_EQ(fit.starts[1].parameters.at("v"), 0.1);
  EXPECT_EQ(fit.starts[2].parameters.at("a"), 1.0);
  ASSERT_EQ(fit.parameters.size(), 2U);
  EXPECT_EQ(fit.parameters[0].lower, -2.0);  // steps of its largest start
  EXPECT_EQ(fit.parameters[0].upper, 3.0);
  EXPECT_TRUE(fit.parameters[1].logarithmic);  // its bounds are seven decades apart
}

INSTANTIATE_TEST_SUITE_P(Units, CatalogueBounds, ::testing::Values(1e-3, 1.0, 1e3));

}  // namespace
}  // namespace touchstone::discrepancy
