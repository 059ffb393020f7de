#include "tool_renderers/voxmap_pointshell.h"

#include <Eigen/Cholesky>
#include <algorithm>

#include "harness/surface/embree_surface.h"
#include "tool_renderers/least_constraint.h"
#include "tool_renderers/shell_parameters.h"

namespace touchstone::tool_renderers {

tool::ToolRendererEntry voxmap_pointshell_entry() {
  tool::ToolRendererEntry entry;
  entry.name = "voxmap-pointshell";
  entry.summary = "tangent-plane force of a point shell in voxels";
  entry.source = "McNeely, Puterbaugh and Troy 1999, 2005";
  entry.parameters = {
      contact_stiffness_parameter(), {"voxel_m", "m", 1e-6, 1.0, 0.5e-3, "edge of a voxel"}, point_spacing_parameter()};
  entry.takes_points = true;
  entry.make = [](const rendering::Parameters& parameters, const tool::Tool& tool,
                  const surface::TriangleMesh& object_W,
                  const tool::Coupling& coupling) -> std::unique_ptr<tool::ToolRenderer> {
    return std::make_unique<VoxmapPointshell>(shell_of(tool, parameters.at("point_spacing_m")),
                                              *make_embree_surface(object_W), parameters.at("voxel_m"), coupling,
                                              parameters.at("contact_stiffness_N_per_m"));
  };
  entry.resolution_m = [](const rendering::Parameters& parameters, double /*force_N*/) {
    return parameters.at("voxel_m");
  };
  entry.exact_normals = false;
  return entry;
}

VoxmapPointshell::VoxmapPointshell(const tool::PointShell& shell, const surface::Surface& object, double voxel_m,
                                   const tool::Coupling& coupling, double contact_stiffness_N_per_m)
    : shell_(shell), map_(object, voxel_m), coupling_(coupling), stiffness_N_per_m_(contact_stiffness_N_per_m) {
  for (const Vec3& p : shell_.p_T_m) reach_m_ = std::max(reach_m_, p.norm());
}

tool::ToolResult VoxmapPointshell::do_step(const tool::ToolState& state, double /*dt_s*/) noexcept {
  if (!placed_) {
    proxy_ = state.handle;
    placed_ = true;
  }
  constexpr double full_force_up_to = 10.0;  // points: McNeely et al. 1999, section 5
  // Several steps per tick only while the proxy is far behind: what a tick may cost is bounded.
  constexpr int most_steps = 4;
  const double longest_step_m = 0.5 * map_.voxel_m();
  std::size_t touching = 0;
  std::size_t listed = 0;
  for (int round = 0; round < most_steps; ++round) {
    const Mat3 rotation = proxy_.q_WT.toRotationMatrix();
    touching = listed = 0;
    Vec6 push = Vec6::Zero();
    Eigen::Matrix<double, 6, 6> give = Eigen::Matrix<double, 6, 6>::Zero();
    for (std::size_t i = 0; i < shell_.size(); ++i) {
      const Vec3 r = rotation * shell_.p_T_m[i];
      const Vec3 p = proxy_.p_W_m + r;
      const Voxmap::Place place = map_.at_point(p);
      if (place.layer == Voxmap::free_voxel) continue;
      const Vec3 n = rotation * shell_.inward_T[i];
      const double d = n.dot(place.center_W_m - p) + double(place.layer - Voxmap::surface_voxel) * map_.voxel_m();
      if (!(d > 0.0)) continue;
      Vec6 w;
      w << n, r.cross(n);
      push += stiffness_N_per_m_ * d * w;
      give.noalias() += stiffness_N_per_m_ * w * w.transpose();
      if (listed < most_contacts) contacts_[listed++] = {p, n, stiffness_N_per_m_ * d * n};
      ++touching;
    }
    const double share = double(touching) > full_force_up_to ? full_force_up_to / double(touching) : 1.0;
    for (std::size_t i = 0; i < listed; ++i) contacts_[i].f_W_N *= share;
    const Wrench pull = coupling_wrench(coupling_, state.handle, proxy_);
    push *= share;
    push.head<3>() -= pull.f_N;
    push.tail<3>() -= pull.torque_Nm;
    give *= share;
    give.diagonal().head<3>().array() += coupling_.stiffness_N_per_m;
    give.diagonal().tail<3>().array() += coupling_.rotational_stiffness_Nm_per_rad;
    const Vec6 by = Eigen::LLT<Eigen::Matrix<double, 6, 6>>(give).solve(push);
    const double way = by.head<3>().norm() + reach_m_ * by.tail<3>().norm();
    const double part = way > longest_step_m ? longest_step_m / way : 1.0;
    proxy_ = moved(proxy_, {part * by.head<3>(), part * by.tail<3>()});
    if (part == 1.0) break;
  }
  tool::ToolResult result;
  result.proxy = proxy_;
  result.contact = touching > 0;
  if (result.contact) {
    const Wrench wrench = coupling_wrench(coupling_, state.handle, proxy_);
    result.f_W_N = wrench.f_N;
    result.torque_W_Nm = wrench.torque_Nm;
  }
  result.contacts = {contacts_.data(), listed};
  return result;
}

}  // namespace touchstone::tool_renderers
