// The options that commands which evaluate a recording share, and the request that they make of them.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "apps/plugin_flags.h"
#include "harness/pipeline/evaluation/request.h"

namespace touchstone::apps {

struct EvaluationFlags {
  std::string recording, repeat, mesh, model, mesh_unit = "m", in_trajectory, tip_radius, extend_edges,
                                              contact_threshold, on_duplicate = "refuse", on_gap = "keep";
  std::vector<std::string> thresholds;
  double stiffness_N_per_m = 0.0;
  bool flip_force = false, closed = false, repair = false;
  PluginFlags plugins;
};

// Adds --recording, --repeat, --mesh, --mesh-unit, --in-trajectory, --tip-radius, --stiffness, --contact-threshold,
// --threshold,
// --flip-force, --on-duplicate, --on-gap, --plugin.
void add_evaluation_flags(CLI::App& command, EvaluationFlags& flags);

// Says on stderr which in-trajectory was taken, since none was chosen, and why.
void say_usual_in_trajectory(recording::InTrajectoryMode mode);

// Everything but the model. Throws UsageError for values that make no sense.
pipeline::EvaluationRequest make_request(const EvaluationFlags& flags);

}  // namespace touchstone::apps
