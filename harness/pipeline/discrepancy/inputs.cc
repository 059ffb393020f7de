#include "harness/pipeline/discrepancy/inputs.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>
#include <vector>

#include "harness/base/error.h"
#include "harness/base/units.h"
#include "harness/pipeline/discrepancy/curve_zero.h"
#include "harness/plugin/plugin.h"
#include "harness/recording/recording_file.h"
#include "harness/recording_checks/check_recording.h"
#include "harness/rendering/declared_effect.h"
#include "harness/rendering/in_trajectory.h"
#include "harness/rendering/named_declaration.h"
#include "harness/rendering/out_trajectory.h"
#include "harness/surface/embree_surface.h"
#include "harness/surface/extend_edges.h"
#include "harness/surface/mesh_file.h"
#include "harness/surface/mesh_repair.h"
#include "harness/surface/mesh_topology.h"
#include "harness/surface/mesh_warnings.h"

namespace touchstone::pipeline {
using recording::Recording;

namespace {

// Two triangles that reach far beyond the recording; `remarks` get a sentence if they do not lie in z = 0.
surface::TriangleMesh half_space(const Recording& recording, std::vector<std::string>& remarks) {
  Box3 box;
  for (const Vec3& p : recording.motion.p_W_m) box.extend(p);
  const double half = 10.0 * std::max(box.diagonal().norm(), 1e-9);
  const std::optional<CurveZero> zero = find_curve_zero(recording);
  const Vec3 c(box.center().x(), box.center().y(), zero ? zero->z_W_m : 0.0);
  surface::TriangleMesh mesh;
  mesh.vertices_W_m = {c + Vec3(-half, -half, 0), c + Vec3(half, -half, 0), c + Vec3(half, half, 0),
                       c + Vec3(-half, half, 0)};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  mesh.source = "half-space below z = 0";
  if (zero) {
    mesh.source = fmt::format("half-space below z = {:.6g} mm", 1e3 * zero->z_W_m);
    remarks.push_back(fmt::format(
        "note: {}: a curve whose z counts from elsewhere: the surface is taken to lie at z = {:.6g} mm, where "
        "the force of the first approach begins to rise, {:.3g} mm above its deepest point; --mesh gives "
        "another surface",
        recording.source, 1e3 * zero->z_W_m, 1e3 * zero->deepest_m));
  }
  return mesh;
}

// A scan of a part of an object, pressed where it ends: without more surface there the tip would slip over an edge that
// the object does not have, and every force after that would be lost.
void continue_where_the_mesh_has_ended(DiscrepancyInputs& inputs) {
  constexpr double few = 1e-3;
  constexpr double share_of_diagonal = 0.1;
  const surface::MeshTopology topology = make_topology(inputs.mesh);
  if (topology.open_edge_count == 0 || !topology.non_manifold_edges.empty() || !topology.disoriented_edges.empty()) {
    return;
  }
  std::vector<Vec3> touching;
  for (std::size_t i = 0; i < inputs.train.size(); ++i) {
    if (inputs.train.f_W_N[i].norm() > rendering::default_contact_threshold_N)
      touching.push_back(inputs.train.motion.p_W_m[i]);
  }
  if (share_at_open_edges(*inputs.surface, topology, touching) <= few) return;
  inputs.mesh = extend_open_edges(weld_coincident_vertices(inputs.mesh),
                                  share_of_diagonal * inputs.mesh.bounds().diagonal().norm());
  inputs.surface = make_embree_surface(inputs.mesh);
}

void synthesize(Recording& recording, const surface::Surface& surface, const rendering::Model& model) {
  const auto stiffness = model.parameters.find("stiffness_N_per_m");
  if (stiffness == model.parameters.end()) {
    throw BadData(
        fmt::format("{}: /parameters: stiffness_N_per_m is needed to synthesize the in-trajectory", model.source));
  }
  const auto radius = model.parameters.find("tip_radius_m");
  const rendering::OutTrajectoryRule rule{radius == model.parameters.end() ? 0.0 : radius->second};
  recording.motion =
      rendering::synthesize_in_trajectory(make_out_trajectory(recording, surface, rule), stiffness->second).motion;
}

void flip_forces(Recording& recording) {
  for (Vec3& f : recording.f_W_N) f = -f;
  for (Vec3& torque : recording.torque_W_Nm) torque = -torque;
}

// Before anything is fitted: what a recording with a fault would be explained by has no meaning.
void check_recordings(const DiscrepancyFiles& files, DiscrepancyInputs& inputs) {
  recording_checks::RecordingContext context;
  context.surface = inputs.surface.get();
  context.mesh_unit = files.mesh_unit;
  const auto radius = inputs.model.parameters.find("tip_radius_m");
  context.tip_radius_m = radius == inputs.model.parameters.end() ? 0.0 : radius->second;
  context.force_flipped = files.flip_force;
  context.contact_force_N = rendering::default_contact_threshold_N;
  for (const Recording* const recording : {&inputs.train, inputs.holdout ? &*inputs.holdout : nullptr}) {
    if (recording == nullptr) continue;
    for (const std::string& remark : refuse_faulty(*recording, context)) inputs.remarks.push_back("warning: " + remark);
  }
}

void warn_of_a_rigid_object(DiscrepancyInputs& inputs) {
  const auto radius = inputs.model.parameters.find("tip_radius_m");
  const auto felt = rendering::depth_under_force(inputs.train, *inputs.surface,
                                                 radius == inputs.model.parameters.end() ? 0.0 : radius->second);
  if (!felt.is_rigid()) return;
  inputs.remarks.push_back(fmt::format(
      "warning: {}: at {:.3g} N the tip is {:.3g} mm deep in the object (medians), as on a rigid one: along the "
      "measured path "
      "the model answers with next to nothing; --in-trajectory synthesize makes the path of surface and force",
      inputs.train.source, felt.force_N, 1e3 * felt.depth_m));
}

}  // namespace

DiscrepancyInputs load_inputs(const rendering::Catalogue& catalogue, const DiscrepancyFiles& files) {
  DiscrepancyInputs inputs;
  inputs.model = files.plugins != nullptr ? plugin::load_model(files.model, *files.plugins, renderer_names(catalogue))
                                          : rendering::load_model(files.model);
  inputs.train = recording::load_recording(files.recording);
  if (!files.holdout.empty()) inputs.holdout = recording::load_recording(files.holdout);
  if (files.flip_force) {
    flip_forces(inputs.train);
    if (inputs.holdout) flip_forces(*inputs.holdout);
  }
  inputs.mesh = files.mesh.empty() ? half_space(inputs.train, inputs.remarks)
                                   : surface::load_mesh(files.mesh, length_unit_factor(files.mesh_unit));
  if (files.repair) {
    surface::OrientedMesh repaired = orient(inputs.mesh);
    if (std::string note = repair_note(repaired); !note.empty()) inputs.remarks.push_back(std::move(note));
    inputs.mesh = std::move(repaired.mesh);
  }
  inputs.surface = make_embree_surface(inputs.mesh);
  for (const std::string& warning : mesh_warnings(*inputs.surface)) inputs.remarks.push_back("warning: " + warning);
  if (!files.mesh.empty()) continue_where_the_mesh_has_ended(inputs);
  check_recordings(files, inputs);
  if (files.synthesize_in_trajectory) {
    synthesize(inputs.train, *inputs.surface, inputs.model);
    if (inputs.holdout) synthesize(*inputs.holdout, *inputs.surface, inputs.model);
  } else if (!files.mesh.empty()) {
    warn_of_a_rigid_object(inputs);
  }
  return inputs;
}

std::vector<rendering::Candidate> all_candidates(const rendering::Catalogue& catalogue,
                                                 const std::vector<std::filesystem::path>& effects) {
  using rendering::Candidate;
  using rendering::Side;
  std::vector<Candidate> candidates;
  for (const auto& effect : catalogue.effects()) {
    if (effect.hypothesis) candidates.push_back({effect.name, Side::contact, effect.parameters, effect.traits});
  }
  for (const auto& entry : catalogue.instrument_entries()) {
    candidates.push_back({entry.name, Side::instrument, entry.parameters, entry.traits});
  }
  for (const std::filesystem::path& file : effects) {
    auto law = std::make_shared<const rendering::DeclaredEffect>(rendering::load_effect(file));
    const bool known = std::ranges::find(candidates, law->name, &Candidate::name) != candidates.end() ||
                       std::ranges::find(catalogue.effects(), law->name, &rendering::NamedDeclaration::name) !=
                           catalogue.effects().end();
    if (known) {
      throw BadData(fmt::format("{}: /name: there is an effect {} already; give this one a name of its own",
                                file.string(), law->name));
    }
    candidates.push_back(
        {law->name, law->is_instrument() ? Side::instrument : Side::contact, law->parameters, law->traits, law});
  }
  return candidates;
}

}  // namespace touchstone::pipeline
