// A wall that also pulls, in contact everywhere, and motions that only push it off: what linear theory is about.
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "harness/rendering/renderer.h"
#include "servo/servo_loop.h"

namespace touchstone::servo {

class LinearWall final : public rendering::Renderer {
 public:
  explicit LinearWall(double stiffness_N_per_m, double at_m = 0.0) : k_(stiffness_N_per_m), at_m_(at_m) {}

 protected:
  void do_reset() override {}
  rendering::StepResult do_step(const rendering::TipState& tip) noexcept override {
    rendering::StepResult out;
    out.contact = true;
    out.n_W = Vec3::UnitZ();
    out.f_W_N = -k_ * (tip.p_W_m.z() - at_m_) * Vec3::UnitZ();
    return out;
  }

 private:
  double k_, at_m_;
};

// At rest but for the first period, in which it moves with `velocity`: the run begins with that velocity.
inline MotionColumns struck(const LoopParameters& own, double velocity_m_per_s, double seconds) {
  const Vec3 after = Vec3(0.0, 0.0, velocity_m_per_s * own.period_s);
  return {{0.0, own.period_s, seconds}, {Vec3::Zero(), after, after}, {}};
}

// Root mean square along z over [from, to) as shares of the run, about the mean.
inline double spread_m(const LoopTrace& trace, double from, double to) {
  const auto begin = static_cast<std::size_t>(from * static_cast<double>(trace.size()));
  const auto end = static_cast<std::size_t>(to * static_cast<double>(trace.size()));
  double mean = 0.0, square = 0.0;
  for (std::size_t i = begin; i < end; ++i) mean += trace.tip_W_m[i].z() / static_cast<double>(end - begin);
  for (std::size_t i = begin; i < end; ++i) square += std::pow(trace.tip_W_m[i].z() - mean, 2);
  return std::sqrt(square / static_cast<double>(end - begin));
}

// By upward crossings of the mean in the last half.
inline double frequency_Hz(const LoopTrace& trace) {
  double mean = 0.0;
  const std::size_t begin = trace.size() / 2;
  for (std::size_t i = begin; i < trace.size(); ++i)
    mean += trace.tip_W_m[i].z() / static_cast<double>(trace.size() - begin);
  std::vector<double> crossings;
  for (std::size_t i = begin + 1; i < trace.size(); ++i) {
    const double before = trace.tip_W_m[i - 1].z() - mean, after = trace.tip_W_m[i].z() - mean;
    if (before < 0.0 && after >= 0.0)
      crossings.push_back(trace.t_s[i - 1] + (trace.t_s[i] - trace.t_s[i - 1]) * before / (before - after));
  }
  if (crossings.size() < 2) return 0.0;
  return static_cast<double>(crossings.size() - 1) / (crossings.back() - crossings.front());
}

}  // namespace touchstone::servo
