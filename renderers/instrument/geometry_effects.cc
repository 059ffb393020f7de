#include "renderers/instrument/geometry_effects.h"

#include <array>
#include <cmath>
#include <map>
#include <string>
#include <vector>

#include "harness/rendering/surface_frame.h"
#include "renderers/effects/field_effects.h"
#include "renderers/effects/in_frame.h"
#include "renderers/effects/raised_surface.h"

namespace touchstone::renderers {
using rendering::Effect;
using rendering::EffectTraits;
using rendering::InstrumentEffect;

namespace {

class Registration final : public InstrumentEffect {
 public:
  explicit Registration(const rendering::ObjectDisplacement& moved) : moved_(moved) {
    const Vec3& r = moved.turn_W_rad;
    Mat3 r_cross;
    r_cross << 0.0, -r.z(), r.y(), r.z(), 0.0, -r.x(), -r.y(), r.x(), 0.0;
    inverse_ = (Mat3::Identity() + r_cross).inverse();
  }
  [[nodiscard]] Vec3 true_position(const Vec3& measured_W_m) const override {
    return moved_.pivot_W_m + inverse_ * (measured_W_m - moved_.pivot_W_m - moved_.shift_W_m);
  }

 private:
  rendering::ObjectDisplacement moved_;
  Mat3 inverse_;
};

class TrackerScale final : public InstrumentEffect {
 public:
  TrackerScale(double scale, const Vec3& pivot_W_m) : size_(1.0 + scale), pivot_W_m_(pivot_W_m) {}
  [[nodiscard]] Vec3 true_position(const Vec3& measured_W_m) const override {
    return pivot_W_m_ + (measured_W_m - pivot_W_m_) / size_;
  }

 private:
  double size_;
  Vec3 pivot_W_m_;
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
  explicit SurfaceGeometry(std::span<const double> values) : values_(values.begin(), values.end()) {}
  [[nodiscard]] std::unique_ptr<Effect> contact_effect() const override {
    return in_frame(values_, std::make_unique<Bump>(values_[0], values_[1], values_[2], values_[3]));
  }

 private:
  std::vector<double> values_;
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
  const auto three = [&](std::size_t first) { return Vec3(values[first], values[first + 1], values[first + 2]); };
  return std::make_unique<Registration>(rendering::ObjectDisplacement{three(0), three(3), three(6)});
}
std::unique_ptr<InstrumentEffect> make_tracker_scale(std::span<const double> values) {
  return std::make_unique<TrackerScale>(values[0], Vec3(values[1], values[2], values[3]));
}
std::unique_ptr<InstrumentEffect> make_surface_geometry(std::span<const double> values) {
  return std::make_unique<SurfaceGeometry>(values);
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
    std::map<std::string, double> start{{"dx_m", 0.0},   {"dy_m", 0.0},   {"dz_m", 0.0},
                                        {"rx_rad", 0.0}, {"ry_rad", 0.0}, {"rz_rad", 0.0}};
    // Along the surface, and along its normal: only what moves the tip over facets is seen in steps of a facet.
    const auto free = [&](const char* name, int axis, const std::array<const char*, 3>& names, double scale,
                          double step) {
      rendering::SearchedParameter one{name, scale, -farthest * scale, farthest * scale, false, {}, {}, step};
      const Vec3 along_W = scales.frame.q_WF * Vec3::Unit(axis);
      for (int k = 0; k < 3 && !scales.frame.is_objects(); ++k) one.along[names.at(std::size_t(k))] = along_W[k];
      plan.parameters.push_back(std::move(one));
    };
    constexpr std::array shifts{"dx_m", "dy_m", "dz_m"};
    constexpr std::array turns{"rx_rad", "ry_rad", "rz_rad"};
    for (int axis = 0; axis < 3; ++axis)
      free(shifts.at(std::size_t(axis)), axis, shifts, d, axis < 2 ? scales.facet_m / d : 0.0);
    for (int axis = 0; axis < 3; ++axis)
      free(turns.at(std::size_t(axis)), axis, turns, turn, axis < 2 ? 0.0 : scales.facet_m / d);
    const Vec3& pivot_W_m = scales.frame.origin_W_m;
    if (!pivot_W_m.isZero(0.0)) {
      start.insert({{"pivot_x_m", pivot_W_m.x()}, {"pivot_y_m", pivot_W_m.y()}, {"pivot_z_m", pivot_W_m.z()}});
    }
    plan.starts = {start};
    if (scales.surface_is_elsewhere()) {
      for (const double share : {1.0, -1.0}) {
        plan.starts.push_back(plan.starts.front());
        const Vec3 shift_W_m = share * d * (scales.frame.q_WF * Vec3::UnitZ());
        for (int k = 0; k < 3; ++k) plan.starts.back()[shifts.at(std::size_t(k))] = shift_W_m[k];
      }
    }
    return plan;
  };
  return traits;
}

// Lengths on a flat object that come out too long show nothing: as for a ball, the surface must bend.
EffectTraits tracker_scale_traits() {
  EffectTraits traits;
  traits.moves_contact = true;
  traits.along_surface = true;
  traits.plan = [](const rendering::RecordingScales& scales) {
    constexpr double largest = 0.1;
    const double facets = scales.facet_m / scales.extent_m();
    rendering::SearchPlan plan{{{"scale", 0.02, -largest, largest, false, {}, {}, 50.0 * facets}}, {}};
    for (const double scale : {-0.02, 0.02}) {
      std::map<std::string, double> start{{"scale", scale}};
      const Vec3& pivot_W_m = scales.frame.origin_W_m;
      if (!pivot_W_m.isZero(0.0))
        start.insert({{"pivot_x_m", pivot_W_m.x()}, {"pivot_y_m", pivot_W_m.y()}, {"pivot_z_m", pivot_W_m.z()}});
      plan.starts.push_back(std::move(start));
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
