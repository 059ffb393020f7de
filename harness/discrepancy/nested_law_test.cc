// Which law of friction, where the tracker's noise hides the way of a slow tip: a plane under a bristle whose
// coefficient falls with speed, or does not.
#include "harness/discrepancy/nested_law.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <optional>

#include "harness/discrepancy/catalogue_for_test.h"
#include "harness/discrepancy/damped_plane_for_test.h"
#include "harness/discrepancy/model_edit.h"
#include "harness/discrepancy/plane_for_test.h"
#include "harness/discrepancy/two_recordings_for_test.h"

namespace touchstone::discrepancy {
using rendering::Candidate;
using rendering::Model;
using rendering::NamedParameters;
using rendering::Prediction;
using rendering::Side;

namespace {

// A play operator on a plane; the coefficient by the speed of the tip while it slides, the static one while it sticks.
class BristlePredictor final : public rendering::Predictor {
 public:
  explicit BristlePredictor(const MotionColumns& motion) : plane_(motion), motion_(motion) {}
  Prediction predict(const Model& model) override {
    Prediction prediction = plane_.predict(model);
    for (const NamedParameters& entry : model.effects) add(entry, prediction);
    if (const NamedParameters* const lag = find_entry(model, "time-lag"))
      delay(lag->parameters.at("lag_s"), prediction.f_W_N);
    return prediction;
  }

 private:
  void add(const NamedParameters& entry, Prediction& prediction) const {
    const auto& p = entry.parameters;
    const double length_m = p.at("presliding_m");
    const bool falls = entry.name == "stribeck-friction";
    Vec3 z = Vec3::Zero();
    for (std::size_t i = 1; i < motion_.size(); ++i) {
      if (prediction.n_W[i].isZero()) {
        z.setZero();
        continue;
      }
      Vec3 step = motion_.p_W_m[i] - motion_.p_W_m[i - 1];
      step.z() = 0.0;
      z += step;
      const double over = z.norm() / length_m;
      if (over > 1.0) z /= over;
      double mu = p.at("mu_dynamic");
      if (falls) {
        const double ratio = step.norm() / (motion_.t_s[i] - motion_.t_s[i - 1]) / p.at("stribeck_velocity_m_per_s");
        mu += (p.at("mu_static") - mu) * std::exp(-ratio * ratio);
      }
      prediction.f_W_N[i] -= mu * prediction.normal_N[i] / length_m * z;
    }
  }

  // The samples are evenly spaced.
  void delay(double lag_s, std::vector<Vec3>& f_W_N) const {
    const double samples = lag_s / (motion_.t_s[1] - motion_.t_s[0]);
    const auto whole = static_cast<std::size_t>(samples);
    const double share = samples - static_cast<double>(whole);
    for (std::size_t i = f_W_N.size(); i-- > 0;) {
      const std::size_t later = i > whole ? i - whole : 0;
      const std::size_t earlier = later > 0 ? later - 1 : 0;
      f_W_N[i] = (1.0 - share) * f_W_N[later] + share * f_W_N[earlier];
    }
  }

  PlanePredictor plane_;
  MotionColumns motion_;
};

// To and fro with slow turns and rests, under a depth of 1 mm that breathes by a share of it.
MotionColumns strokes(double phase, double unit, double breath = 0.2) {
  MotionColumns motion;
  for (int i = 0; i < 4000; ++i) {
    const double t = 0.004 * i;
    const double swing = std::sin(1.9 * t + phase);
    motion.t_s.push_back(t);
    motion.p_W_m.emplace_back(unit * 0.02 * swing * swing * swing, unit * 0.006 * std::sin(0.7 * t),
                              unit * 0.001 * (-1.0 - breath * std::sin(2.7 * t + phase)));
  }
  return motion;
}

struct Strokes {
  const std::vector<rendering::ParameterDeclaration> coefficients{{"mu_static", "1", 0.0, 5.0, 0.0, ""},
                                                                  {"mu_dynamic", "1", 0.0, 5.0, 0.0, ""}};
  std::vector<Candidate> library{
      {"coulomb-friction", Side::contact, coefficients, traits_of("coulomb-friction")},
      {"stribeck-friction", Side::contact, coefficients, traits_of("stribeck-friction")},
  };
  Model found;  // with plain friction
  std::optional<TwoRecordings> recordings;
  SearchSettings settings;

  // Friction of coefficients `high`, at rest, and `low`.
  Strokes(double high, double low, double unit) {
    Model truth;
    truth.renderer = "plane";
    truth.parameters["stiffness_N_per_m"] = 900.0 / unit;
    found = truth;
    truth.effects.push_back({"stribeck-friction",
                             {{"mu_static", high},
                              {"mu_dynamic", low},
                              {"stribeck_velocity_m_per_s", 0.012 * unit},
                              {"presliding_m", 1e-5 * unit}},
                             ""});
    found.effects.push_back(
        {"coulomb-friction", {{"mu_static", low}, {"mu_dynamic", low}, {"presliding_m", 1e-4 * unit}}, ""});
    const InstrumentDescription instrument = small_noise(unit);
    const auto measure = [&](double phase, std::uint64_t seed) {
      const MotionColumns path = strokes(phase, unit);
      return measured(path, BristlePredictor(path).predict(truth).f_W_N, instrument, seed);
    };
    recordings.emplace(measure(0.0, 31), measure(1.1, 32), instrument, found,
                       [](const MotionColumns& motion) { return std::make_unique<BristlePredictor>(motion); });
  }

  [[nodiscard]] std::vector<LargerLaw> weigh() const {
    SearchState state(recordings->data, library, settings, found);
    state.parameters =
        joined(state.parameters, state.options(library.front(), without_entry(found, "coulomb-friction")).parameters);
    state.refit();
    state.renew_noise(state.current.model);
    state.refit();
    return weigh_larger_laws(state);
  }
};

TEST(NestedLaw, FrictionThatFallsWithSpeedTakesThePlaceOfPlainFrictionAtEveryUnit) {
  for (const double unit : {1e-3, 1.0, 1e3}) {
    const auto laws = Strokes(0.6, 0.25, unit).weigh();
    ASSERT_EQ(laws.size(), 1U) << unit;
    EXPECT_EQ(laws.front().in_place_of, "coulomb-friction");
    const Trial& trial = laws.front().trial;
    EXPECT_EQ(trial.name, "stribeck-friction");
    EXPECT_EQ(trial.verdict.words, "") << unit;
    EXPECT_GT(std::min(trial.train_gain, trial.validation_gain), SearchSettings{}.law_gain) << unit;
    const auto& fitted = find_entry(trial.fit.model, "stribeck-friction")->parameters;
    EXPECT_NEAR(fitted.at("mu_dynamic"), 0.25, 0.02) << unit;
    EXPECT_GT(fitted.at("mu_static"), 0.4) << unit;
    EXPECT_LT(fitted.at("mu_static"), 0.8) << unit;
  }
}

TEST(NestedLaw, PlainFrictionStays) {
  const auto laws = Strokes(0.4, 0.4, 1.0).weigh();
  ASSERT_EQ(laws.size(), 1U);
  EXPECT_THAT(laws.front().trial.verdict.words, ::testing::HasSubstr("leave the cone of fast sliding by"));
}

// Plain friction with a short path, seen by a sensor that lags; the search has friction by now.
std::vector<Trial> beside_friction(double lag_s, std::uint64_t seed) {
  const std::vector<rendering::ParameterDeclaration> coefficients{{"mu_static", "1", 0.0, 5.0, 0.0, ""},
                                                                  {"mu_dynamic", "1", 0.0, 5.0, 0.0, ""}};
  const std::vector<Candidate> library{
      {"coulomb-friction", Side::contact, coefficients, traits_of("coulomb-friction")},
      {"time-lag", Side::instrument, {{"lag_s", "s", 0.0, 1.0, 0.0, ""}}, traits_of("time-lag")}};
  Model found;
  found.renderer = "plane";
  found.parameters["stiffness_N_per_m"] = 900.0;
  found.effects.push_back({"coulomb-friction", {{"mu_static", 0.2}, {"mu_dynamic", 0.2}, {"presliding_m", 1e-5}}, ""});
  InstrumentDescription instrument = small_noise(1.0);
  instrument.position_noise_m = 1.2e-4;
  const auto measure = [&](double phase, std::uint64_t number) {
    const MotionColumns path = strokes(phase, 1.0, 0.9);
    Model truth = found;
    truth.instrument.push_back({"time-lag", {{"lag_s", lag_s}}, ""});
    return measured(path, BristlePredictor(path).predict(truth).f_W_N, instrument, number);
  };
  const TwoRecordings recordings(
      measure(0.0, seed), measure(1.1, seed + 1), instrument, found,
      [](const MotionColumns& motion) { return std::make_unique<BristlePredictor>(motion); });
  const SearchSettings settings;
  SearchState state(recordings.data, library, settings, found);
  state.parameters =
      joined(state.parameters, state.options(library.front(), without_entry(found, "coulomb-friction")).parameters);
  state.refit();
  state.renew_noise(state.current.model);
  state.refit();
  return weigh_by_likelihood(state, try_candidates(state, baseline_score(state)));
}

TEST(WeighedByLikelihood, ALagIsSeenBesideFrictionWhosePathNoiseHasMadeTooLong) {
  for (const std::uint64_t seed : {71U, 73U}) {
    const auto passed = beside_friction(0.03, seed);
    ASSERT_EQ(passed.size(), 1U) << seed;
    EXPECT_EQ(passed.front().name, "time-lag");
    EXPECT_NEAR(find_entry(passed.front().fit.model, "time-lag")->parameters.at("lag_s"), 0.03, 0.003) << seed;
    EXPECT_NEAR(find_entry(passed.front().fit.model, "coulomb-friction")->parameters.at("mu_dynamic"), 0.2, 0.02);
  }
}

TEST(WeighedByLikelihood, NoLagIsSeenBesideFrictionAlone) {
  for (const std::uint64_t seed : {71U, 73U}) EXPECT_TRUE(beside_friction(0.0, seed).empty()) << seed;
}

TEST(NestedLaw, ALawWithoutALargerOneIsNotAskedFor) {
  Strokes world(0.4, 0.4, 1.0);
  world.library.pop_back();
  EXPECT_TRUE(world.weigh().empty());
}

std::vector<Trial> likely_trials(double damper_N_s_per_m) {
  const DampedPlane world(damper_N_s_per_m);
  const auto measure = [&](double phase, std::uint64_t seed) {
    const MotionColumns path = hand(phase, 1.0);
    return measured(path, PlanePredictor(path).predict(world.truth).f_W_N, world.instrument, seed);
  };
  const TwoRecordings recordings(measure(0.0, 41), measure(1.1, 42), world.instrument, world.start,
                                 [](const MotionColumns& motion) { return std::make_unique<PlanePredictor>(motion); });
  const SearchSettings settings;
  SearchState state(recordings.data, world.library, settings, world.start);
  state.refit();
  state.renew_noise(state.current.model);
  state.refit();
  return weigh_by_likelihood(state, try_candidates(state, baseline_score(state)));
}

TEST(WeighedByLikelihood, ADamperThatActsPassesWithItsCoefficient) {
  const auto passed = likely_trials(4.0);
  ASSERT_EQ(passed.size(), 1U);
  EXPECT_EQ(passed.front().name, "viscous-friction");
  EXPECT_GT(std::min(passed.front().train_gain, passed.front().validation_gain), passed.front().null_threshold);
  const auto& fitted = find_entry(passed.front().fit.model, "viscous-friction")->parameters;
  EXPECT_NEAR(fitted.at("coefficient_N_s_per_m"), 4.0, 0.2);
}

TEST(WeighedByLikelihood, NothingPassesWhereNothingIsMissing) { EXPECT_TRUE(likely_trials(0.0).empty()); }

// A plane under damping that grows with the depth (Hunt and Crossley 1975, equation 2), or a Maxwell arm.
class YieldingPlane final : public rendering::Predictor {
 public:
  explicit YieldingPlane(const MotionColumns& motion) : plane_(motion), motion_(motion) {}
  Prediction predict(const Model& model) override {
    Prediction prediction = plane_.predict(model);
    const NamedParameters* const damper = find_entry(model, "hunt-crossley");
    const NamedParameters* const arm = find_entry(model, "stress-relaxation");
    double arm_N = 0.0;
    for (std::size_t i = 1; i < motion_.size(); ++i) {
      if (prediction.n_W[i].isZero()) {
        arm_N = 0.0;
        continue;
      }
      const double dt_s = motion_.t_s[i] - motion_.t_s[i - 1];
      const double pressed_m = prediction.depth_m[i] - prediction.depth_m[i - 1];
      double more_N = 0.0;
      if (damper != nullptr)
        more_N = damper->parameters.at("coefficient_N_s_per_m2") * prediction.depth_m[i] * pressed_m / dt_s;
      if (arm != nullptr) {
        arm_N = (arm_N + arm->parameters.at("ratio") * model.parameters.at("stiffness_N_per_m") * pressed_m) *
                std::exp(-dt_s / arm->parameters.at("time_constant_s"));
        more_N = arm_N;
      }
      prediction.f_W_N[i].z() += more_N;
      prediction.normal_N[i] += more_N;
    }
    return prediction;
  }

 private:
  PlanePredictor plane_;
  MotionColumns motion_;
};

NamedParameters damper() { return {"hunt-crossley", {{"coefficient_N_s_per_m2", 9e4}}, ""}; }
NamedParameters arm(double time_constant_s) {
  return {"stress-relaxation", {{"ratio", 0.8}, {"time_constant_s", time_constant_s}}, ""};
}

std::vector<FreeParameter> free_of(const NamedParameters& entry) {
  std::vector<FreeParameter> free{log_base_parameter("stiffness_N_per_m", 90.0, 9000.0)};
  for (const auto& [name, value] : entry.parameters)
    free.push_back(log_parameter(entry.name, name, 0.02 * value, 50.0 * value));
  return free;
}

// Whether `other` is the likelier in the place of `found` where `truth` acts.
bool takes_the_place(const NamedParameters& truth, const NamedParameters& found, const NamedParameters& other) {
  const auto with = [](const NamedParameters& entry) {
    Model model;
    model.renderer = "plane";
    model.parameters["stiffness_N_per_m"] = 900.0;
    model.effects = {entry};
    return model;
  };
  const InstrumentDescription instrument = small_noise(1.0);
  const auto measure = [&](double phase, std::uint64_t seed) {
    const MotionColumns path = hand(phase, 1.0);
    return measured(path, YieldingPlane(path).predict(with(truth)).f_W_N, instrument, seed);
  };
  const TwoRecordings recordings(measure(0.0, 51), measure(1.1, 52), instrument, with(found),
                                 [](const MotionColumns& motion) { return std::make_unique<YieldingPlane>(motion); });
  const std::vector<Candidate> library;
  const SearchSettings settings;
  SearchState state(recordings.data, library, settings, with(found));
  state.parameters = free_of(found);
  state.refit();
  state.renew_noise(state.current.model);
  state.refit();
  return likelier_in_place(state, with(other), free_of(other));
}

TEST(LikelierInPlace, DampingAndRelaxationTakeTheirOwnPlaceAndNoOther) {
  EXPECT_TRUE(takes_the_place(damper(), arm(0.03), damper()));
  EXPECT_FALSE(takes_the_place(damper(), damper(), arm(0.03)));
  EXPECT_TRUE(takes_the_place(arm(0.3), damper(), arm(0.3)));
  EXPECT_FALSE(takes_the_place(arm(0.3), arm(0.3), damper()));
}

}  // namespace
}  // namespace touchstone::discrepancy
