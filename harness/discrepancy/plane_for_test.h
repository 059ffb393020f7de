// A predictor small enough to know by heart, for tests: a plane z = 0, a stiffness, a tangential damper and a bias; and
// a motion over it.
#pragma once

#include <algorithm>
#include <cmath>
#include <utility>

#include "harness/discrepancy/free_parameter.h"
#include "harness/rendering/predictor.h"

namespace touchstone::discrepancy {

class PlanePredictor final : public rendering::Predictor {
 public:
  explicit PlanePredictor(MotionColumns motion) : motion_(std::move(motion)) {}
  rendering::Prediction predict(const rendering::Model& model) override {
    rendering::Prediction prediction;
    const double k = model.parameters.at("stiffness_N_per_m");
    const rendering::NamedParameters* const viscous = find_entry(model, "viscous-friction");
    const rendering::NamedParameters* const bias = find_entry(model, "force-bias");
    // Once, not in each of thousands of samples.
    const double viscous_N_s_per_m = viscous ? viscous->parameters.at("coefficient_N_s_per_m") : 0.0;
    const Vec3 bias_N =
        bias ? Vec3(bias->parameters.at("fx_N"), bias->parameters.at("fy_N"), bias->parameters.at("fz_N"))
             : Vec3(Vec3::Zero());
    for (std::size_t i = 0; i < motion_.size(); ++i) {
      const double depth = std::max(0.0, -motion_.p_W_m[i].z());
      Vec3 f(0.0, 0.0, k * depth);
      if (viscous && depth > 0.0 && i > 0) {
        const Vec3 v = (motion_.p_W_m[i] - motion_.p_W_m[i - 1]) / (motion_.t_s[i] - motion_.t_s[i - 1]);
        f.head<2>() -= viscous_N_s_per_m * v.head<2>();
      }
      f += bias_N;
      prediction.f_W_N.push_back(f);
      prediction.n_W.push_back(depth > 0.0 ? Vec3(Vec3::UnitZ()) : Vec3(Vec3::Zero()));
      prediction.depth_m.push_back(depth);
      prediction.normal_N.push_back(k * depth);
    }
    return prediction;
  }

 private:
  MotionColumns motion_;
};

// Presses and circles for 12 s at 250 Hz; `scale` is the unit of length.
inline MotionColumns hand(double phase, double scale) {
  MotionColumns motion;
  for (int i = 0; i < 3000; ++i) {
    const double t = 0.004 * i;
    motion.t_s.push_back(t);
    motion.p_W_m.emplace_back(scale * 0.02 * std::sin(1.3 * t + phase), scale * 0.015 * std::cos(2.1 * t),
                              scale * (0.001 - 0.002 * std::sin(3.0 * t + phase)));
  }
  return motion;
}

}  // namespace touchstone::discrepancy
