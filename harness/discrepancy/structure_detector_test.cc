// Forces that no library has, small enough that the sum of the residual does not show them: each is seen.
#include "harness/discrepancy/structure_detector.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "harness/discrepancy/evidence.h"
#include "harness/discrepancy/model_edit.h"
#include "harness/discrepancy/plane_for_test.h"

namespace touchstone::discrepancy {
using recording::Recording;

namespace {

// A force beside the plane's, at the true position.
using Hidden = std::function<Vec3(double t_s, const Vec3& p, double unit)>;

rendering::Model plane(double unit) {
  rendering::Model model;
  model.renderer = "plane";
  model.parameters["stiffness_N_per_m"] = 900.0 / unit;
  return model;
}

// What the stiffness fitted alone leaves, and what the detector says of it.
struct Seen {
  double chi_squared_per_degree = 0.0;
  Structure structure;
};

Seen look(double unit, std::uint64_t seed, const Hidden& hidden) {
  InstrumentDescription instrument;
  instrument.force_noise_N = 0.02;
  instrument.force_noise_time_constant_s = 0.01;
  instrument.position_noise_m = 5e-5 * unit;
  const rendering::MakePredictor make = [](const MotionColumns& motion) {
    return std::make_unique<PlanePredictor>(motion);
  };
  Random random(seed);
  const auto measure = [&](const MotionColumns& path) {
    Recording recording;
    recording.f_W_N = PlanePredictor(path).predict(plane(unit)).f_W_N;
    recording.motion = with_position_noise(path, instrument, random);
    const auto noise = force_noise(path, instrument, random);
    for (std::size_t i = 0; i < noise.size(); ++i) {
      recording.f_W_N[i] += noise[i] + hidden(path.t_s[i], path.p_W_m[i], unit);
    }
    return recording;
  };
  const Recording train = measure(hand(0.0, unit));
  const Recording holdout = measure(hand(1.1, unit));
  const auto train_predictor = make(train.motion);
  const auto holdout_predictor = make(holdout.motion);
  NoiseModel train_noise(train.motion, train_predictor->predict(plane(unit)).n_W, instrument, make, 1, 3);
  NoiseModel holdout_noise(holdout.motion, holdout_predictor->predict(plane(unit)).n_W, instrument, make, 2, 3);
  const Evidence learn{&train, train_predictor.get(), &train_noise, {}};
  const Evidence judge{&holdout, holdout_predictor.get(), &holdout_noise, {}};
  const double window_s = block_window_s(60.0, train.motion);
  const FitData learnt = fit_data(learn, plane(unit), window_s);
  const FitData judged = fit_data(judge, plane(unit), window_s);
  const std::vector<FreeParameter> parameters{base_stiffness(plane(unit))};
  const JointFit fit = fit_jointly(learnt, plane(unit), parameters, 12, true);
  const auto refits = bootstrap_fits(learn, learnt, fit, parameters, 6);
  EXPECT_EQ(refits.size(), NoiseModel::null_simulations);
  Seen seen;
  seen.chi_squared_per_degree = chi_squared(judged, fit.model) / (3.0 * static_cast<double>(judged.blocks.size()));
  seen.structure =
      detect_structure({&train, &learnt, &train_noise}, {&holdout, &judged, &holdout_noise}, fit.model, refits);
  return seen;
}

class StructureAtScale : public ::testing::TestWithParam<double> {};

TEST_P(StructureAtScale, IsNoneWhereNothingIsMissing) {
  for (const std::uint64_t seed : {11U, 12U, 13U, 14U}) {
    const Seen seen = look(GetParam(), seed, [](double, const Vec3&, double) { return Vec3(Vec3::Zero()); });
    EXPECT_FALSE(seen.structure.found()) << "seed " << seed << ", " << seen.structure.view << ' '
                                         << seen.structure.share << " of " << seen.structure.bar;
  }
}

TEST_P(StructureAtScale, ALayerBelowIsSeenByTheDepth) {
  const Seen seen = look(GetParam(), 21, [](double, const Vec3& p, double unit) {
    const double beyond_m = std::max(0.0, -p.z() - 0.0006 * unit);
    return Vec3(0.0, 0.0, 500.0 / unit * beyond_m);
  });
  EXPECT_LT(seen.chi_squared_per_degree, 2.0);  // the sum alone says nothing
  EXPECT_TRUE(seen.structure.found()) << seen.structure.share << " of " << seen.structure.bar;
  EXPECT_EQ(seen.structure.view, "depth");
}

TEST_P(StructureAtScale, AStiffnessThatFadesIsSeen) {
  const Seen seen = look(GetParam(), 22, [](double t_s, const Vec3& p, double unit) {
    return Vec3(0.0, 0.0, -260.0 / unit * (1.0 - std::exp(-t_s / 3.0)) * std::max(0.0, -p.z()));
  });
  EXPECT_LT(seen.chi_squared_per_degree, 2.0);
  EXPECT_TRUE(seen.structure.found()) << seen.structure.share << " of " << seen.structure.bar;
}

INSTANTIATE_TEST_SUITE_P(Units, StructureAtScale, ::testing::Values(1e-3, 1.0, 1e3));

}  // namespace
}  // namespace touchstone::discrepancy
