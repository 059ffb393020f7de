// A fit along a mesh: where the tip is put decides which facet it meets.
#include "harness/discrepancy/joint_fit.h"

#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <numbers>

#include "harness/base/random.h"
#include "harness/discrepancy/nearby_fits.h"

namespace touchstone::discrepancy {
using rendering::Model;
using rendering::Prediction;

namespace {

constexpr double wave_m = 0.02;
constexpr double height_m = 0.001;
constexpr double stiffness_N_per_m = 1000.0;

double smooth_height_m(double x_m) { return height_m * std::sin(2.0 * std::numbers::pi * x_m / wave_m); }

// A wavy surface in facets of a length, of which every step has one normal; the model's registration shifts it.
class FacetsPredictor final : public rendering::Predictor {
 public:
  FacetsPredictor(MotionColumns motion, double facet_m) : motion_(std::move(motion)), facet_m_(facet_m) {}
  Prediction predict(const Model& model) override {
    const double shift_m = find_entry(model, "registration")->parameters.at("dx_m");
    Prediction prediction;
    for (const Vec3& p : motion_.p_W_m) {
      const double x_m = p.x() - shift_m;
      const double left_m = facet_m_ * std::floor(x_m / facet_m_);
      const double slope = (smooth_height_m(left_m + facet_m_) - smooth_height_m(left_m)) / facet_m_;
      const Vec3 n = Vec3(-slope, 0.0, 1.0).normalized();
      const double depth_m = (smooth_height_m(left_m) + slope * (x_m - left_m) - p.z()) * n.z();
      prediction.f_W_N.emplace_back(stiffness_N_per_m * depth_m * n);
      prediction.n_W.push_back(n);
      prediction.depth_m.push_back(depth_m);
      prediction.normal_N.push_back(stiffness_N_per_m * depth_m);
    }
    return prediction;
  }

 private:
  MotionColumns motion_;
  double facet_m_;
};

// Follows the smooth surface at a depth much larger than its waves, so that the normals tell the place.
MotionColumns scan() {
  MotionColumns motion;
  for (int i = 0; i < 4000; ++i) {
    const double t = 0.004 * i;
    const double x = 0.03 * std::sin(0.9 * t) + 0.001 * std::sin(7.0 * t);
    motion.t_s.push_back(t);
    motion.p_W_m.emplace_back(x, 0.0, smooth_height_m(x) - 0.01);
  }
  return motion;
}

double fitted_shift_m(double truth_m, double step_m) {
  const MotionColumns motion = scan();
  FacetsPredictor facets(motion, 0.001);
  FacetsPredictor fine(motion, 1e-6);
  Model model;
  model.renderer = "facets";
  model.instrument.push_back({"registration", {{"dx_m", truth_m}}, ""});
  FitData data;
  data.predictor = &facets;
  data.blocks = make_blocks(motion, 1.0 / 30.0);
  data.measured_N = block_means(data.blocks, fine.predict(model).f_W_N);
  for (std::size_t b = 0; b < data.blocks.size(); ++b) {
    BlockNoise noise;
    noise.n_W = Vec3::UnitZ();
    noise.along_normal_N = noise.tangential_N = 0.05;
    data.noise.push_back(noise);
  }
  model.instrument.front().parameters["dx_m"] = 0.0;
  FreeParameter dx = linear_parameter("registration", "dx_m", 0.01, -0.03, 0.03);
  dx.step = step_m / 0.01;
  const JointFit fit = fit_jointly(data, model, {dx}, 30, false);
  EXPECT_TRUE(fit.ok);
  return find_entry(fit.model, "registration")->parameters.at("dx_m");
}

TEST(JointFit, FindsAShiftAlongFacetsByStepsOfAFacet) {
  for (const double truth_m : {-0.002, -0.0007, 0.0004, 0.0015}) {
    EXPECT_NEAR(fitted_shift_m(truth_m, 0.001), truth_m, 5e-5) << truth_m;
  }
}

TEST(JointFit, AStepAcrossABoundEndsThere) {
  const double at_bound_m = 0.0299;
  EXPECT_TRUE(std::isfinite(fitted_shift_m(at_bound_m, 0.001)));
}

// A spring, and beside it a force that fades with the depth.
class FadingPredictor final : public rendering::Predictor {
 public:
  explicit FadingPredictor(MotionColumns motion) : motion_(std::move(motion)) {}
  Prediction predict(const Model& model) override {
    ++calls;
    const double stiffness = model.parameters.at("stiffness_N_per_m");
    const auto& fading = find_entry(model, "fading")->parameters;
    Prediction prediction;
    for (const Vec3& p : motion_.p_W_m) {
      const double depth_m = -p.z();
      const double force_N = stiffness * depth_m + fading.at("size_N") * std::exp(-depth_m / fading.at("over_m"));
      prediction.f_W_N.emplace_back(0.0, 0.0, force_N);
      prediction.n_W.push_back(Vec3::UnitZ());
      prediction.depth_m.push_back(depth_m);
      prediction.normal_N.push_back(force_N);
    }
    return prediction;
  }
  std::atomic<int> calls = 0;

 private:
  MotionColumns motion_;
};

struct Fading {
  FadingPredictor predictor{presses()};
  Model model;
  std::vector<FreeParameter> parameters{log_base_parameter("stiffness_N_per_m", 10.0, 1e5),
                                        linear_parameter("fading", "size_N", 1.0, -10.0, 10.0),
                                        log_parameter("fading", "over_m", 1e-4, 1e-1)};
  FitData data;

  Fading() {
    model.renderer = "plane";
    model.parameters["stiffness_N_per_m"] = 500.0;
    model.effects.push_back({"fading", {{"size_N", 1.5}, {"over_m", 0.004}}, ""});
    data.predictor = &predictor;
    data.blocks = make_blocks(presses(), 1.0 / 30.0);
    data.measured_N = block_means(data.blocks, predictor.predict(model).f_W_N);
    BlockNoise noise;
    noise.n_W = Vec3::UnitZ();
    noise.along_normal_N = noise.tangential_N = noise_N;
    data.noise.assign(data.blocks.size(), noise);
  }

  // The same presses, measured with other noise; every fiftieth block is off by what no noise explains.
  [[nodiscard]] std::vector<Vec3> measured_again(std::uint64_t seed) const {
    Random random(seed);
    std::vector<Vec3> again = data.measured_N;
    for (std::size_t b = 0; b < again.size(); ++b)
      again[b].z() += noise_N * random.normal() + (b % 50 == 0 ? 0.5 : 0.0);
    return again;
  }

  static constexpr double noise_N = 0.02;
  static MotionColumns presses() {
    MotionColumns motion;
    for (int i = 0; i < 4000; ++i) {
      motion.t_s.push_back(0.004 * i);
      motion.p_W_m.emplace_back(0.0, 0.0, -0.005 * (1.0 - std::cos(1.3 * 0.004 * i)));
    }
    return motion;
  }
};

TEST(NearbyFits, EndWhereAFitOfEachRecordingEnds) {
  const Fading at;
  const NearbyFits nearby(at.data, at.model, at.parameters);
  ASSERT_TRUE(nearby.usable());
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    FitData again = at.data;
    again.measured_N = at.measured_again(seed);
    const JointFit one = fit_jointly(again, at.model, at.parameters, 50, true);
    const int before = at.predictor.calls;
    const JointFit other = nearby.fit(again.measured_N, at.model, 10);
    EXPECT_LE(at.predictor.calls - before, 6) << seed;
    ASSERT_TRUE(one.ok && other.ok) << seed;
    EXPECT_NEAR(other.chi_squared, one.chi_squared, 1e-3 * one.chi_squared) << seed;
    for (Eigen::Index i = 0; i < other.u.size(); ++i)
      EXPECT_NEAR(other.u[i], one.u[i], 0.05 * std::sqrt(one.covariance(i, i))) << seed << " " << i;
  }
}

TEST(NearbyFits, StayWithinBounds) {
  Fading at;
  at.parameters[1] = linear_parameter("fading", "size_N", 1.0, -10.0, 1.5);  // the truth lies on the bound
  const NearbyFits nearby(at.data, at.model, at.parameters);
  ASSERT_TRUE(nearby.usable());
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    FitData again = at.data;
    again.measured_N = at.measured_again(seed);
    const JointFit one = fit_jointly(again, at.model, at.parameters, 50, false);
    const JointFit other = nearby.fit(again.measured_N, at.model, 10);
    EXPECT_LE(other.u[1], 1.5) << seed;
    EXPECT_LT(other.chi_squared, one.chi_squared * 1.001) << seed;
  }
}

TEST(JointFit, EndsWithTheTime) {
  Fading at;
  at.model.parameters["stiffness_N_per_m"] = 100.0;
  at.model.effects.front().parameters = {{"size_N", -5.0}, {"over_m", 0.05}};
  const auto calls_within = [&](double limit_s) {
    TimeBudget budget(limit_s);
    FitData limited = at.data;
    limited.budget = &budget;
    const int before = at.predictor.calls;
    const JointFit fit = fit_jointly(limited, at.model, at.parameters, 100, false);
    EXPECT_TRUE(fit.ok);
    EXPECT_EQ(budget.not_tried().empty(), limit_s > 0.0);
    return at.predictor.calls - before;
  };
  EXPECT_LE(calls_within(0.0), 5);  // where it begins, and the derivatives there
  EXPECT_GT(calls_within(1e6), 15);
}

TEST(JointFit, IsGivenUpWhereItIsHopeless) {
  Fading at;
  // Without the force that fades nothing comes near.
  const std::vector<FreeParameter> stiffness{at.parameters.front()};
  at.model.parameters["stiffness_N_per_m"] = 20.0;
  at.model.effects.front().parameters["size_N"] = 0.0;
  const JointFit whole = fit_jointly(at.data, at.model, stiffness, 100, false);
  const JointFit reached = fit_jointly_below(2.0 * whole.chi_squared, at.data, at.model, stiffness, 100);
  EXPECT_EQ(reached.chi_squared, whole.chi_squared);
  at.model.parameters["stiffness_N_per_m"] = whole.model.parameters.at("stiffness_N_per_m");
  at.model.effects.front().parameters = {{"size_N", 0.1}, {"over_m", 0.09}};
  int before = at.predictor.calls;
  fit_jointly_below(0.0, at.data, at.model, at.parameters, 100);
  const int given_up = at.predictor.calls - before;
  before = at.predictor.calls;
  fit_jointly(at.data, at.model, at.parameters, 100, false);
  EXPECT_LE(given_up, at.predictor.calls - before);
}

}  // namespace
}  // namespace touchstone::discrepancy
