#include "harness/pipeline/evaluation/inputs.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "harness/base/error.h"
#include "harness/base/progress.h"
#include "harness/base/units.h"
#include "harness/metrics/quantiles.h"
#include "harness/recording/extent_check.h"
#include "harness/recording_checks/check_recording.h"
#include "harness/rendering/nearness.h"
#include "harness/rendering/parameters.h"
#include "harness/report/quantity.h"
#include "harness/surface/embree_surface.h"
#include "harness/surface/extend_edges.h"
#include "harness/surface/mesh_file.h"
#include "harness/surface/mesh_repair.h"
#include "harness/surface/mesh_topology.h"
#include "harness/surface/mesh_warnings.h"

namespace touchstone::pipeline {
using recording::InTrajectoryMode;
using recording::RecordingStream;
using rendering::Catalogue;
using rendering::ParameterDeclaration;
using rendering::RendererEntry;

namespace {

constexpr std::size_t most_kept = 4096;

// Thins to every second when full, so that what is kept is spread evenly over the whole recording.
template <class T>
void thin(std::vector<T>& values) {
  for (std::size_t i = 0; 2 * i < values.size(); ++i) values[i] = values[2 * i];
  values.resize((values.size() + 1) / 2);
}

RecordingSurvey survey_recording(const EvaluationRequest& request) {
  RecordingSurvey out;
  RecordingStream stream = open_recording(request);
  out.has_force = stream.has(recording::ColumnGroup::force);
  metrics::Quantiles forces;
  Progress progress("reading " + request.recording.string(), 0);
  std::uint64_t stride = 1;
  recording::SampleBlock block;
  while (stream.next(block)) {
    for (std::size_t i = 0; i < block.size(); ++i) {
      const Vec3& p = block.motion.p_W_m[i];
      out.tips_W_m.extend(p);
      if (out.has_force) forces.add(block.f_W_N[i].norm());
      if ((block.first_sample + i) % stride != 0) continue;
      out.some_times_s.push_back(block.motion.t_s[i]);
      out.some_tips_W_m.push_back(p);
      if (!block.motion.q_WS.empty()) out.some_orientations_WS.push_back(block.motion.q_WS[i]);
      if (out.has_force) out.some_forces_W_N.push_back(request.flip_force ? Vec3(-block.f_W_N[i]) : block.f_W_N[i]);
      if (out.some_tips_W_m.size() < most_kept) continue;
      thin(out.some_times_s);
      thin(out.some_tips_W_m);
      thin(out.some_orientations_WS);
      thin(out.some_forces_W_N);
      stride *= 2;
    }
    progress.update(stream.samples());
  }
  out.samples = stream.samples();
  out.clock = stream.clock();
  out.notes = stream.notes();
  if (stream.has(recording::ColumnGroup::torque)) {
    out.notes.push_back(fmt::format(
        "{}: its torque is not judged, a renderer of a tip has none; of a tool with a shape `touchstone tool "
        "compare` and `touchstone tool fit` judge it",
        request.recording.string()));
  }
  if (out.has_force) out.usual_force_N = forces.quantile(0.99);
  return out;
}

std::vector<Vec3> touching_tips(const EvaluationRequest& request, const RecordingSurvey& survey) {
  std::vector<Vec3> touching;
  for (std::size_t i = 0; i < survey.some_forces_W_N.size(); ++i) {
    if (survey.some_forces_W_N[i].norm() > request.contact_threshold_N) touching.push_back(survey.some_tips_W_m[i]);
  }
  return touching;
}

// Of a recording with forces the gate of every command does it, in refuse_faults().
void refuse_far(const EvaluationRequest& request, EvaluationInputs& inputs) {
  const auto message =
      inputs.survey.has_force
          ? std::nullopt
          : rendering::far_from_surface(*inputs.surface, inputs.survey.some_tips_W_m, {}, inputs.tip_radius_m,
                                        request.recording.string(), request.mesh_unit);
  if (message) throw BadData(*message);
  // The recording touches the surface, but their sizes hardly fit: worth a word.
  const auto mismatch = recording::check_extents(inputs.survey.tips_W_m, inputs.mesh.bounds(), request.mesh_unit);
  if (mismatch) inputs.messages.push_back(mismatch->message);
}

// The gate of every command, on samples that are spread over the whole recording.
void refuse_faults(const EvaluationRequest& request, EvaluationInputs& inputs) {
  const RecordingSurvey& survey = inputs.survey;
  if (!survey.has_force) return;
  recording::Recording some;
  some.source = request.recording.string();
  some.motion = {survey.some_times_s, survey.some_tips_W_m, survey.some_orientations_WS};
  some.f_W_N = survey.some_forces_W_N;
  recording_checks::RecordingContext context;
  context.surface = inputs.surface.get();
  context.mesh_unit = request.mesh_unit;
  // The recording was made by the probe, also where renderers get the point at which it touched.
  context.tip_radius_m = request.probe_radius_m > 0.0 ? request.probe_radius_m : inputs.tip_radius_m;
  context.force_flipped = request.flip_force;
  context.contact_force_N = request.contact_threshold_N;
  for (std::string& remark : refuse_faulty(some, context)) inputs.messages.push_back(std::move(remark));
}

// What the renderer says of itself, as " (it renders a point)".
std::string point_reason(const RendererEntry& entry) {
  const rendering::Limitation* const limitation = find_limitation(entry.cannot, rendering::Ability::ball_tip);
  return limitation == nullptr ? "" : fmt::format(" ({})", limitation->reason);
}

// The tip that the request names, where the model does not name one. A renderer that cannot represent it is refused:
// fed the ball's centre it would answer for another place.
void set_tip_radius(const Catalogue& catalogue, const EvaluationRequest& request, const RendererEntry& entry,
                    EvaluationInputs& inputs) {
  if (!request.tip_radius_m) return;
  const auto named = catalogue.base_parameters(inputs.model);
  const auto place = named.find("tip_radius_m");
  const double model_m = place == named.end() ? 0.0 : place->second;
  if (model_m > 0.0 && model_m != *request.tip_radius_m) {
    throw UsageError(fmt::format("--tip-radius {} m and the model's tip_radius_m {} differ; give one of them",
                                 *request.tip_radius_m, model_m));
  }
  if (model_m > 0.0) return;
  const auto declared = std::ranges::find(entry.parameters, "tip_radius_m", &ParameterDeclaration::name);
  const bool has_balls = declared != entry.parameters.end();
  if (*request.tip_radius_m == 0.0) {
    if (has_balls && declared->minimum > 0.0)
      throw TipNotRepresentable(fmt::format(
          "{} renders balls only, of {} by default, and every renderer gets the point where the probe touched here. "
          "Give --tip-radius, or a model with tip_radius_m",
          entry.name, report::display_quantity(declared->initial, "m")));
    if (has_balls && declared->initial != 0.0) inputs.model.parameters["tip_radius_m"] = 0.0;
  } else if (has_balls) {
    inputs.model.parameters["tip_radius_m"] = *request.tip_radius_m;
  } else {
    throw TipNotRepresentable(fmt::format(
        "{} renders point tips only{}, and the probe was a ball of radius {}: its centre is not where it touched. Give "
        "--tip-radius 0, and every renderer gets the point where the ball touched",
        entry.name, point_reason(entry), report::display_quantity(*request.tip_radius_m, "m")));
  }
}

// An object that must be closed, and how open it is.
void look_at_edges(const EvaluationRequest& request, EvaluationInputs& inputs) {
  const surface::MeshTopology topology = make_topology(*inputs.surface->mesh());
  inputs.open_edges = topology.open_edge_count + topology.non_manifold_edges.size() + topology.disoriented_edges.size();
  if (request.closed && inputs.open_edges > 0) {
    throw BadData(fmt::format(
        "{}: a closed mesh is needed (--closed), but {} edges are open or not shared by two triangles that agree in "
        "orientation; `touchstone doctor` says where, --extend-edges fills small holes",
        request.mesh.string(), inputs.open_edges));
  }
}

void repair(EvaluationInputs& inputs) {
  surface::OrientedMesh repaired = orient(inputs.mesh);
  if (std::string note = repair_note(repaired); !note.empty()) inputs.messages.push_back(std::move(note));
  inputs.mesh = std::move(repaired.mesh);
}

void extend(double width_m, EvaluationInputs& inputs) {
  inputs.mesh = extend_open_edges(weld_coincident_vertices(inputs.mesh), width_m);
  inputs.extended_m = width_m;
}

// A scan of a part of an object, pressed where it ends: without more surface there the tip would slip over an edge that
// the object does not have, and every force after that would be lost.
void extend_where_the_mesh_has_ended(const EvaluationRequest& request, EvaluationInputs& inputs) {
  constexpr double few = 1e-3;               // less is noise at the border
  constexpr double share_of_diagonal = 0.1;  // several times the depth of any press that a patch of this size is for
  if (inputs.open_edges == 0) return;
  const surface::MeshTopology topology = make_topology(inputs.mesh);
  if (!topology.non_manifold_edges.empty() || !topology.disoriented_edges.empty()) return;
  const double share = share_at_open_edges(*inputs.surface, topology, touching_tips(request, inputs.survey));
  if (share <= few) return;
  extend(share_of_diagonal * inputs.mesh.bounds().diagonal().norm(), inputs);
  inputs.surface = make_embree_surface(inputs.mesh);
  look_at_edges(request, inputs);
  inputs.messages.push_back(
      fmt::format("{:.1f} % of the touching samples lie where the mesh has ended; its open edges were continued by {} "
                  "(--extend-edges sets the width, 0 leaves the mesh as it is).",
                  100.0 * share, report::display_setting(inputs.extended_m, "m")));
}

}  // namespace

RecordingStream open_recording(const EvaluationRequest& request) {
  recording::StreamOptions options;
  // Without force there is nothing to make an in-trajectory from; measured positions can be replayed all the same.
  options.need_force = request.in_trajectory != InTrajectoryMode::measured;
  options.clock = request.clock;
  return RecordingStream::open(request.recording, options);
}

bool can_have_tip(const Catalogue& catalogue, const rendering::Model& model, double tip_radius_m) {
  const RendererEntry& entry = catalogue.find(model);
  const auto declared = std::ranges::find(entry.parameters, "tip_radius_m", &ParameterDeclaration::name);
  if (declared == entry.parameters.end()) return tip_radius_m == 0.0;
  return tip_radius_m > 0.0 || declared->minimum == 0.0 || model.parameters.contains("tip_radius_m");
}

bool has_friction_in_proxy(const Catalogue& catalogue, const rendering::Model& model,
                           std::span<const std::string> fitted) {
  const RendererEntry& entry = catalogue.find(model);
  return std::ranges::any_of(entry.parameters, [&](const ParameterDeclaration& declared) {
    if (declared.name != "mu_static" && declared.name != "mu_dynamic") return false;
    if (std::ranges::find(fitted, declared.name) != fitted.end()) return true;
    const auto given = model.parameters.find(declared.name);
    return (given == model.parameters.end() ? declared.initial : given->second) > 0.0;
  });
}

InTrajectoryMode usual_in_trajectory(bool friction_in_proxy) {
  return friction_in_proxy ? InTrajectoryMode::whole_force : InTrajectoryMode::synthesize;
}

EvaluationInputs load_inputs(const Catalogue& catalogue, const EvaluationRequest& request) {
  EvaluationInputs inputs;
  inputs.model = request.model;
  const RendererEntry& entry = catalogue.find(inputs.model);  // a misspelt name is said before a large mesh is read
  set_tip_radius(catalogue, request, entry, inputs);
  const rendering::Parameters parameters(entry.parameters, catalogue.base_parameters(inputs.model),
                                         "renderer " + entry.name, inputs.model.source, "");
  const auto value = [&](std::string_view name) {
    const auto found = parameters.values().find(name);
    return found == parameters.values().end() ? 0.0 : found->second;
  };
  inputs.tip_radius_m = request.tip_radius_m.value_or(value("tip_radius_m"));
  inputs.stiffness_N_per_m = request.stiffness_N_per_m.value_or(value("stiffness_N_per_m"));
  if (request.in_trajectory != InTrajectoryMode::measured && !(inputs.stiffness_N_per_m > 0.0)) {
    throw UsageError(
        fmt::format("the renderer {} has no stiffness to make an in-trajectory with; give --stiffness, or "
                    "--in-trajectory measured",
                    entry.name));
  }
  inputs.mesh = surface::load_mesh(request.mesh, length_unit_factor(request.mesh_unit));
  for (std::string& note : reading_notes(inputs.mesh)) inputs.messages.push_back(std::move(note));
  if (request.repair) repair(inputs);
  if (request.extend_edges_m.value_or(0.0) > 0.0) extend(*request.extend_edges_m, inputs);
  inputs.surface = make_embree_surface(inputs.mesh);
  look_at_edges(request, inputs);
  for (const std::string& warning : mesh_warnings(*inputs.surface)) inputs.messages.push_back(warning);
  inputs.survey = survey_recording(request);
  if (!request.extend_edges_m) extend_where_the_mesh_has_ended(request, inputs);
  refuse_far(request, inputs);
  refuse_faults(request, inputs);
  inputs.files.push_back(report::describe_input("recording", request.recording));
  if (!request.repeat.empty()) {
    inputs.floor = recording_checks::repeat_floor_of_files(request.recording, request.repeat);
    inputs.files.push_back(report::describe_input("repeat", request.repeat));
  }
  inputs.files.push_back(report::describe_input("mesh", request.mesh));
  if (!request.model_file.empty()) inputs.files.push_back(report::describe_input("model", request.model_file));
  return inputs;
}

}  // namespace touchstone::pipeline
