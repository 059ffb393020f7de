#include "renderers/instrument/geometry_effects.h"

#include <cmath>
#include <vector>

#include "renderers/effects/field_effects.h"
#include "renderers/effects/raised_surface.h"

namespace touchstone::renderers {
using rendering::Effect;
using rendering::EffectTraits;
using rendering::InstrumentEffect;

namespace {

class Registration final : public InstrumentEffect {
 public:
  Registration(const Vec3& d, double rx, double ry) : d_W_m_(d) {
    Mat3 r_cross;
    r_cross << 0.0, 0.0, ry, 0.0, 0.0, -rx, -ry, rx, 0.0;
    inverse_ = (Mat3::Identity() + r_cross).inverse();
  }
  [[nodiscard]] Vec3 true_position(const Vec3& measured_W_m) const override {
    return inverse_ * (measured_W_m - d_W_m_);
  }

 private:
  Vec3 d_W_m_;
  Mat3 inverse_;
};

class Bump final : public Effect {
 public:
  Bump(double amplitude, double x, double y, double width) : amplitude_(amplitude), x_(x), y_(y), width_(width) {}
  void reset() noexcept override {}
  void apply(rendering::ContactState& contact) noexcept override {
    constexpr int looks = 2;
    raise_surface(contact, looks, [this](double x_m, double y_m) noexcept {
      const double dx = x_m - x_;
      const double dy = y_m - y_;
      const double variance = width_ * width_;
      const double height = amplitude_ * std::exp(-0.5 * (dx * dx + dy * dy) / variance);
      return RaisedBy{height, -dx * height / variance, -dy * height / variance};
    });
  }

 private:
  double amplitude_;
  double x_;
  double y_;
  double width_;
};

class SurfaceGeometry final : public InstrumentEffect {
 public:
  SurfaceGeometry(double amplitude, double x, double y, double width)
      : amplitude_(amplitude), x_(x), y_(y), width_(width) {}
  [[nodiscard]] std::unique_ptr<Effect> contact_effect() const override {
    return std::make_unique<Bump>(amplitude_, x_, y_, width_);
  }

 private:
  double amplitude_;
  double x_;
  double y_;
  double width_;
};

class HeightField final : public InstrumentEffect {
 public:
  explicit HeightField(std::span<const double> values) : values_(values.begin(), values.end()) {}
  [[nodiscard]] std::unique_ptr<Effect> contact_effect() const override { return make_height_field_contact(values_); }

 private:
  std::vector<double> values_;
};

}  // namespace

std::unique_ptr<InstrumentEffect> make_height_field(std::span<const double> values) {
  return std::make_unique<HeightField>(values);
}
std::unique_ptr<InstrumentEffect> make_registration(std::span<const double> values) {
  return std::make_unique<Registration>(Vec3(values[0], values[1], values[2]), values[3], values[4]);
}
std::unique_ptr<InstrumentEffect> make_surface_geometry(std::span<const double> values) {
  return std::make_unique<SurfaceGeometry>(values[0], values[1], values[2], values[3]);
}

// Where the mesh lies so far off that model and measurement do not touch at the same time, no small shift changes
// anything: the fit starts from larger ones too.
EffectTraits registration_traits() {
  EffectTraits traits;
  traits.moves_contact = true;
  traits.surface = EffectTraits::Surface::moved;
  traits.plan = [](const rendering::RecordingScales& scales) {
    constexpr double farthest = 3.0;  // depths: beyond, nothing that was pressed is pressed any more
    const double d = scales.depth_m;
    const double turn = d / scales.extent_m();
    rendering::SearchPlan plan;
    const auto free = [&](const char* name, double scale, double step) {
      plan.parameters.push_back({name, scale, -farthest * scale, farthest * scale, false, {}, {}, step});
    };
    free("dx_m", d, scales.facet_m / d);
    free("dy_m", d, scales.facet_m / d);
    free("dz_m", d, 0.0);
    free("rx_rad", turn, 0.0);
    free("ry_rad", turn, 0.0);
    plan.starts = {{{"dx_m", 0.0}, {"dy_m", 0.0}, {"dz_m", 0.0}, {"rx_rad", 0.0}, {"ry_rad", 0.0}}};
    if (scales.surface_is_elsewhere()) {
      for (const double share : {1.0, -1.0}) {
        plan.starts.push_back(plan.starts.front());
        plan.starts.back()["dz_m"] = share * d;
      }
    }
    return plan;
  };
  return traits;
}

EffectTraits surface_geometry_traits() {
  EffectTraits traits;
  traits.along_surface = true;
  traits.surface = EffectTraits::Surface::higher_by_amplitude;
  traits.peaks = EffectTraits::Peaks::height;
  return traits;
}

EffectTraits height_field_traits() {
  EffectTraits traits;
  traits.contains = {"surface-geometry"};
  traits.surface = EffectTraits::Surface::higher_by_field;
  traits.map_title = "Height of the surface above the mesh [mm]";
  return traits;
}

}  // namespace touchstone::renderers
