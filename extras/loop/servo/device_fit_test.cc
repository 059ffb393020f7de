// A device's figures found again from a recording of its own simulation, through an encoder, at several scales.
#include "servo/device_fit.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numeric>
#include <tuple>
#include <vector>

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
const std::vector<FitScale> fit_scales{{0.05, 1e-3, 100.0, 2.0}, {0.3, 5e-4, 2000.0, 10.0}, {2.0, 1e-2, 40.0, 5.0}};

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
  for (const FitScale& scale : fit_scales) {
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
  for (const FitScale& scale : fit_scales) {
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
    if (!fit.latency_s.determined) {
      EXPECT_EQ(fit.effects.back().named, Named::cannot_tell);
    }
  }
}

// A device under a servo, by small steps (the classical Runge-Kutta method of fourth order, 100 a period) with dry
// friction that holds it at rest: nothing of the exact transitions that the fit uses.
struct SmallSteps {
  double mass_kg, damping_N_s_per_m, friction_N, latency_periods;
  // What a hand does besides, where there is one: its spring to a place that swings.
  double hand_N_per_m = 0.0;

  [[nodiscard]] double acceleration(double f, double x, double v, double t) const {
    const double pull = f - damping_N_s_per_m * v - hand_N_per_m * (x - 0.01 * std::sin(7.0 * t));
    if (v == 0.0) return std::abs(pull) <= friction_N ? 0.0 : (pull - std::copysign(friction_N, pull)) / mass_kg;
    return (pull - std::copysign(friction_N, v)) / mass_kg;
  }
  [[nodiscard]] std::pair<double, double> runge_kutta(double h, double f, double x, double v, double t) const {
    const double a1 = acceleration(f, x, v, t), v2 = v + 0.5 * h * a1;
    const double a2 = acceleration(f, x + 0.5 * h * v, v2, t), v3 = v + 0.5 * h * a2;
    const double a3 = acceleration(f, x + 0.5 * h * v2, v3, t), v4 = v + h * a3;
    const double a4 = acceleration(f, x + h * v3, v4, t);
    return {x + h / 6.0 * (v + 2.0 * v2 + 2.0 * v3 + v4), v + h / 6.0 * (a1 + 2.0 * a2 + 2.0 * a3 + a4)};
  }

  struct Shown {
    recording::Recording recording;
    std::array<double, 4> parts_N2{};  // inertia, viscous, dry, latency: sums of squares
  };
  [[nodiscard]] Shown run(double period_s, double force_N, double resolution_m) const {
    constexpr int steps = 100;
    const double step_s = period_s / steps;
    const auto late_steps = std::llround(latency_periods * steps);
    Random random(11);
    std::vector<double> commanded_N;
    double x = 0.0, v = 0.0, sign = 1.0;
    Shown out;
    out.recording.source = "small steps";
    const auto acting = [&](std::int64_t step) {
      return commanded_N[static_cast<std::size_t>(std::max<std::int64_t>(step - late_steps, 0) / steps)];
    };
    for (std::int64_t k = 0; k < 1500; ++k) {
      const double measured = resolution_m * std::round(x / resolution_m);
      if (k % 5 == 0) sign = random.uniform() < 0.5 ? -1.0 : 1.0;
      commanded_N.push_back(sign * force_N - force_N * measured);  // and a soft spring that keeps it near
      out.recording.motion.t_s.push_back(static_cast<double>(k) * period_s);
      out.recording.motion.p_W_m.emplace_back(0.02, measured, -0.01);
      out.recording.f_W_N.emplace_back(0.0, commanded_N.back(), 0.0);
      for (int i = 0; i < steps; ++i) {
        const double t = (static_cast<double>(k) + static_cast<double>(i) / steps) * period_s;
        const double f = acting(k * steps + i);
        const double a = acceleration(f, x, v, t), viscous = damping_N_s_per_m * v;
        const std::array parts{mass_kg * a, viscous, f - mass_kg * a - viscous, commanded_N.back() - f};
        for (std::size_t n = 0; n < parts.size(); ++n) out.parts_N2[n] += parts[n] * parts[n];
        for (double left_s = step_s; left_s > 1e-3 * step_s;) {
          auto [there, next] = runge_kutta(left_s, f, x, v, t);
          double taken_s = left_s;
          if (friction_N > 0.0 && next * v < 0.0) {  // it turns: up to there, to first order in the speed
            taken_s *= v / (v - next);
            there = runge_kutta(taken_s, f, x, v, t).first;
            next = 0.0;
          }
          x = there;
          v = next;
          left_s -= taken_s;
        }
      }
    }
    return out;
  }
};

// Each subset of viscous friction, dry friction and latency, planted in devices of three sizes: what is there is named,
// with its share of the force, and what is not is negligible.
TEST(DeviceFit, NamesWhatBecomesOfTheForceAndWhatDoesNot) {
  for (const auto& [mass_kg, period_s, force_N] :
       {std::tuple{0.05, 1e-3, 2.0}, std::tuple{0.4, 5e-4, 12.0}, std::tuple{1.5, 4e-3, 5.0}}) {
    const double speed = force_N * 5.0 * period_s / mass_kg;  // that five periods of the force give
    const double resolution_m = 0.02 * speed * period_s;
    for (unsigned planted = 0; planted < 8; ++planted) {
      if (mass_kg > 0.1 && planted % 3 != 1) continue;  // of one size all, of the others some
      const bool viscous = (planted & 1U) != 0, dry = (planted & 2U) != 0, late = (planted & 4U) != 0;
      const SmallSteps device{mass_kg, viscous ? 0.1 * force_N / speed : 0.0, dry ? 0.12 * force_N : 0.0,
                              late ? 1.4 : 0.0};
      const auto shown = device.run(period_s, force_N, resolution_m);
      const DeviceFit fit = fit_device(shown.recording);
      const double whole = std::reduce(shown.parts_N2.begin(), shown.parts_N2.end());
      const std::array<bool, 4> present{true, viscous, dry, late};
      for (std::size_t i = 0; i < 4; ++i) {
        const DeviceEffect& effect = fit.effects[i];
        const double truth = shown.parts_N2[i] / whole;
        EXPECT_EQ(effect.named, present[i] ? Named::present : Named::negligible)
            << mass_kg << " kg, planted " << planted << ": " << effect.name << ", share " << effect.share << ", late "
            << fit.latency_s.value / period_s << " +- " << fit.latency_s.error95 / period_s << ", left "
            << fit.residual_m / resolution_m;
        EXPECT_NEAR(effect.share, truth, 0.02) << mass_kg << " kg, planted " << planted << ": " << effect.name;
        fmt::print("{} kg, planted {}: {:16} {:6.2f} % of {:6.2f} %\n", mass_kg, planted, effect.name,
                   100.0 * effect.share, 100.0 * truth);
      }
      EXPECT_NEAR(fit.resolution_m, resolution_m, 1e-6 * resolution_m);
      EXPECT_LT(fit.unexplained, 0.01);
    }
  }
}

// A hand holds it and nobody says so: no figure is right, and none is given.
TEST(DeviceFit, WithAHandOnTheDeviceItCannotTell) {
  SmallSteps held{0.1, 0.3, 0.0, 0.0};
  held.hand_N_per_m = 500.0;
  const DeviceFit fit = fit_device(held.run(1e-3, 2.0, 1e-6).recording);
  EXPECT_GT(fit.unexplained, 0.1);
  for (const DeviceEffect& effect : fit.effects) EXPECT_EQ(effect.named, Named::cannot_tell) << effect.name;
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
