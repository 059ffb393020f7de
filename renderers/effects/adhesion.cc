#include "renderers/effects/adhesion.h"

#include <algorithm>
#include <cmath>

namespace touchstone::renderers {
namespace {

constexpr double ranges_until_rupture = 5.0;

class Adhesion final : public rendering::Effect {
 public:
  Adhesion(double force, double range) : force_(force), range_(range) {}

  void reset() noexcept override { bonded_ = false; }

  void apply(rendering::ContactState& contact) noexcept override {
    const double gap = std::max(-contact.depth_m, 0.0);
    if (contact.contact) bonded_ = true;
    if (gap > ranges_until_rupture * range_) bonded_ = false;
    if (bonded_) contact.adhesion_N += force_ * std::exp(-gap / range_);
  }

 private:
  double force_;
  double range_;
  bool bonded_ = false;
};

}  // namespace

std::unique_ptr<rendering::Effect> make_adhesion(std::span<const double> values) {
  return std::make_unique<Adhesion>(values[0], values[1]);
}

rendering::EffectTraits adhesion_traits() {
  rendering::EffectTraits traits;
  traits.plan = [](const rendering::RecordingScales& scales) {
    rendering::SearchedParameter range{"range_m"};
    range.lower = 0.005 * scales.depth_m;
    range.upper = 5.0 * scales.depth_m;
    range.logarithmic = true;
    rendering::SearchPlan plan{{{"force_N", scales.force_N, 0.0, 2.0 * scales.force_N}, range}, {}};
    for (const double share : {0.05, 0.3})
      plan.starts.push_back({{"force_N", 0.1 * scales.force_N}, {"range_m", share * scales.depth_m}});
    return plan;
  };
  return traits;
}

}  // namespace touchstone::renderers
