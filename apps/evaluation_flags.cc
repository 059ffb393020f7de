#include "apps/evaluation_flags.h"

#include <fmt/format.h>

#include "apps/command.h"
#include "harness/base/error.h"
#include "harness/base/units.h"

namespace touchstone::apps {
using recording::InTrajectoryMode;

void add_evaluation_flags(CLI::App& command, EvaluationFlags& flags) {
  command.add_option("--recording", flags.recording, "Measured time, position and force: CSV (also .gz) or HDF5");
  command.add_option("--repeat", flags.repeat,
                     "A second recording of the same motion: what the two differ by is the floor that errors are held "
                     "against");
  command.add_option("--mesh", flags.mesh, "The object: OBJ, OFF, PLY or STL, also .gz");
  command.add_option("--mesh-unit", flags.mesh_unit, "Unit of the mesh's coordinates: m, mm, cm, km, um, in, ft")
      ->capture_default_str();
  command
      .add_option(
          "--in-trajectory", flags.in_trajectory,
          "synthesize: the path whose surface contact point would follow the measured one, from the normal force; "
          "whole-force: the same from the whole force, for renderers with friction in their proxy; measured: the "
          "measured positions as they are, for compliant objects. Default: whole-force if a renderer has friction in "
          "its "
          "proxy (a mu above 0 of its own), else synthesize; a data set says its own")
      ->check(CLI::IsMember({"synthesize", "whole-force", "measured"}));
  command.add_option("--tip-radius", flags.tip_radius,
                     "The tip is a ball of this radius and positions are its centre: 3.15mm");
  command.add_option("--stiffness", flags.stiffness_N_per_m,
                     "Stiffness for the in-trajectory [N/m]; the model's where not given");
  command.add_option("--contact-threshold", flags.contact_threshold,
                     "Measured contact is a force that pushes outward by more: 0.05N");
  command.add_option("--threshold", flags.thresholds,
                     "Episodes are errors over it: 0.5mm for position, 0.2N for force; may be given twice");
  command.add_flag("--flip-force", flags.flip_force, "The file has the force BY the probe: negate it");
  command.add_flag("--closed", flags.closed, "The object is a closed body: refuse a mesh with holes");
  command.add_flag("--repair", flags.repair,
                   "Join open edges that lie within a thousandth of the mesh's size, and turn triangles that face the "
                   "other way than most of their piece, and closed pieces that are inside out, before anything else; "
                   "the report says how many");
  command.add_option("--extend-edges", flags.extend_edges,
                     "The mesh is a patch of a larger object: continue its open edges by this much (10mm), fill its "
                     "holes; 0 leaves it "
                     "as it is; not given: done where the recording touches beyond the mesh, and said");
  command.add_option("--on-duplicate", flags.on_duplicate, "Repeated times: refuse, first, mean")
      ->capture_default_str();
  command.add_option("--on-gap", flags.on_gap, "Gaps in time: refuse, split (the renderer starts anew), keep")
      ->capture_default_str();
  flags.plugins.add_to(command);
}

void say_usual_in_trajectory(InTrajectoryMode mode) {
  const bool whole = mode == InTrajectoryMode::whole_force;
  fmt::print(stderr, "in-trajectory: {} ({}; --in-trajectory chooses)\n", in_trajectory_name(mode),
             whole ? "a renderer has friction in its proxy" : "equation 2, from the normal force");
}

pipeline::EvaluationRequest make_request(const EvaluationFlags& flags) {
  pipeline::EvaluationRequest request;
  request.recording = flags.recording;
  request.repeat = flags.repeat;
  request.mesh = flags.mesh;
  request.mesh_unit = flags.mesh_unit;
  static_cast<void>(length_unit_factor(flags.mesh_unit));
  request.in_trajectory = recording::find_in_trajectory(flags.in_trajectory).value_or(InTrajectoryMode::synthesize);
  if (!flags.tip_radius.empty()) {
    request.tip_radius_m = parse_length_m(flags.tip_radius, "--tip-radius");
    if (!(*request.tip_radius_m >= 0.0))
      throw UsageError(fmt::format("--tip-radius: {} is negative", flags.tip_radius));
  }
  if (flags.stiffness_N_per_m != 0.0) request.stiffness_N_per_m = flags.stiffness_N_per_m;
  if (!flags.contact_threshold.empty())
    request.contact_threshold_N = pipeline::parse_force_N(flags.contact_threshold, "--contact-threshold");
  for (const std::string& threshold : flags.thresholds) apply_threshold(threshold, request);
  request.flip_force = flags.flip_force;
  request.closed = flags.closed;
  request.repair = flags.repair;
  if (!flags.extend_edges.empty()) {
    request.extend_edges_m = flags.extend_edges == "0" ? 0.0 : parse_length_m(flags.extend_edges, "--extend-edges");
  }
  request.clock.on_duplicate = recording::parse_on_duplicate(flags.on_duplicate);
  request.clock.on_gap = recording::parse_on_gap(flags.on_gap);
  request.command_line = command_line();
  // The program by its name: where it was installed says nothing about the result.
  if (!request.command_line.empty()) request.command_line.front() = "touchstone";
  return request;
}

}  // namespace touchstone::apps
