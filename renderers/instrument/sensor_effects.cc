#include "renderers/instrument/sensor_effects.h"

#include <algorithm>
#include <initializer_list>
#include <vector>

namespace touchstone::renderers {
using rendering::EffectTraits;
using rendering::InstrumentEffect;
using rendering::MotionView;
using rendering::RecordingScales;
using rendering::SearchPlan;

namespace {

// Applies `change` to every force in the sensor's frame.
template <class Change>
void in_sensor_frame(const MotionView& motion, std::span<Vec3> f_W_N, Change change) {
  for (std::size_t i = 0; i < f_W_N.size(); ++i) {
    if (motion.q_WS.empty()) {
      change(f_W_N[i], motion.t_s[i]);
      continue;
    }
    const Mat3 R_WS = motion.q_WS[i].toRotationMatrix();
    Vec3 f_S_N = R_WS.transpose() * f_W_N[i];
    change(f_S_N, motion.t_s[i]);
    f_W_N[i] = R_WS * f_S_N;
  }
}

class ForceBias final : public InstrumentEffect {
 public:
  explicit ForceBias(const Vec3& bias) : bias_S_N_(bias) {}
  void apply(const MotionView& motion, std::span<Vec3> f_W_N) const override {
    in_sensor_frame(motion, f_W_N, [this](Vec3& f, double) { f += bias_S_N_; });
  }

 private:
  Vec3 bias_S_N_;
};

class ForceDrift final : public InstrumentEffect {
 public:
  explicit ForceDrift(const Vec3& rate) : rate_S_N_per_s_(rate) {}
  void apply(const MotionView& motion, std::span<Vec3> f_W_N) const override {
    in_sensor_frame(motion, f_W_N, [this](Vec3& f, double t_s) { f += t_s * rate_S_N_per_s_; });
  }

 private:
  Vec3 rate_S_N_per_s_;
};

class GainDrift final : public InstrumentEffect {
 public:
  explicit GainDrift(double rate) : rate_per_s_(rate) {}
  void apply(const MotionView& motion, std::span<Vec3> f_W_N) const override {
    for (std::size_t i = 0; i < f_W_N.size(); ++i) f_W_N[i] *= 1.0 + rate_per_s_ * motion.t_s[i];
  }

 private:
  double rate_per_s_;
};

class ForceCrosstalk final : public InstrumentEffect {
 public:
  ForceCrosstalk(double c_xz, double c_yz) : c_xz_(c_xz), c_yz_(c_yz) {}
  void apply(const MotionView& motion, std::span<Vec3> f_W_N) const override {
    in_sensor_frame(motion, f_W_N, [this](Vec3& f, double) {
      f.x() += c_xz_ * f.z();
      f.y() += c_yz_ * f.z();
    });
  }

 private:
  double c_xz_;
  double c_yz_;
};

class ForceSaturation final : public InstrumentEffect {
 public:
  explicit ForceSaturation(double limit) : limit_N_(limit) {}
  void apply(const MotionView& motion, std::span<Vec3> f_W_N) const override {
    in_sensor_frame(motion, f_W_N, [this](Vec3& f, double) { f = f.cwiseMin(limit_N_).cwiseMax(-limit_N_); });
  }

 private:
  double limit_N_;
};

class TimeLag final : public InstrumentEffect {
 public:
  explicit TimeLag(double lag) : lag_s_(lag) {}
  [[nodiscard]] double halo_s() const override { return lag_s_; }
  void apply(const MotionView& motion, std::span<Vec3> f_W_N) const override {
    // What comes late is the sensor's reading, in the frame that it had then; it is turned by the frame of now.
    std::vector<Vec3> prompt_S_N;
    in_sensor_frame(motion, f_W_N, [&](const Vec3& f, double) { prompt_S_N.push_back(f); });
    std::size_t next = 1;
    in_sensor_frame(motion, f_W_N, [&](Vec3& f, double now_s) {
      const double t_s = now_s - lag_s_;
      while (next + 1 < prompt_S_N.size() && motion.t_s[next] < t_s) ++next;
      if (t_s <= motion.t_s[0] || prompt_S_N.size() < 2) {
        f = prompt_S_N[0];
        return;
      }
      const double share = (t_s - motion.t_s[next - 1]) / (motion.t_s[next] - motion.t_s[next - 1]);
      f = prompt_S_N[next - 1] + std::min(share, 1.0) * (prompt_S_N[next] - prompt_S_N[next - 1]);
    });
  }

 private:
  double lag_s_;
};

}  // namespace

std::unique_ptr<InstrumentEffect> make_force_bias(std::span<const double> values) {
  return std::make_unique<ForceBias>(Vec3(values[0], values[1], values[2]));
}
std::unique_ptr<InstrumentEffect> make_force_drift(std::span<const double> values) {
  return std::make_unique<ForceDrift>(Vec3(values[0], values[1], values[2]));
}
std::unique_ptr<InstrumentEffect> make_gain_drift(std::span<const double> values) {
  return std::make_unique<GainDrift>(values[0]);
}
std::unique_ptr<InstrumentEffect> make_force_crosstalk(std::span<const double> values) {
  return std::make_unique<ForceCrosstalk>(values[0], values[1]);
}
std::unique_ptr<InstrumentEffect> make_force_saturation(std::span<const double> values) {
  return std::make_unique<ForceSaturation>(values[0]);
}
std::unique_ptr<InstrumentEffect> make_time_lag(std::span<const double> values) {
  return std::make_unique<TimeLag>(values[0]);
}

namespace {

// Several parameters from zero, each sought up to `range` times a typical size to both sides.
SearchPlan plan_around_zero(std::initializer_list<const char*> names, double scale, double range) {
  SearchPlan plan;
  plan.starts.emplace_back();
  for (const char* const name : names) {
    plan.parameters.push_back({name, scale, -range * scale, range * scale});
    plan.starts.front()[name] = 0.0;
  }
  return plan;
}

}  // namespace

EffectTraits force_bias_traits() {
  EffectTraits traits;
  traits.plan = [](const RecordingScales& scales) {
    return plan_around_zero({"fx_N", "fy_N", "fz_N"}, scales.force_N, 2.0);
  };
  return traits;
}

EffectTraits force_drift_traits() {
  EffectTraits traits;
  traits.plan = [](const RecordingScales& scales) {
    const double rate = scales.force_N / std::max(scales.duration_s, 1e-9);
    return plan_around_zero({"fx_N_per_s", "fy_N_per_s", "fz_N_per_s"}, rate, 4.0);
  };
  return traits;
}

EffectTraits gain_drift_traits() {
  EffectTraits traits;
  traits.plan = [](const RecordingScales& scales) {
    return plan_around_zero({"rate_per_s"}, 0.2 / std::max(scales.duration_s, 1e-9), 4.0);
  };
  return traits;
}

EffectTraits force_crosstalk_traits() {
  EffectTraits traits;
  traits.plan = [](const RecordingScales&) {
    return SearchPlan{{{"c_xz"}, {"c_yz"}}, {{{"c_xz", 0.0}, {"c_yz", 0.0}}}};
  };
  return traits;
}

// A sensor that clips shows nothing beyond its limit but noise.
EffectTraits force_saturation_traits() {
  EffectTraits traits;
  traits.plan = [](const RecordingScales& scales) {
    const double largest = scales.largest_axis_N;
    SearchPlan plan{{{"limit_N", 1.0, 0.85 * largest, 1.2 * largest, true}}, {}};
    for (const double share : {0.88, 0.97}) plan.starts.push_back({{"limit_N", share * largest}});
    return plan;
  };
  return traits;
}

EffectTraits time_lag_traits() {
  EffectTraits traits;
  traits.follows_speed = true;
  traits.plan = [](const RecordingScales&) { return SearchPlan{{{"lag_s", 0.01}}, {{{"lag_s", 0.005}}}}; };
  return traits;
}

}  // namespace touchstone::renderers
