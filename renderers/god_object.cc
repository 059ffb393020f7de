#include "renderers/god_object.h"

#include <limits>

#include "harness/base/error.h"
#include "harness/surface/triangle_queries.h"
#include "renderers/contact_mesh.h"
#include "renderers/surface_walk.h"

namespace touchstone {
namespace {

class GodObject final : public Renderer {
 public:
  GodObject(double stiffness_N_per_m, std::shared_ptr<const Surface> surface)
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
    const Facet& facet = mesh_->facet(nearest.triangle);
    const TriangleClosest where = closest_on_triangle(mesh_->corners(nearest.triangle), facet.n, p);
    // Beyond the rim of an open mesh there is no inside.
    const bool rim = where.feature == Feature::edge     ? facet.neighbour[where.index] < 0
                     : where.feature == Feature::vertex ? mesh_->open_vertex(facet.corner[where.index])
                                                        : false;
    if (rim) return walk_.start_free(p);
    walk_.start_on(nearest.triangle, where.feature, where.index, p);
  }

  double stiffness_N_per_m_;
  std::shared_ptr<const Surface> surface_;
  std::shared_ptr<const ContactMesh> mesh_;
  SurfaceWalk walk_;
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
        if (parameters.at("tip_radius_m") > 0.0) throw BadData("god-object: tip_radius_m > 0 is not built yet");
        return std::make_unique<GodObject>(parameters.at("stiffness_N_per_m"), std::move(surface));
      }};
}

}  // namespace touchstone
