// The options that commands which evaluate a recording share.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "apps/apps_rooms.h"
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

// Requests made from here on name this as the command that they came from, in place of how the process was called: for
// a process that runs one command after another. An empty one ends it.
void name_command_line(std::vector<std::string> words);

// Everything but the model. Throws UsageError for values that make no sense.
EvaluationRequest make_request(const EvaluationFlags& flags);

// "0.2 N" and "0.5mm" to SI; which of the two is told by the unit. Throws UsageError naming `what`.
double parse_force_N(std::string_view text, std::string_view what);
void apply_threshold(std::string_view text, EvaluationRequest& request);

}  // namespace touchstone::apps
