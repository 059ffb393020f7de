// A property that differs over the surface by no law of the library, on a plane whose stiffness is known by heart.
#include "harness/discrepancy/field_move.h"

#include <gtest/gtest.h>

#include <cmath>

#include "harness/discrepancy/catalogue_for_test.h"
#include "harness/discrepancy/field_prior.h"
#include "harness/discrepancy/findings.h"
#include "harness/discrepancy/model_edit.h"
#include "harness/discrepancy/two_recordings_for_test.h"
#include "harness/rendering/smooth_field.h"

namespace touchstone::discrepancy {
using rendering::Model;
using rendering::NamedParameters;

namespace {

const std::vector<rendering::Candidate> library{
    {"viscous-friction",
     rendering::Side::contact,
     {{"coefficient_N_s_per_m", "N s/m", 0.0, 1e4, 0.0, "b"}},
     traits_of("viscous-friction")},
    {"stiffness-field", rendering::Side::contact, rendering::field_parameters("1", 3.0, ""),
     traits_of("stiffness-field")},
};

// Stiff ridges and soft valleys, by a formula that no spline repeats.
double factor_at(const Vec3& p_W_m) {
  return 1.0 + 0.35 * std::sin(210.0 * p_W_m.x() + 0.4) * std::cos(160.0 * p_W_m.y()) +
         0.2 * std::sin(120.0 * p_W_m.y());
}

// A plane z = 0 with a stiffness, perhaps a field on it and a damper along it; `truth`: with the formula.
class UnevenPlane final : public rendering::Predictor {
 public:
  UnevenPlane(MotionColumns motion, bool truth) : motion_(std::move(motion)), truth_(truth) {}
  rendering::Prediction predict(const Model& model) override {
    const NamedParameters* const field = find_entry(model, "stiffness-field");
    const NamedParameters* const viscous = find_entry(model, "viscous-friction");
    std::optional<rendering::SmoothField> of;
    if (field != nullptr) of.emplace(rendering::field_of(field->parameters, "test"));
    rendering::Prediction prediction;
    for (std::size_t i = 0; i < motion_.size(); ++i) {
      const Vec3& p = motion_.p_W_m[i];
      const double depth_m = std::max(0.0, -p.z());
      double k = model.parameters.at("stiffness_N_per_m");
      if (of) k *= std::exp(of->at(p.x(), p.y()));
      if (truth_) k *= factor_at(p);
      Vec3 f(0.0, 0.0, k * depth_m);
      if (viscous != nullptr && i > 0 && depth_m > 0.0) {
        const Vec3 v = (p - motion_.p_W_m[i - 1]) / (motion_.t_s[i] - motion_.t_s[i - 1]);
        f.head<2>() -= viscous->parameters.at("coefficient_N_s_per_m") * v.head<2>();
      }
      prediction.f_W_N.push_back(f);
      prediction.n_W.push_back(depth_m > 0.0 ? Vec3(Vec3::UnitZ()) : Vec3(Vec3::Zero()));
      prediction.depth_m.push_back(depth_m);
      prediction.normal_N.push_back(k * depth_m);
    }
    return prediction;
  }

 private:
  MotionColumns motion_;
  bool truth_;
};

MotionColumns rubbing(double phase) {
  MotionColumns motion;
  for (int i = 0; i < 3600; ++i) {
    const double t = 0.01 * i;
    motion.t_s.push_back(t);
    motion.p_W_m.emplace_back(0.02 * std::sin(1.7 * t + phase), 0.015 * std::sin(0.23 * t + 2.0 * phase),
                              -0.001 - 0.0005 * std::sin(6.0 * t));
  }
  return motion;
}

Model plane() {
  Model model;
  model.renderer = "plane";
  model.parameters["stiffness_N_per_m"] = 900.0;
  return model;
}

struct Uneven {
  InstrumentDescription instrument = small_noise(1.0);
  TwoRecordings recordings;

  explicit Uneven(bool uneven)
      : recordings(of(0.0, 31, uneven), of(0.9, 32, uneven), instrument, plane(),
                   [](const MotionColumns& motion) { return std::make_unique<UnevenPlane>(motion, false); }) {}
  [[nodiscard]] recording::Recording of(double phase, std::uint64_t seed, bool uneven) const {
    const MotionColumns path = rubbing(phase);
    return measured(path, UnevenPlane(path, uneven).predict(plane()).f_W_N, instrument, seed);
  }
};

TEST(Fields, AStiffnessThatDiffersInManyPlacesIsFoundWithItsValues) {
  const Uneven world(true);
  Findings findings;
  findings.search = search_effects(world.recordings.data, plane(), library, {}, [](const std::string&) {});
  conclude(findings, library);
  ASSERT_EQ(findings.search.found.size(), 1U);
  EXPECT_EQ(findings.search.found[0].name, "stiffness-field");
  EXPECT_EQ(findings.search.found[0].holdout_gain > 0.0, true);
  const NamedParameters& entry = *find_entry(findings.search.model, "stiffness-field");
  const rendering::SmoothField field = rendering::field_of(entry.parameters, "test");
  const double base = findings.search.model.parameters.at("stiffness_N_per_m") / 900.0;
  double squares = 0.0;
  double count = 0.0;
  for (const double x : {-0.015, -0.008, 0.0, 0.006, 0.013}) {
    for (const double y : {-0.012, -0.005, 0.001, 0.007, 0.012}) {
      squares += std::pow(base * std::exp(field.at(x, y)) / factor_at(Vec3(x, y, 0.0)) - 1.0, 2);
      count += 1.0;
    }
  }
  // Of a stiffness that differs by 23 % RMS.
  EXPECT_LT(std::sqrt(squares / count), 0.05);
}

TEST(Fields, NoneIsTakenWhereNothingIsMissing) {
  const Uneven world(false);
  const SearchSettings settings;
  SearchState state(world.recordings.data, library, settings, plane());
  state.refit();
  state.renew_noise(state.current.model);
  const auto trials = try_fields(state, baseline_score(state));
  ASSERT_EQ(trials.size(), 1U);
  EXPECT_FALSE(trials[0].verdict.passed());
}

TEST(Fields, ThePriorKnowsNoSlopeAndNoFields) {
  EXPECT_EQ(prior_rows(plane()), 0U);
  Model model = plane();
  std::map<std::string, double> values{{"columns", 5.0}, {"rows", 4.0}, {"bend", 0.1}};
  for (std::size_t row = 0; row < 4; ++row) {
    for (std::size_t column = 0; column < 5; ++column)
      values[rendering::field_coefficient(column, row)] =
          0.02 * static_cast<double>(column) - 0.01 * static_cast<double>(row);
  }
  model.effects = {{"stiffness-field", values, ""}};
  ASSERT_EQ(prior_rows(model), 3U * 4U + 5U * 2U + 20U);
  std::vector<double> rows(prior_rows(model));
  field_prior(model, rows.data());
  double square = 0.0;
  for (const double r : rows) square += r * r;
  // A plane costs its values alone, twenty bends to a standard deviation.
  double values_square = 0.0;
  for (std::size_t row = 0; row < 4; ++row) {
    for (std::size_t column = 0; column < 5; ++column)
      values_square += std::pow(values.at(rendering::field_coefficient(column, row)) / (20.0 * 0.1), 2);
  }
  EXPECT_NEAR(square, values_square, 1e-12);
  model.effects[0].parameters[rendering::field_coefficient(2, 1)] += 0.1;
  field_prior(model, rows.data());
  square = 0.0;
  for (const double r : rows) square += r * r;
  // Two directions, each with second differences of 1, -2 and, where both neighbours have one, 1 bends.
  EXPECT_GT(square, 9.0);
}

}  // namespace
}  // namespace touchstone::discrepancy
