// A device's figures found again from a recording of its own simulation, through an encoder, at several scales.
#include "servo/device_fit.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>

#include "harness/base/error.h"
#include "harness/base/random.h"
#include "servo/linear_wall_for_test.h"

namespace touchstone::servo {
namespace {

// A soft spring, and a force that jumps to and fro at random: what a latency shows in.
class Shaking final : public rendering::Renderer {
 public:
  Shaking(double stiffness, double force_N) : stiffness_(stiffness), force_N_(force_N) {}

 protected:
  void do_reset() override { random_ = Random(3); }
  rendering::StepResult do_step(const rendering::TipState& tip) noexcept override {
    if (step_++ % 7 == 0) sign_ = random_.uniform() < 0.5 ? -1.0 : 1.0;
    rendering::StepResult out;
    out.f_W_N = Vec3(0.0, 0.0, sign_ * force_N_ - stiffness_ * tip.p_W_m.z());
    return out;
  }

 private:
  double stiffness_, force_N_, sign_ = 1.0;
  Random random_{3};
  std::size_t step_ = 0;
};

struct FitScale {
  double mass_kg, period_s, stiffness, force_N;
};
const std::vector<FitScale> kFitScales{{0.05, 1e-3, 100.0, 2.0}, {0.3, 5e-4, 2000.0, 10.0}, {2.0, 1e-2, 40.0, 5.0}};

LoopParameters device_of(const FitScale& scale, double latency) {
  LoopParameters own;
  own.period_s = scale.period_s;
  own.axis.mass_kg = scale.mass_kg;
  const double w = std::sqrt(scale.stiffness / scale.mass_kg);
  own.axis.damping_N_s_per_m = scale.mass_kg * w * (0.1 + 3.0 * w * scale.period_s);  // the late spring stays stable
  own.axis.friction_N = 0.05 * scale.force_N;
  own.latency_s = latency * scale.period_s;
  own.resolution_m = 1e-3 * scale.force_N / scale.stiffness;
  return own;
}

// With nobody's hand on it.
recording::Recording recorded(rendering::Renderer& renderer, const LoopParameters& own) {
  const LoopTrace trace = run_loop(renderer, struck(own, 0.0, 1500.0 * own.period_s), own);
  recording::Recording out;
  out.source = "recorded";
  for (std::size_t i = 0; i < trace.size(); ++i) {
    out.motion.t_s.push_back(trace.t_s[i]);
    out.motion.p_W_m.push_back(own.resolution_m * (trace.tip_W_m[i] / own.resolution_m).array().round().matrix());
    out.f_W_N.push_back(trace.commanded_W_N[i]);
  }
  return out;
}

double error(const FittedFigure& figure, double truth) { return figure.value / truth - 1.0; }

TEST(DeviceFit, FindsMassFrictionAndLatencyThroughTheEncoder) {
  for (const FitScale& scale : kFitScales) {
    for (const double latency : {0.0, 1.7, 4.2}) {
      const LoopParameters own = device_of(scale, latency);
      Shaking renderer(scale.stiffness, scale.force_N);
      const DeviceFit fit = fit_device(recorded(renderer, own));
      const double late = fit.latency_s.value / scale.period_s - latency;
      fmt::print(
          "{} kg, {:.1f} periods late: mass {:+.2f} %, viscous {:+.2f} %, dry {:+.2f} %, latency {:+.3f} periods\n",
          scale.mass_kg, latency, 100.0 * error(fit.mass_kg, own.axis.mass_kg),
          100.0 * error(fit.damping_N_s_per_m, own.axis.damping_N_s_per_m),
          100.0 * error(fit.friction_N, own.axis.friction_N), late);
      EXPECT_NEAR(error(fit.mass_kg, own.axis.mass_kg), 0.0, 0.02);
      EXPECT_NEAR(error(fit.damping_N_s_per_m, own.axis.damping_N_s_per_m), 0.0, 0.05);
      EXPECT_NEAR(error(fit.friction_N, own.axis.friction_N), 0.0, 0.05);
      EXPECT_NEAR(late, 0.0, 0.1);
      EXPECT_TRUE(fit.mass_kg.determined && fit.damping_N_s_per_m.determined && fit.friction_N.determined);
      EXPECT_LT(fit.residual_m, own.resolution_m);
    }
  }
}

// Let go beside a soft spring, damping and latency do nearly the same to a slow swing: their errors say so.
TEST(DeviceFit, OfAReleaseTheErrorsSayWhatIsNotKnown) {
  for (const FitScale& scale : kFitScales) {
    const LoopParameters own = device_of(scale, 1.7);
    LinearWall spring(scale.stiffness, 10.0 * scale.force_N / scale.stiffness);
    const DeviceFit fit = fit_device(recorded(spring, own));
    fmt::print("{} kg: mass {:+.2f} %, viscous {:+.1f} % +- {:.1f} %, latency {:+.2f} +- {:.2f} periods\n",
               scale.mass_kg, 100.0 * error(fit.mass_kg, own.axis.mass_kg),
               100.0 * error(fit.damping_N_s_per_m, own.axis.damping_N_s_per_m),
               100.0 * fit.damping_N_s_per_m.error95 / own.axis.damping_N_s_per_m,
               fit.latency_s.value / scale.period_s - 1.7, fit.latency_s.error95 / scale.period_s);
    EXPECT_NEAR(error(fit.mass_kg, own.axis.mass_kg), 0.0, 0.02);
    EXPECT_NEAR(fit.damping_N_s_per_m.value, own.axis.damping_N_s_per_m, 2.0 * fit.damping_N_s_per_m.error95);
    EXPECT_NEAR(fit.latency_s.value, own.latency_s, 2.0 * fit.latency_s.error95);
  }
}

TEST(DeviceFit, RefusesWhatShowsNothing) {
  recording::Recording still;
  for (int i = 0; i < 100; ++i) {
    still.motion.t_s.push_back(i * 1e-3);
    still.motion.p_W_m.push_back(Vec3::Zero());
    still.f_W_N.push_back(Vec3::UnitX());
  }
  EXPECT_THROW(fit_device(still), BadData);
  recording::Recording moved = still;
  for (std::size_t i = 0; i < 100; ++i) moved.motion.p_W_m[i].x() = 1e-3 * std::sin(0.1 * static_cast<double>(i));
  recording::Recording uneven = moved;
  uneven.motion.t_s[50] += 4e-4;
  EXPECT_THROW(fit_device(uneven), BadData);
  recording::Recording forceless = moved;
  forceless.f_W_N.clear();
  EXPECT_THROW(fit_device(forceless), BadData);
}

}  // namespace
}  // namespace touchstone::servo
