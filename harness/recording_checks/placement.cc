#include "harness/recording_checks/placement.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "harness/surface/mesh_topology.h"

namespace touchstone::recording_checks {
using recording::Recording;
using surface::Feature;

namespace {

constexpr std::size_t most_samples_placed = 20000;
constexpr std::size_t fewest_pushing = 20;
// Of the object's diagonal: what trackers are off by, and what a mesh of an object that gives way is off by here and
// there (a surface fitted to a raster leaves its margins by up to 1.4 % of its diagonal).
constexpr double near_share = 0.005, mesh_share = 0.02;
// Friction in air, weights and biases push nowhere along the normal.
constexpr double pushes_along_normal = 0.8;

// Where the samples that push have their tips.
struct Placement {
  std::vector<double> gaps_m;                        // from the tip's surface to the object, negative inside
  double along_N = 0.0, size_N = 0.0;                // sums of f . n and |f|
  double beyond_N = 0.0, outside_N = 0.0;            // loads with the tip beyond an open edge, and above the object
  double sideways_m = 0.0, above_m = 0.0;            // the farthest of these
  double largest_inside_N = 0.0, elsewhere_N = 0.0;  // the largest load inside, and beyond or outside
};

// Whether the closest point lies on an edge that only one triangle has.
bool on_open_edge(const surface::Surface& surface, const surface::SurfacePoint& foot) {
  const surface::MeshTopology* const topology = surface.topology();
  if (topology == nullptr || foot.triangle < 0 || foot.feature == Feature::face || foot.feature == Feature::analytic) {
    return false;
  }
  const auto open = [&](std::int32_t triangle) {
    const auto& beside = topology->neighbours[static_cast<std::size_t>(triangle)];
    return std::ranges::count(beside, surface::open_edge) > 0;
  };
  if (open(foot.triangle)) return true;
  // A corner may belong to the edge by another triangle of its fan.
  for (const std::int32_t corner : surface.mesh()->triangles[static_cast<std::size_t>(foot.triangle)]) {
    const auto vertex = static_cast<std::size_t>(corner);
    if (foot.feature != Feature::vertex || surface.mesh()->vertices_W_m[vertex] != foot.p_W_m) continue;
    return std::ranges::any_of(topology->fan(vertex), open);
  }
  return false;
}

Placement place(const Recording& r, const RecordingContext& context, double touching_N, double near_m) {
  Placement p;
  const std::size_t stride = r.size() / most_samples_placed + 1;
  for (std::size_t i = 0; i < r.size(); i += stride) {
    const double size_N = r.f_W_N[i].norm();
    if (!(size_N > touching_N)) continue;
    const surface::SurfacePoint foot = context.surface->closest(r.motion.p_W_m[i]);
    const Vec3 away = r.motion.p_W_m[i] - foot.p_W_m;
    const double gap_m = foot.signed_distance_m - context.tip_radius_m, load_N = r.f_W_N[i].dot(foot.n_W);
    p.gaps_m.push_back(gap_m);
    p.along_N += load_N, p.size_N += size_N;
    if (!(load_N > pushes_along_normal * size_N)) continue;
    const double sideways_m = (away - away.dot(foot.n_W) * foot.n_W).norm();
    // A ball rests on an edge with its centre half beyond it.
    if (sideways_m > near_m + context.tip_radius_m && on_open_edge(*context.surface, foot)) {
      p.beyond_N += load_N;
      p.sideways_m = std::max(p.sideways_m, sideways_m);
      p.elsewhere_N = std::max(p.elsewhere_N, load_N);
    } else if (gap_m > near_m) {
      p.outside_N += load_N;
      p.above_m = std::max(p.above_m, gap_m);
      p.elsewhere_N = std::max(p.elsewhere_N, load_N);
    } else {
      p.largest_inside_N = std::max(p.largest_inside_N, load_N);
    }
  }
  std::ranges::sort(p.gaps_m);
  return p;
}

}  // namespace

std::optional<RecordingFinding> find_misplacement(const Recording& r, const RecordingContext& context,
                                                  double touching_N, double noticed_share_of_load) {
  const double near_m = near_share * context.surface->bounds().diagonal().norm();
  const Placement p = place(r, context, touching_N, mesh_share / near_share * near_m);
  if (p.gaps_m.size() < fewest_pushing || !(p.along_N > 0.0)) return std::nullopt;
  const double low_m = p.gaps_m[p.gaps_m.size() / 20], middle_m = p.gaps_m[p.gaps_m.size() / 2];
  const bool pushes = p.along_N > pushes_along_normal * p.size_N;
  if (pushes && p.beyond_N == 0.0 && low_m > near_m) {
    return RecordingFinding{
        FaultWeight::remark, RecordingFault::registration,
        fmt::format("19 of 20 samples with force have the tip outside of the object, by {:.3g} m in the middle",
                    middle_m),
        fmt::format(
            "is the tip a ball (--tip-radius {0:.3g}mm, or {1:.3g} as tip_radius_m of the model), or the object "
            "registered wrongly?",
            1e3 * (middle_m + context.tip_radius_m), middle_m + context.tip_radius_m)};
  }
  const double beyond = p.beyond_N / p.size_N, outside = p.outside_N / p.size_N;
  // A bias that shows in air is small against the loads of contact.
  constexpr double no_bias = 0.3;
  if (!(beyond + outside > noticed_share_of_load) || !(p.elsewhere_N > no_bias * p.largest_inside_N)) {
    return std::nullopt;
  }
  std::string message;
  if (beyond > 0.0) {
    message = fmt::format("{:.0f} % of the load is measured up to {:.3g} m beyond the edge of the mesh", 100.0 * beyond,
                          p.sideways_m);
  }
  if (outside > 0.0) {
    message += fmt::format("{}{:.0f} % {}with the tip outside of the object, by up to {:.3g} m",
                           message.empty() ? "" : " and ", 100.0 * outside,
                           message.empty() ? "of the load is measured " : "", p.above_m);
  }
  return RecordingFinding{
      FaultWeight::remark, RecordingFault::registration, std::move(message),
      "is this the surface that was touched, and are both in one frame? Register the object anew, or "
      "cut the recording to the part that the mesh covers"};
}

std::optional<RecordingFinding> touches_nothing(const Recording& r, const RecordingContext& context) {
  const std::size_t stride = r.size() / most_samples_placed + 1;
  for (const Vec3& f : r.f_W_N) {
    if (f.norm() > context.contact_force_N) return std::nullopt;
  }
  for (std::size_t i = 0; i < r.size(); i += stride) {
    if (context.surface->signed_distance(r.motion.p_W_m[i]) < context.tip_radius_m) return std::nullopt;
  }
  return RecordingFinding{
      FaultWeight::remark, RecordingFault::no_contact,
      fmt::format("nothing is touched: the tip stays outside of the object and the force below {:.2g} "
                  "N",
                  context.contact_force_N),
      "is it a run in free air?"};
}

}  // namespace touchstone::recording_checks
