// One renderer over one mesh and a tip that is moved over it: what every detector does.
#pragma once

#include <memory>

#include "harness/renderer_faults/engine.h"
#include "harness/rendering/renderer_failed.h"
#include "harness/surface/box_mesh.h"
#include "harness/surface/embree_surface.h"
#include "harness/surface/triangle_mesh.h"

namespace touchstone::renderer_faults {

// Half the width of the blocks and sheets, and how deep strokes press.
inline constexpr double half_side_m = 0.02;
inline constexpr double probe_depth_m = 5e-4;
// On the top of the block, beside edges and corners of what the detectors press.
inline const Vec3 place(0.0031, 0.0017, 0.0);

// 40 mm wide, its top at z = 0.
inline surface::TriangleMesh level_block() {
  return surface::box_mesh({-half_side_m, -half_side_m, -half_side_m}, {half_side_m, half_side_m, 0.0});
}

class Probe {
 public:
  // Places and lengths given to it are those of the world at unit 1.
  Probe(const Engine& engine, surface::TriangleMesh mesh, double unit = 1.0)
      : unit_(unit),
        radius_m_(engine.tip_radius_m),
        tick_s_(1.0 / engine.rate_Hz),
        settle_samples_(engine.settle_samples) {
    for (Vec3& v : mesh.vertices_W_m) v *= unit;
    renderer_ = engine.make(make_embree_surface(mesh), unit);
    renderer_->reset();
  }

  // Throws RendererFailed where the renderer broke down: its zero force says nothing.
  rendering::StepResult to(const Vec3& tip, const Quat& q = Quat::Identity()) {
    rendering::StepResult result;
    for (int i = 0; i <= settle_samples_; ++i) result = once(tip, q);
    return result;
  }
  // The tip `depth_m` below a surface at this foot with this normal: a ball's centre is its radius higher.
  rendering::StepResult press(const Vec3& foot, const Vec3& n, double depth_m) {
    return to(foot + (radius_m_ - depth_m) * n);
  }
  // From 2 mm above straight down to the depth in `steps`: renderers that look for crossings need the way. It rests at
  // both ends alone.
  rendering::StepResult approach(const Vec3& foot, const Vec3& n, double depth_m, int steps = 10) {
    constexpr double from_m = 2e-3;
    press(foot, n, -from_m);
    for (int i = 1; i < steps; ++i)
      once(foot + (radius_m_ + from_m - (from_m + depth_m) * i / steps) * n, Quat::Identity());
    return press(foot, n, depth_m);
  }
  void reset() {
    renderer_->reset();
    tick_ = 0;
  }
  [[nodiscard]] rendering::Renderer& renderer() { return *renderer_; }

 private:
  rendering::StepResult once(const Vec3& tip, const Quat& q) {
    rendering::StepResult result = renderer_->step({tick_s_ * static_cast<double>(++tick_), unit_ * tip, q});
    if (result.status == rendering::StepStatus::failed) throw rendering::RendererFailed(renderer_->failure());
    result.contact_W_m /= unit_;
    result.depth_m /= unit_;
    return result;
  }

  double unit_;
  double radius_m_;
  double tick_s_;
  int settle_samples_;
  std::unique_ptr<rendering::Renderer> renderer_;
  std::uint64_t tick_ = 0;
};

}  // namespace touchstone::renderer_faults
