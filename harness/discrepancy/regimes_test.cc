#include "harness/discrepancy/regimes.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "harness/discrepancy/plane_for_test.h"

namespace touchstone::discrepancy {
using rendering::Prediction;

namespace {

constexpr double floor_N = 0.06;

std::size_t samples_in(const std::vector<Regime>& regimes, const std::string& name) {
  const auto found = std::find_if(regimes.begin(), regimes.end(), [&](const Regime& r) { return r.name == name; });
  return found == regimes.end() ? 0 : found->samples;
}

struct PressedPlane {
  double unit;
  rendering::Model model;
  recording::Recording recording;
  PlanePredictor predictor;

  explicit PressedPlane(double unit_m) : unit(unit_m), predictor(hand(0.0, unit_m)) {
    model.renderer = "plane";
    model.parameters["stiffness_N_per_m"] = 900.0 / unit;
    recording.motion = hand(0.0, unit);
    recording.f_W_N = predictor.predict(model).f_W_N;
  }

  [[nodiscard]] std::vector<Regime> sorted(const Prediction& by) {
    const Evidence evidence{&recording, &predictor, nullptr, {}};
    return sort_by_regime(evidence, by, by, floor_N);
  }
};

TEST(Regimes, FreeAirIsFreeUnderAWeightThatTheModelLacks) {
  for (const double unit : {1e-3, 1.0, 1e3}) {
    PressedPlane world(unit);
    const Prediction model = world.predictor.predict(world.model);
    const auto free = static_cast<std::size_t>(
        std::count_if(model.n_W.begin(), model.n_W.end(), [](const Vec3& n) { return n.isZero(); }));
    ASSERT_GT(free, 500U);
    EXPECT_EQ(samples_in(world.sorted(model), "free air"), free);
    for (Vec3& f : world.recording.f_W_N) f += Vec3(0.1, -0.2, -0.8);
    EXPECT_EQ(samples_in(world.sorted(model), "free air"), free);
  }
}

TEST(Regimes, AForceThatComesAndGoesWhereTheModelIsFreeIsContact) {
  for (const double unit : {1e-3, 1.0, 1e3}) {
    PressedPlane world(unit);
    const Prediction truth = world.predictor.predict(world.model);
    const std::size_t free = samples_in(world.sorted(truth), "free air");
    // A model whose surface is never reached.
    Prediction untouched = truth;
    untouched.f_W_N.assign(truth.f_W_N.size(), Vec3::Zero());
    untouched.n_W.assign(truth.n_W.size(), Vec3::Zero());
    const std::size_t seen = samples_in(world.sorted(untouched), "free air");
    EXPECT_GE(seen, free);
    // Presses below the floor are no contact by force.
    const auto light = static_cast<std::size_t>(std::count_if(
        truth.f_W_N.begin(), truth.f_W_N.end(), [](const Vec3& f) { return !f.isZero() && f.norm() <= floor_N; }));
    EXPECT_EQ(seen, free + light);
  }
}

}  // namespace
}  // namespace touchstone::discrepancy
