#include "renderers/god_object.h"

#include <limits>

#include "harness/surface/triangle_queries.h"
#include "renderers/ball_proxy.h"
#include "renderers/contact_mesh.h"
#include "renderers/surface_walk.h"

namespace touchstone {
namespace {

class PointGodObject final : public Renderer {
 public:
  PointGodObject(double stiffness_N_per_m, std::shared_ptr<const Surface> surface)
      : stiffness_N_per_m_(stiffness_N_per_m),
        surface_(std::move(surface)),
        mesh_(contact_mesh(surface_)),
        walk_(*mesh_) {}

 private:
  void do_reset() override { started_ = false; }

  StepResult do_step(const TipState& tip) noexcept override {
    const Vec3& p = tip.p_W_m;
    if (!started_) {
      start(p);
    } else {
      walk_.follow(p);
    }
    StepResult result;
    result.contact_W_m = walk_.position();
    if (walk_.touching()) {
      result.contact = true;
      result.f_W_N = stiffness_N_per_m_ * walk_.push();
      result.n_W = walk_.normal();
      result.depth_m = walk_.push().norm();
    }
    return result;
  }

  void start(const Vec3& p) noexcept {
    started_ = true;
    const SurfacePoint nearest = surface_->closest(p);
    if (!(nearest.signed_distance_m < 0.0)) return walk_.start_free(p);
    const TriangleClosest where =
        closest_on_triangle(mesh_->corners(nearest.triangle), mesh_->facet(nearest.triangle).n, p);
    // Beyond the rim of an open mesh there is no inside.
    if (mesh_->on_rim(nearest.triangle, where.feature, where.index)) return walk_.start_free(p);
    walk_.start_on(nearest.triangle, where.feature, where.index, p);
  }

  double stiffness_N_per_m_;
  std::shared_ptr<const Surface> surface_;
  std::shared_ptr<const ContactMesh> mesh_;
  SurfaceWalk walk_;
  bool started_ = false;
};

class BallGodObject final : public Renderer {
 public:
  BallGodObject(double stiffness_N_per_m, double radius_m, std::shared_ptr<const Surface> surface)
      : stiffness_N_per_m_(stiffness_N_per_m),
        surface_(std::move(surface)),
        mesh_(contact_mesh(surface_)),
        proxy_(*mesh_, *surface_, radius_m) {}

 private:
  void do_reset() override { started_ = false; }

  StepResult do_step(const TipState& tip) noexcept override {
    const Vec3& p = tip.p_W_m;
    if (started_) {
      proxy_.follow(p);
    } else {
      started_ = true;
      proxy_.start(p);
    }
    StepResult result;
    result.contact_W_m = proxy_.position();
    if (proxy_.touching()) {
      const Vec3 push = proxy_.push(p);
      result.contact = true;
      result.f_W_N = stiffness_N_per_m_ * push;
      result.n_W = proxy_.normal(p);
      result.depth_m = push.norm();
    }
    return result;
  }

  double stiffness_N_per_m_;
  std::shared_ptr<const Surface> surface_;
  std::shared_ptr<const ContactMesh> mesh_;
  BallProxy proxy_;
  bool started_ = false;
};

}  // namespace

RendererEntry god_object_entry() {
  return {
      "god-object",
      "constraint-based: the surface contact point follows the tip outside the surface, a spring joins the two",
      "Zilles and Salisbury 1995",
      {{"stiffness_N_per_m", "N/m", std::numeric_limits<double>::min(), 1e9, 500.0, "spring from tip to god-object"},
       {"tip_radius_m", "m", 0.0, 1e3, 0.0, "0: a point; else a ball whose centre the positions are"}},
      {{Ability::analytic_surface, "it constrains the god-object by triangles"}},
      [](const Parameters& parameters, std::shared_ptr<const Surface> surface) -> std::unique_ptr<Renderer> {
        const double stiffness = parameters.at("stiffness_N_per_m");
        const double radius = parameters.at("tip_radius_m");
        if (radius > 0.0) return std::make_unique<BallGodObject>(stiffness, radius, std::move(surface));
        return std::make_unique<PointGodObject>(stiffness, std::move(surface));
      }};
}

}  // namespace touchstone
