#include "harness/rendering/seam_watch.h"

#include <fmt/format.h>

#include <algorithm>

#include "harness/surface/mesh_topology.h"
#include "harness/surface/triangle_mesh.h"

namespace touchstone::rendering {
namespace {

constexpr int confirm = 20;

}  // namespace

SeamSearch::SeamSearch(std::shared_ptr<const surface::Surface> surface) : surface_(std::move(surface)) {
  const surface::TriangleMesh* const mesh = surface_->mesh();
  const surface::MeshTopology* const topology = surface_->topology();
  if (mesh == nullptr || topology == nullptr) return;
  for (std::size_t t = 0; t < topology->neighbours.size(); ++t) {
    for (std::size_t e = 0; e < 3; ++e) {
      if (topology->neighbours[t][e] != surface::open_edge) continue;
      const auto& corner = mesh->triangles[t];
      open_edges_.emplace_back(mesh->vertices_W_m[static_cast<std::size_t>(corner[e])],
                               mesh->vertices_W_m[static_cast<std::size_t>(corner[(e + 1) % 3])]);
    }
  }
}

void SeamSearch::restart() noexcept {
  last_ = {};
  pending_ = 0;
}

bool SeamSearch::near_open_edge(const Vec3& p_W_m, double within_m) const noexcept {
  return std::ranges::any_of(open_edges_, [&](const auto& edge) {
    const Vec3 along = edge.second - edge.first;
    const double share = std::clamp((p_W_m - edge.first).dot(along) / along.squaredNorm(), 0.0, 1.0);
    return (edge.first + share * along - p_W_m).norm() <= within_m;
  });
}

void SeamSearch::look(const TipState& tip, const StepResult& now) noexcept {
  if (now.contact) {
    pending_ = 0;
    return;
  }
  const double step_m = (tip.p_W_m - last_tip_).norm();
  if (last_.contact && last_.depth_m > 2.0 * step_m && near_open_edge(last_.contact_W_m, 2.0 * step_m)) {
    pending_ = confirm;
    candidate_ = {1, tip.t_s, last_.contact_W_m, last_.depth_m};
  }
  if (pending_ == 0) return;
  --pending_;
  const surface::SurfacePoint foot = surface_->closest(tip.p_W_m);
  if (foot.feature != surface::Feature::face || foot.n_W.dot(tip.p_W_m - foot.p_W_m) >= 0.0) return;
  pending_ = 0;
  if (losses_.count == 0)
    losses_ = candidate_;
  else
    ++losses_.count;
}

void SeamSearch::see(const TipState& tip, const StepResult& now) noexcept {
  if (open_edges_.empty() || now.status != StepStatus::ok) return;
  look(tip, now);
  last_ = now;
  last_tip_ = tip.p_W_m;
}

std::string seam_warning(const SeamLosses& losses) {
  if (losses.count == 0) return "";
  return fmt::format(
      "At {:g} s the tip, {:.3g} m deep, falls through an open seam of the mesh at ({:.6g}, {:.6g}, {:.6g}) m{}: there "
      "two sheets meet with a step or a gap, and the forces from then on are those of a tip behind them; touchstone "
      "doctor shows the open edges, and replay --weld closes them.",
      losses.first_t_s, losses.first_depth_m, losses.first_at_W_m.x(), losses.first_at_W_m.y(), losses.first_at_W_m.z(),
      losses.count > 1 ? fmt::format(" ({} times in all)", losses.count) : "");
}

}  // namespace touchstone::rendering
