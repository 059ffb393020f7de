// A golden in a few numbers that read well in a diff: golden/<case>/expected.summary.json.
#pragma once

#include <map>
#include <string>

#include "harness/recording/trajectory.h"

namespace touchstone {

struct GoldenSummary {
  std::size_t samples = 0;
  std::size_t contact_samples = 0;
  std::size_t contact_events = 0;
  double peak_force_N = 0.0;
  double rms_force_N = 0.0;
  Vec3 mean_force_W_N = Vec3::Zero();
  double contact_path_m = 0.0;  // length of the surface contact point's path
  std::string sha256;           // of every number, to the bit
};

GoldenSummary summarise(const RenderedTrajectory& rendered);
// The file's text: models by name, nine digits, one number to a line.
std::string summaries_to_json(const std::string& case_name, const std::map<std::string, GoldenSummary>& models);

}  // namespace touchstone
