// The result of one evaluation: everything that the console, the JSON file and the HTML page show.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "harness/metrics/episodes.h"
#include "harness/metrics/metric.h"
#include "harness/report/provenance.h"
#include "harness/report/rendered_input.h"

namespace touchstone::report {

// The object as it is drawn, with the mean error around each vertex.
struct ObjectView {
  std::vector<Vec3> vertices_W_m;
  std::vector<std::array<std::int32_t, 3>> triangles;
  std::vector<double> error;  // NaN where nothing touched
  std::string error_name;     // "force error" or, without force, "position error"
  std::string error_unit;
  // Share of the samples around each vertex whose force error a person would notice (more than one just noticeable
  // difference); NaN where nothing touched, empty without force.
  std::vector<double> noticed_share;
  std::string note;  // how the drawn object differs from the mesh file
};

// Some full-rate signals around an episode.
struct EpisodeView {
  metrics::Episode episode;
  std::string of;                        // "force" or "position"
  std::string unit;                      // of the error: N or m
  std::vector<metrics::Series> signals;  // empty beyond the worst few
};

struct EvaluationResult {
  std::string title;                                          // what was evaluated, in a few words
  std::string renderer;                                       // name in the model
  std::string model;                                          // the model file's text, normalised
  RenderedInput input;                                        // what the renderer was given; hash "" where not known
  std::vector<std::pair<std::string, std::string>> settings;  // what was chosen, with units
  std::vector<std::string> messages;                          // what the reader must know: warnings, what was assumed
  std::vector<metrics::MetricResult> metrics;
  std::vector<metrics::Series> signals;  // named measured_x, rendered_x, ... for x, y, z [N]
  double force_threshold_N = 0.0;
  double position_threshold_m = 0.0;
  std::vector<EpisodeView> episodes;  // force, then position; worst first
  ObjectView object;
  std::vector<Vec3> path_W_m;  // the out-trajectory as it is drawn
  Provenance provenance;
};

}  // namespace touchstone::report
