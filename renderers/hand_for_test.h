// What the tests of renderers share: making one over a mesh, driving it, rotations and scales that are awkward on
// purpose.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "harness/surface/embree_surface.h"
#include "renderers/catalogue.h"

namespace touchstone::renderers {

inline rendering::Model model_of(const std::string& renderer, std::map<std::string, double> parameters) {
  rendering::Model model;
  model.renderer = renderer;
  model.parameters = std::move(parameters);
  model.source = "test";
  return model;
}

inline std::unique_ptr<rendering::Renderer> god_object(const surface::TriangleMesh& mesh, double stiffness_N_per_m,
                                                       double tip_radius_m = 0.0) {
  return make_renderer(
      model_of("god-object", {{"stiffness_N_per_m", stiffness_N_per_m}, {"tip_radius_m", tip_radius_m}}),
      make_embree_surface(mesh));
}

// Steps a renderer at 1 kHz.
class Hand {
 public:
  explicit Hand(rendering::Renderer& renderer) : renderer_(&renderer) { renderer.reset(); }
  rendering::StepResult to(const Vec3& p) {
    t_s_ += 1e-3;
    return renderer_->step({t_s_, p, Quat::Identity()});
  }
  // From where it is now (or the first position) in equal steps; returns the last result.
  rendering::StepResult stroke(const Vec3& from, const Vec3& to, int steps) {
    rendering::StepResult result;
    for (int i = 1; i <= steps; ++i) result = this->to(from + (to - from) * i / steps);
    return result;
  }

 private:
  rendering::Renderer* renderer_;
  double t_s_ = 0.0;
};

inline Quat awkward_rotation() { return Quat(0.83, 0.31, -0.41, 0.22).normalized(); }
inline const std::vector<double>& unit_scales() {
  static const std::vector<double> scales{1e-3, 0.3, 1.0, 7.0, 1e3};
  return scales;
}

}  // namespace touchstone::renderers
