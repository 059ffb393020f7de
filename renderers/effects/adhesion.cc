#include "renderers/effects/adhesion.h"

#include <algorithm>
#include <cmath>

namespace touchstone::renderers {
namespace {

constexpr double ranges_until_rupture = 5.0;

class Adhesion final : public Effect {
 public:
  Adhesion(double force, double range) : force_(force), range_(range) {}

  void reset() noexcept override { bonded_ = false; }

  void apply(ContactState& contact) noexcept override {
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

std::unique_ptr<Effect> make_adhesion(std::span<const double> values) {
  return std::make_unique<Adhesion>(values[0], values[1]);
}

}  // namespace touchstone::renderers
