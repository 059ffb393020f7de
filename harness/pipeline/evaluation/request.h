// What to evaluate: one recording, one object, one model, and how to treat them.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "harness/metrics/time_ranges.h"
#include "harness/recording/clock.h"
#include "harness/recording/dataset.h"
#include "harness/rendering/model.h"

namespace touchstone::pipeline {

struct EvaluationRequest {
  std::string title;  // "" : made from the names
  std::filesystem::path recording;
  std::filesystem::path mesh;
  std::string mesh_unit = "m";
  rendering::Model model;
  std::filesystem::path model_file;  // "" where the model did not come from a file
  recording::InTrajectoryMode in_trajectory = recording::InTrajectoryMode::synthesize;
  std::optional<double> tip_radius_m;       // the model's tip_radius_m where it is not given
  std::optional<double> stiffness_N_per_m;  // for the in-trajectory; the model's where it is not given
  double contact_threshold_N = 0.05;        // see out_trajectory.h, rule 1; also the metrics' force floor
  std::optional<double> force_threshold_N;  // episodes; a tenth of the largest usual force where it is not given
  double position_threshold_m = 0.5e-3;     // episodes; the accuracy of the tracker of the 2006 paper
  // The probe was a ball, and every renderer gets the point where it touched, as a point tip (--tip-radius 0).
  double probe_radius_m = 0.0;  // of the ball; 0: the tip is what it is
  bool flip_force = false;
  std::filesystem::path repeat;  // the same motion recorded again; empty: none
  bool closed = false;           // refuse a mesh with open edges
  bool repair = false;           // turn triangles that are inside out (harness/surface/mesh_repair.h)
  // Continue the mesh's open edges by this much (harness/surface/extend_edges.h); 0: not. Where it is not given, they
  // are continued if the recording touches the object where the mesh has ended, and the report says so.
  std::optional<double> extend_edges_m;
  recording::ClockPolicy clock;
  metrics::TimeRanges time_ranges;   // what the metrics see; the renderer sees all
  std::vector<std::string> metrics;  // empty: all
  std::vector<std::string> command_line;
};

// "0.2 N" to newtons. Throws UsageError naming `what` for anything but a number >= 0 with a unit of force.
double parse_force_N(std::string_view text, std::string_view what);
// "0.2 N" or "0.5mm": the threshold of force or of position, as its unit says. Throws UsageError.
void apply_threshold(std::string_view text, EvaluationRequest& request);

}  // namespace touchstone::pipeline
