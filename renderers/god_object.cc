#include "renderers/god_object.h"

#include <limits>

#include "harness/base/error.h"

namespace touchstone {
namespace {

// First version: every triangle is tried in every step, planes are unbounded while they press.
class GodObject final : public Renderer {
 public:
  GodObject(double stiffness_N_per_m, std::shared_ptr<const Surface> surface)
      : stiffness_N_per_m_(stiffness_N_per_m), surface_(std::move(surface)), mesh_(*surface_->mesh()) {}

 private:
  void do_reset() override { started_ = false; }

  [[nodiscard]] Vec3 normal(int t) const { return mesh_.scaled_normal(static_cast<std::size_t>(t)).normalized(); }
  [[nodiscard]] double height(int t, const Vec3& x) const {
    return normal(t).dot(x -
                         mesh_.vertices_W_m[static_cast<std::size_t>(mesh_.triangles[static_cast<std::size_t>(t)][0])]);
  }

  StepResult do_step(const TipState& tip) noexcept override {
    const Vec3& p = tip.p_W_m;
    if (!started_) {
      started_ = true;
      const SurfacePoint start = surface_->closest(p);
      g_ = start.signed_distance_m < 0.0 ? start.p_W_m : p;
      active_[0] = active_[1] = active_[2] = -1;
    }
    for (int round = 0; round < 16; ++round) {
      Vec3 goal = p;
      // Gauss-Seidel over the planes that press; the final version solves for the multipliers.
      for (int sweep = 0; sweep < 200; ++sweep) {
        for (const int t : active_) {
          if (t >= 0 && height(t, p) < 0.0 && height(t, goal) < 0.0) goal -= height(t, goal) * normal(t);
        }
      }
      int hit = -1;
      double first = 2.0;
      for (int t = 0; t < static_cast<int>(mesh_.triangle_count()); ++t) {
        if (t == active_[0] || t == active_[1] || t == active_[2]) continue;
        const double from = height(t, g_);
        const double to = height(t, goal);
        if (!(from >= -1e-12 && to < 0.0)) continue;
        const double fraction = std::max(0.0, from / (from - to));
        const Vec3 x = g_ + fraction * (goal - g_);
        const Vec3 n = normal(t);
        bool inside = true;
        const auto& corners = mesh_.triangles[static_cast<std::size_t>(t)];
        for (std::size_t i = 0; i < 3; ++i) {
          const Vec3& a = mesh_.vertices_W_m[static_cast<std::size_t>(corners[i])];
          const Vec3& b = mesh_.vertices_W_m[static_cast<std::size_t>(corners[(i + 1) % 3])];
          inside = inside && n.cross(b - a).dot(x - a) >= -1e-15;
        }
        if (inside && fraction < first) {
          first = fraction;
          hit = t;
        }
      }
      if (hit < 0) {
        g_ = goal;
        break;
      }
      g_ += first * (goal - g_);
      active_[static_cast<std::size_t>(round % 3)] = hit;
    }
    StepResult result;
    result.f_W_N = stiffness_N_per_m_ * (g_ - p);
    result.contact_W_m = g_;
    result.depth_m = (g_ - p).norm();
    result.contact = result.depth_m > 0.0;
    if (result.contact) result.n_W = (g_ - p) / result.depth_m;
    for (int& t : active_) {
      if (t >= 0 && height(t, p) >= 0.0) t = -1;
    }
    return result;
  }

  double stiffness_N_per_m_;
  std::shared_ptr<const Surface> surface_;
  const TriangleMesh& mesh_;
  bool started_ = false;
  Vec3 g_ = Vec3::Zero();
  std::array<int, 3> active_{-1, -1, -1};
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
