#include "renderers/instrument/tool_effects.h"

#include <algorithm>
#include <memory>
#include <vector>

namespace touchstone::renderers {
using rendering::EffectTraits;
using rendering::InstrumentEffect;
using rendering::MotionView;

namespace {

constexpr double standard_gravity_m_per_s2 = 9.80665;

class ToolWeight final : public InstrumentEffect {
 public:
  explicit ToolWeight(double mass) : weight_W_N_(0.0, 0.0, -mass * standard_gravity_m_per_s2) {}
  void apply(const MotionView&, std::span<Vec3> f_W_N) const override {
    for (Vec3& f : f_W_N) f += weight_W_N_;
  }

 private:
  Vec3 weight_W_N_;
};

class ToolInertia final : public InstrumentEffect {
 public:
  ToolInertia(double mass, double window) : mass_kg_(mass), window_s_(window) {}
  [[nodiscard]] double halo_s() const override { return window_s_; }
  void apply(const MotionView& motion, std::span<Vec3> f_W_N) const override {
    const auto work_out = [&] { return accelerations(motion, f_W_N.size()); };
    const auto a_W = motion.accelerations != nullptr ? motion.accelerations->of(window_s_, work_out)
                                                     : std::make_shared<const std::vector<Vec3>>(work_out());
    for (std::size_t i = 0; i < f_W_N.size(); ++i) f_W_N[i] -= mass_kg_ * (*a_W)[i];
  }

 private:
  [[nodiscard]] std::vector<Vec3> accelerations(const MotionView& motion, std::size_t n) const {
    std::vector<Vec3> a_W(n);
    std::size_t first = 0;
    std::size_t last = 0;  // one past
    for (std::size_t i = 0; i < n; ++i) {
      while (motion.t_s[first] < motion.t_s[i] - 0.5 * window_s_) ++first;
      while (last < n && motion.t_s[last] <= motion.t_s[i] + 0.5 * window_s_) ++last;
      // A quadratic needs three samples; at a slow clock the neighbours are used beyond the window.
      const std::size_t low = std::min(first, i > 0 ? i - 1 : i);
      const std::size_t high = std::max(last, std::min(i + 2, n));
      a_W[i] = acceleration(motion, low, high, motion.t_s[i]);
    }
    return a_W;
  }

  static Vec3 acceleration(const MotionView& motion, std::size_t low, std::size_t high, double t_s) {
    if (high - low < 3) return Vec3::Zero();
    Mat3 normal = Mat3::Zero();
    Mat3 right = Mat3::Zero();
    const double scale = std::max(motion.t_s[high - 1] - t_s, t_s - motion.t_s[low]);
    for (std::size_t j = low; j < high; ++j) {
      const double x = (motion.t_s[j] - t_s) / scale;
      const Vec3 basis(1.0, x, x * x);
      normal += basis * basis.transpose();
      right += basis * (motion.p_W_m[j] - motion.p_W_m[low]).transpose();
    }
    const Mat3 coefficients = normal.ldlt().solve(right);
    return 2.0 / (scale * scale) * coefficients.row(2).transpose();
  }

  double mass_kg_;
  double window_s_;
};

}  // namespace

std::unique_ptr<InstrumentEffect> make_tool_weight(std::span<const double> values) {
  return std::make_unique<ToolWeight>(values[0]);
}
std::unique_ptr<InstrumentEffect> make_tool_inertia(std::span<const double> values) {
  return std::make_unique<ToolInertia>(values[0], values[1]);
}

EffectTraits tool_weight_traits() {
  EffectTraits traits;
  traits.plan = [](const rendering::RecordingScales&) {
    return rendering::SearchPlan{{{"mass_kg", 0.1}}, {{{"mass_kg", 0.0}}}};
  };
  traits.one_sided = {
      {{"mass_kg", 0.01}},
      0.01,
      "the tool pulls upwards, as a mass of {:.3g} kg would: is the sign of the force, or of z, wrong?"};
  return traits;
}

// The longer the window that acceleration is taken over, the less of a tracker's noise is in it, and the less of a
// quick motion's: from which the mass explains more is tried.
EffectTraits tool_inertia_traits() {
  EffectTraits traits;
  traits.follows_speed = true;
  traits.one_sided = {{{"mass_kg", 0.01}},
                      0.01,
                      "the force helps every acceleration, as a mass of {:.3g} kg would: is its sign wrong?"};
  traits.plan = [](const rendering::RecordingScales&) {
    rendering::SearchPlan plan{{{"mass_kg", 0.1}}, {}};
    for (const double window_s : {0.033, 0.05, 0.065, 0.08, 0.1, 0.13, 0.17, 0.22, 0.3})
      plan.starts.push_back({{"mass_kg", 0.0}, {"window_s", window_s}});
    return plan;
  };
  return traits;
}

}  // namespace touchstone::renderers
