#include "renderers/effects/surface_texture.h"

#include <cmath>
#include <numbers>

#include "renderers/effects/in_frame.h"

namespace touchstone::renderers {
using rendering::EffectTraits;

namespace {

class SurfaceTexture final : public rendering::Effect {
 public:
  SurfaceTexture(double amplitude, double wavelength, double direction, double phase)
      : amplitude_(amplitude),
        kx_(2.0 * std::numbers::pi / wavelength * std::cos(direction)),
        ky_(2.0 * std::numbers::pi / wavelength * std::sin(direction)),
        phase_(phase) {}

  void reset() noexcept override {}

  void apply(rendering::ContactState& contact) noexcept override {
    // Far from the surface the sine cannot make a contact; the normal is unknown there.
    if (contact.n_W.isZero()) return;
    contact.depth_m += amplitude_ * std::sin(kx_ * contact.proxy_W_m.x() + ky_ * contact.proxy_W_m.y() + phase_);
  }

 private:
  double amplitude_;
  double kx_;
  double ky_;
  double phase_;
};

}  // namespace

std::unique_ptr<rendering::Effect> make_surface_texture(std::span<const double> values) {
  return in_frame(values, std::make_unique<SurfaceTexture>(values[0], values[1], values[2], values[3]));
}

EffectTraits surface_texture_traits() {
  EffectTraits traits;
  traits.along_surface = true;
  traits.is_wave = true;
  traits.surface = EffectTraits::Surface::higher_by_amplitude;
  traits.peaks = EffectTraits::Peaks::waves;
  return traits;
}

}  // namespace touchstone::renderers
