#include "renderers/instrument/formula_instrument.h"

#include <algorithm>
#include <array>
#include <memory>
#include <vector>

#include "renderers/effects/formula_law.h"

namespace touchstone::renderers {
using rendering::DeclaredEffect;

namespace {

class FormulaInstrument final : public rendering::InstrumentEffect {
 public:
  FormulaInstrument(const DeclaredEffect& effect, std::span<const double> values)
      : declared_(effect), values_(values.begin(), values.end()) {}

  [[nodiscard]] double halo_s() const override {
    constexpr double neighbours_s = 0.05;  // for the velocity, at 20 Hz and above
    return neighbours_s;
  }

  void apply(const rendering::MotionView& motion, std::span<Vec3> f_W_N) const override {
    const ReadyLaw law(declared_, values_);
    double* const t = law->slot("t_s");
    const std::array<double*, 3> p{law->slot("x_m"), law->slot("y_m"), law->slot("z_m")};
    const std::array<double*, 3> v{law->slot("vx_m_per_s"), law->slot("vy_m_per_s"), law->slot("vz_m_per_s")};
    const std::array<double*, 3> f{law->slot("fx_N"), law->slot("fy_N"), law->slot("fz_N")};
    const bool turned = declared_.acts_on == rendering::ActsOn::sensor && !motion.q_WS.empty();
    for (std::size_t i = 0; i < f_W_N.size(); ++i) {
      const Quat q_WS = turned ? motion.q_WS[i] : Quat::Identity();
      const Vec3 before_N = turned ? Vec3(q_WS.conjugate() * f_W_N[i]) : f_W_N[i];
      const Vec3 v_W = velocity(motion, i, f_W_N.size());
      *t = motion.t_s[i];
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const auto k = static_cast<Eigen::Index>(axis);
        *p[axis] = motion.p_W_m[i][k];
        *v[axis] = v_W[k];
        *f[axis] = before_N[k];
      }
      const Vec3 added_N(law->value("x_N"), law->value("y_N"), law->value("z_N"));
      f_W_N[i] += turned ? Vec3(q_WS * added_N) : added_N;
    }
  }

 private:
  static Vec3 velocity(const rendering::MotionView& motion, std::size_t i, std::size_t n) {
    const std::size_t before = i > 0 ? i - 1 : i;
    const std::size_t after = std::min(i + 1, n - 1);
    if (after == before) return Vec3::Zero();
    return (motion.p_W_m[after] - motion.p_W_m[before]) / (motion.t_s[after] - motion.t_s[before]);
  }

  DeclaredEffect declared_;
  std::vector<double> values_;
};

}  // namespace

rendering::StagedInstrument make_formula_instrument(const DeclaredEffect& effect, std::span<const double> values) {
  const auto stage = effect.acts_on == rendering::ActsOn::tool ? rendering::InstrumentStage::object_frame
                                                               : rendering::InstrumentStage::sensor_offset;
  return {stage, std::make_unique<FormulaInstrument>(effect, values)};
}

}  // namespace touchstone::renderers
