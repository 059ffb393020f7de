#include "harness/pipeline/perceiving/processes.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "harness/base/error.h"
#include "harness/base/in_parallel.h"
#include "harness/base/units.h"
#include "harness/perception/filters/weber_law.h"
#include "harness/perception/haptic_data_matrix.h"
#include "harness/pipeline/evaluation/inputs.h"
#include "harness/recording/recording_file.h"
#include "harness/recording_checks/check_recording.h"
#include "harness/recording_checks/pair_faults.h"
#include "harness/recording_checks/recording_sample.h"
#include "harness/rendering/in_trajectory.h"
#include "harness/rendering/out_trajectory.h"
#include "harness/rendering/replay.h"
#include "harness/surface/embree_surface.h"
#include "harness/surface/extend_edges.h"
#include "harness/surface/mesh_file.h"
#include "harness/surface/mesh_topology.h"

namespace touchstone::pipeline {
using recording::InTrajectoryMode;
using recording::Recording;
using surface::Surface;

Vec3 press_direction_of(const std::string& text, const Recording& real) {
  static const std::map<std::string, Vec3> axes{{"+x", Vec3::UnitX()},  {"-x", -Vec3::UnitX()}, {"+y", Vec3::UnitY()},
                                                {"-y", -Vec3::UnitY()}, {"+z", Vec3::UnitZ()},  {"-z", -Vec3::UnitZ()}};
  if (text == "force") return perception::press_direction(real);
  const auto found = axes.find(text);
  if (found == axes.end())
    throw UsageError(fmt::format("--direction {}: force, +x, -x, +y, -y, +z or -z was expected", text));
  return found->second;
}

namespace {

// The model's, or its renderer's default; 0 where the renderer has no such parameter.
double parameter_of(const rendering::Catalogue& catalogue, const rendering::Model& model, std::string_view name) {
  const rendering::RendererEntry& entry = catalogue.find(model);
  const rendering::Parameters parameters(entry.parameters, catalogue.base_parameters(model), "renderer " + entry.name,
                                         model.source, "");
  const auto found = parameters.values().find(name);
  return found == parameters.values().end() ? 0.0 : found->second;
}

}  // namespace

InTrajectoryMode models_path_of(const rendering::Catalogue& catalogue, const PerceiveRequest& request,
                                const Recording& real, const Surface& surface, std::vector<std::string>& notes) {
  if (request.in_trajectory) return *request.in_trajectory;
  double radius_m = 0.0;
  bool friction = false;
  for (const PerceiveRequest::Rendering& one : request.models) {
    radius_m = std::max(radius_m, parameter_of(catalogue, one.model, "tip_radius_m"));
    friction = friction || has_friction_in_proxy(catalogue, one.model);
  }
  const rendering::DepthUnderForce felt = rendering::depth_under_force(real, surface, radius_m);
  if (!felt.is_rigid()) return InTrajectoryMode::measured;
  const InTrajectoryMode mode = usual_in_trajectory(friction);
  notes.push_back(fmt::format(
      "in-trajectory: {}: at {:.3g} N the real tip is {:.3g} mm deep in the object (medians), as on a rigid one: "
      "models are "
      "fed the path made of the force{}, so that their stiffness is not judged (--in-trajectory chooses)",
      recording::in_trajectory_name(mode), felt.force_N, 1e3 * felt.depth_m,
      friction ? "" : " along the normal (equation 2)"));
  return mode;
}

Recording rendered_by(const rendering::Catalogue& catalogue, const rendering::Model& model,
                      const std::shared_ptr<const Surface>& surface, const Recording& real, const MotionColumns& along,
                      InTrajectoryMode mode) {
  const auto renderer = catalogue.make(model, surface);
  recording::InTrajectory path{along};
  if (mode != InTrajectoryMode::measured) {
    const double stiffness_N_per_m = parameter_of(catalogue, model, "stiffness_N_per_m");
    if (!(stiffness_N_per_m > 0.0)) {
      throw UsageError(
          fmt::format("{}: the renderer {} has no stiffness to make a path of the force with; give "
                      "--in-trajectory measured",
                      model.source, model.renderer));
    }
    Recording moved = real;
    moved.motion = along;
    const recording::OutTrajectory out = rendering::make_out_trajectory(
        moved, *surface, {.tip_radius_m = parameter_of(catalogue, model, "tip_radius_m")});
    path = mode == InTrajectoryMode::whole_force
               ? rendering::whole_force_in_trajectory(out, real.f_W_N, stiffness_N_per_m)
               : rendering::synthesize_in_trajectory(out, stiffness_N_per_m);
  }
  const recording::RenderedTrajectory rendered = replay(*renderer, path);
  Recording recording;
  recording.motion = real.motion;
  recording.f_W_N = rendered.f_W_N;
  recording.source = model.source;
  return recording;
}

Recording read_recording(const PerceiveRequest& request, const std::string& file) {
  Recording recording = recording::load_recording(file);
  if (request.flip_force) recording_checks::flip_force(recording);
  return recording;
}

void check_real(const PerceiveRequest& request, const Recording& real, const Surface* surface,
                std::vector<std::string>& notes) {
  recording_checks::RecordingContext context;
  context.surface = surface;
  context.mesh_unit = request.mesh_unit;
  context.force_flipped = request.flip_force;
  context.contact_force_N = perception::fingertip_force.absolute_threshold;
  for (std::string& remark : recording_checks::refuse_faulty(real, context)) notes.push_back(std::move(remark));
}

void check_condition(const Recording& real, const Recording& condition) {
  for (const recording_checks::RecordingFinding& finding : recording_checks::find_pair_faults(real, condition)) {
    if (finding.fault == recording_checks::RecordingFault::clock)
      continue;  // a rendering that answers late is what is to be judged
    throw BadData(
        fmt::format("{}: {}: {}", condition.source, to_string(finding.fault), recording_checks::finding_line(finding)));
  }
}

// In parallel: hashing many recordings takes as long as comparing them.
std::vector<report::InputFile> described(const RolesAndFiles& role_and_file) {
  std::vector<report::InputFile> result(role_and_file.size());
  const auto describe = [&](std::size_t i) {
    result[i] = report::describe_input(role_and_file[i].first, role_and_file[i].second);
  };
  in_parallel(result.size(), describe, 1);
  return result;
}

std::shared_ptr<const Surface> rendered_object(const PerceiveRequest& request, const Recording& real,
                                               std::vector<std::string>& notes) {
  constexpr double few = 1e-3;               // less is noise at the border
  constexpr double share_of_diagonal = 0.1;  // as `evaluate` has it
  constexpr std::size_t looked_at = 4000;
  surface::TriangleMesh mesh = surface::load_mesh(request.mesh, length_unit_factor(request.mesh_unit));
  std::shared_ptr<const Surface> surface = make_embree_surface(mesh);
  const bool asked = !request.extend_edges.empty();
  const double asked_m =
      asked && request.extend_edges != "0" ? parse_length_m(request.extend_edges, "--extend-edges") : 0.0;
  if (asked && asked_m == 0.0) return surface;
  const surface::MeshTopology topology = make_topology(mesh);
  double share = 0.0;
  if (!asked) {
    if (topology.open_edge_count == 0 || !topology.non_manifold_edges.empty() || !topology.disoriented_edges.empty())
      return surface;
    std::vector<Vec3> touching;
    const std::size_t stride = 1 + real.f_W_N.size() / looked_at;
    for (std::size_t i = 0; i < real.f_W_N.size(); i += stride) {
      if (real.f_W_N[i].norm() > perception::fingertip_force.absolute_threshold)
        touching.push_back(real.motion.p_W_m[i]);
    }
    share = share_at_open_edges(*surface, topology, touching);
    if (share <= few) return surface;
  }
  const double width_m = asked_m > 0.0 ? asked_m : share_of_diagonal * mesh.bounds().diagonal().norm();
  mesh = extend_open_edges(weld_coincident_vertices(mesh), width_m);
  if (!asked) {
    notes.push_back(
        fmt::format("{:.1f} % of the touching samples lie where the mesh has ended; its open edges were "
                    "continued by {:.4g} mm (--extend-edges sets the width, 0 leaves the mesh as it is)",
                    100.0 * share, 1e3 * width_m));
  }
  return make_embree_surface(mesh);
}

}  // namespace touchstone::pipeline
