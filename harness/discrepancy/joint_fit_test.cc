// A fit along a mesh: where the tip is put decides which facet it meets.
#include "harness/discrepancy/joint_fit.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace touchstone::discrepancy {
namespace {

constexpr double wave_m = 0.02;
constexpr double height_m = 0.001;
constexpr double stiffness_N_per_m = 1000.0;

double smooth_height_m(double x_m) { return height_m * std::sin(2.0 * std::numbers::pi * x_m / wave_m); }

// A wavy surface in facets of a length, of which every step has one normal; the model's registration shifts it.
class FacetsPredictor final : public Predictor {
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

}  // namespace
}  // namespace touchstone::discrepancy
