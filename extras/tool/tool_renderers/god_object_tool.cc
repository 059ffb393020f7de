#include "tool_renderers/god_object_tool.h"

#include <algorithm>
#include <cmath>

namespace touchstone::tool_renderers {
namespace {

// Pairs are looked for within the margin; a displacement moves no point of the tool by more. A wider one costs more
// pairs, a narrower one more rounds where the hand is fast.
constexpr double least_margin_m = 20e-6;
constexpr double most_margin_m = 0.5e-3;
// Near the object a round moves no point by more: as far as an overlap that is pushed out again.
constexpr double near_way_m = 0.2e-3;
// Overlaps that turning about a contact leaves (second order in the margin) are pushed out again; deeper ones are
// another side of the body.
constexpr double overlap_m = 0.2e-3;
constexpr int most_rounds = 8;
// The proxy rests when a round moves it by less: far below what any sensor or hand resolves.
constexpr double rest_m = 1e-8;

}  // namespace

tool::ToolRendererEntry god_object_tool_entry() {
  tool::ToolRendererEntry entry;
  entry.name = "god-object-tool";
  entry.summary = "constraint-based god-object for rigid bodies";
  entry.source = "Ortega, Redon and Coquillart 2007";
  entry.parameters = {tool::unit_parameter()};
  entry.make = [](const rendering::Parameters& parameters, const tool::Tool& tool,
                  const surface::TriangleMesh& object_W,
                  const tool::Coupling& coupling) -> std::unique_ptr<tool::ToolRenderer> {
    return std::make_unique<GodObjectTool>(tool, object_W, coupling, parameters.at(tool::unit_parameter_name));
  };
  return entry;
}

GodObjectTool::GodObjectTool(const tool::Tool& tool, const surface::TriangleMesh& object_W,
                             const tool::Coupling& coupling, double unit_m)
    : tool_(tool.mesh_T), object_(object_W), near_(tool_, object_, unit_m), coupling_(coupling), unit_m_(unit_m) {}

tool::ToolResult GodObjectTool::do_step(const tool::ToolState& state, double /*dt_s*/) noexcept {
  // In the unit of the meshes.
  const double least_margin = least_margin_m / unit_m_;
  const double most_margin = most_margin_m / unit_m_;
  const double overlap = overlap_m / unit_m_;
  if (!placed_) {
    proxy_ = state.handle;
    margin_m_ = most_margin;
    placed_ = true;
  }
  // Coordinates in which the metric is the unit matrix: sqrt(k_t) dp and sqrt(k_r) dw.
  const double root_t = std::sqrt(coupling_.stiffness_N_per_m);
  const double root_r = std::sqrt(coupling_.rotational_stiffness_Nm_per_rad);
  std::size_t contact_count = 0;
  for (int round = 0; round < most_rounds; ++round) {
    const tool::Displacement free = displacement(proxy_, state.handle);
    const std::size_t count = near_.find(proxy_, margin_m_, overlap, pairs_);
    for (std::size_t i = 0; i < count; ++i) {
      const NearPair& pair = pairs_[i];
      half_spaces_[i].a << pair.n_W / root_t, (pair.at_W_m - proxy_.p_W_m).cross(pair.n_W) / root_r;
      half_spaces_[i].b = -pair.gap_m;
    }
    Vec6 u;
    u << root_t * free.translation_m, root_r * free.rotation_rad;
    constexpr double rounding_m = 1e-12;
    const LeastConstraint least = least_constraint({half_spaces_.data(), count}, u, rounding_m / unit_m_);
    tool::Displacement by;
    if (least.found) by = {least.y.head<3>() / root_t, least.y.tail<3>() / root_r};
    contact_count = 0;
    for (int k = 0; k < least.active_count; ++k) {
      const auto i = static_cast<std::size_t>(k);
      const NearPair& pair = pairs_[static_cast<std::size_t>(least.active[i])];
      contacts_[contact_count++] = {pair.at_W_m, pair.n_W, least.multiplier[i] * pair.n_W};
    }
    // No point of the tool moves farther than the margin, within which all pairs are known.
    const double way = by.translation_m.norm() + tool_.reach_m() * by.rotation_rad.norm();
    const double longest = count > 0 ? std::min(margin_m_, near_way_m / unit_m_) : margin_m_;
    const double share = way > longest ? longest / way : 1.0;
    proxy_ = moved(proxy_, {share * by.translation_m, share * by.rotation_rad});
    margin_m_ = std::clamp(2.0 * way, least_margin, most_margin);
    if (way < rest_m / unit_m_) break;
  }
  tool::ToolResult result;
  const Wrench wrench = coupling_wrench(coupling_, state.handle, proxy_);
  result.contact = contact_count > 0;
  result.proxy = proxy_;
  if (result.contact) {
    result.f_W_N = wrench.f_N;
    result.torque_W_Nm = wrench.torque_Nm;
  }
  result.contacts = {contacts_.data(), contact_count};
  return result;
}

}  // namespace touchstone::tool_renderers
