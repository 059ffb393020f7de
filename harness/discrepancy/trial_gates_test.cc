// What the mesh's makers declare as its error is not missing.
#include "harness/discrepancy/trial_gates.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <vector>

#include "harness/discrepancy/catalogue_for_test.h"
#include "harness/discrepancy/damped_plane_for_test.h"
#include "harness/discrepancy/plane_for_test.h"
#include "harness/discrepancy/two_recordings_for_test.h"

namespace touchstone::discrepancy {
using rendering::MakePredictor;

namespace {

rendering::NamedParameters registration(double dx_m, double dz_m, double ry_rad) {
  return {"registration", {{"dx_m", dx_m}, {"dy_m", 0.0}, {"dz_m", dz_m}, {"rx_rad", 0.0}, {"ry_rad", ry_rad}}, ""};
}

TEST(MeshError, OfARegistrationIsWhatItMovesAlongTheNormals) {
  const MotionColumns motion = hand(0.0, 1.0);
  const std::vector<Vec3> up(motion.size(), Vec3::UnitZ());
  EXPECT_NEAR(surface_displacement_m(traits_of("registration"), registration(5e-3, 0.0, 0.0), motion, up), 0.0,
              1e-15);  // along a plane
  EXPECT_NEAR(surface_displacement_m(traits_of("registration"), registration(5e-3, 2e-4, 0.0), motion, up), 2e-4,
              1e-15);
  double squares = 0.0;
  for (const Vec3& p : motion.p_W_m) squares += p.x() * p.x();
  const double spread_m = std::sqrt(squares / static_cast<double>(motion.size()));
  EXPECT_NEAR(surface_displacement_m(traits_of("registration"), registration(0.0, 0.0, 0.01), motion, up),
              0.01 * spread_m, 1e-12);
  // A slope makes the shift along it felt, and free samples say nothing.
  std::vector<Vec3> slope(motion.size(), Vec3(0.6, 0.0, 0.8));
  slope.front().setZero();
  EXPECT_NEAR(surface_displacement_m(traits_of("registration"), registration(1e-3, 0.0, 0.0), motion, slope), 6e-4,
              1e-15);
}

TEST(MeshError, WhatItExplainsAsWellIsNotMissing) {
  Trial hill;
  hill.name = "surface-geometry";
  hill.train_gain = 300.0;
  hill.validation_gain = 200.0;
  hill.verdict = maybe_within_mesh();
  Trial map;
  map.name = "stiffness-map";
  map.train_gain = 250.0;
  map.validation_gain = 150.0;
  EXPECT_EQ(explained_by_mesh({hill, map}, map)->name, "surface-geometry");
  map.validation_gain = 210.0;
  EXPECT_EQ(explained_by_mesh({hill, map}, map), nullptr);
  map.validation_gain = 150.0;
  hill.verdict = "too small to matter";
  EXPECT_EQ(explained_by_mesh({hill, map}, map), nullptr);
}

// By its whole interval: a bump of 0.5 mm that may be one of 0.4 mm, on a mesh whose makers declare 0.3 mm, or 0.35.
TEST(MeshError, IsExceededByTheLeastSizeOfABump) {
  const MakePredictor make = [](const MotionColumns& motion) { return std::make_unique<PlanePredictor>(motion); };
  for (const double declared_m : {3.0e-4, 3.5e-4}) {
    DampedPlane world(0.0);
    world.instrument.geometry_error_m = declared_m;
    const auto measure = [&](double phase, std::uint64_t seed) {
      const MotionColumns path = hand(phase, 1.0);
      return measured(path, PlanePredictor(path).predict(world.truth).f_W_N, world.instrument, seed);
    };
    const TwoRecordings recordings(measure(0.0, 51), measure(1.1, 52), world.instrument, world.start, make);
    const SearchSettings settings;
    const SearchState state(recordings.data, world.library, settings, world.start);
    for (const double amplitude_m : {5e-4, -5e-4}) {
      JointFit fit;
      fit.model = world.start;
      fit.model.instrument = {{"surface-geometry", {{"amplitude_m", amplitude_m}}, "/instrument/0"}};
      const std::vector<FreeParameter> parameters{linear_parameter("surface-geometry", "amplitude_m", 1e-3, -5.0, 5.0)};
      fit.u = Eigen::VectorXd::Constant(1, 1e3 * amplitude_m);
      fit.covariance = Eigen::MatrixXd::Constant(1, 1, std::pow(0.1 / 1.96, 2));
      fit.at_bound = {false};
      fit.ok = true;
      EXPECT_NEAR(least_size95(fit, parameters, {}, "surface-geometry", "amplitude_m"), 4e-4, 1e-6);
      EXPECT_EQ(displaces_for_sure(state, fit, parameters, {}, "surface-geometry"), 1.25 * declared_m < 4e-4);
      fit.covariance *= 100.0;  // its sign is not sure
      EXPECT_FALSE(displaces_for_sure(state, fit, parameters, {}, "surface-geometry"));
      // What does not move the surface is no error of a mesh.
      fit.model.instrument.front().name = "force-bias";
      fit.model.instrument.front().parameters = {{"fz_N", 0.1}};
      EXPECT_TRUE(displaces_for_sure(state, fit, parameters, {}, "force-bias"));
    }
  }
}

// A relaxation that removes 7 % of a large error is no detail; 7 % of what noise leaves may be one.
TEST(LeastShare, IsSmallerWhileTheModelLeavesFarMoreThanNoise) {
  rendering::Model truth;
  truth.renderer = "plane";
  truth.parameters["stiffness_N_per_m"] = 900.0;
  const InstrumentDescription instrument = small_noise(1.0);
  const MakePredictor make = [](const MotionColumns& motion) { return std::make_unique<PlanePredictor>(motion); };
  const auto measure = [&](double phase, std::uint64_t seed) {
    const MotionColumns path = hand(phase, 1.0);
    return measured(path, PlanePredictor(path).predict(truth).f_W_N, instrument, seed);
  };
  const TwoRecordings recordings(measure(0.0, 1), measure(1.1, 2), instrument, truth, make);
  const SearchSettings settings;
  const std::vector<rendering::Candidate> none;
  const SearchState state(recordings.data, none, settings, truth);
  rendering::Model soft = truth;
  soft.parameters["stiffness_N_per_m"] = 450.0;
  EXPECT_EQ(state.least_share(truth), settings.minimum_share);
  EXPECT_EQ(state.least_share(soft), settings.clear_share);
}

// Circles with one dart to the side in each kind of blocks, under a damper: the darts have nearly all of the error and,
// since what they leave counts as noise of all blocks, of the gain. Two blocks are no evidence, but the others, which
// it explains to the last as well, are.
TEST(FewBlocks, HideNoEffectThatMakesAllOthersLikelier) {
  const DampedPlane world(4.0);
  const MakePredictor make = [](const MotionColumns& motion) { return std::make_unique<PlanePredictor>(motion); };
  const auto measure = [&](double phase, std::uint64_t seed) {
    MotionColumns path = hand(phase, 1.0);
    for (std::size_t i = 0; i < path.size(); ++i) {
      // In contact in the first recording; the second one is not asked.
      for (const double dart_s : {4.5, 9.1}) path.p_W_m[i].x() += 0.03 * std::tanh((path.t_s[i] - dart_s) / 0.04);
    }
    return measured(path, PlanePredictor(path).predict(world.truth).f_W_N, world.instrument, seed);
  };
  const TwoRecordings recordings(measure(0.0, 41), measure(1.1, 42), world.instrument, world.start, make);
  const SearchSettings settings;
  SearchState state(recordings.data, world.library, settings, world.start);
  state.refit();
  state.renew_noise(state.current.model);
  state.refit();
  const BaselineScore baseline = baseline_score(state);
  const auto trial = try_candidate(state, baseline, world.library.front());
  ASSERT_TRUE(trial.has_value());
  // By chi-squared under the misfit of the smaller model it comes from a few blocks alone.
  EXPECT_LT(trial->validation_gain, settings.gain_errors * trial->validation_error);
  EXPECT_LT(trial->train_gain + trial->validation_gain,
            settings.both_gain_errors * std::hypot(trial->train_error, trial->validation_error));
  EXPECT_EQ(cheap_gates(state, baseline, *trial).words, "");
}

}  // namespace
}  // namespace touchstone::discrepancy
