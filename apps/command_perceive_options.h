// What both methods of `perceive` share: options, the object that models render, and their recordings.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "apps/apps_rooms.h"
#include "apps/command.h"
#include "apps/plugin_flags.h"
#include "harness/perception/features/rate_hardness.h"
#include "harness/perception/filters/output_band.h"
#include "harness/recording/trajectory.h"
#include "harness/rendering/model.h"
#include "harness/report/provenance.h"
#include "harness/surface/surface.h"

namespace touchstone::apps {

struct PerceiveOptions {
  std::string real, mesh, mesh_unit = "m", direction = "force", answers, out, scaling = "reference-norm";
  std::string method = "judge", thresholds, instrument;
  std::vector<std::string> repeats, conditions, models, without;
  PluginFlags plugins;
  std::optional<double> explained_share;
  double rate_Hz = 0.0;
  double dead_zone_N = 0.0;
  double band_Hz = perception::kFingerBandHigh_Hz;
  double duration_tolerance = 0.2;
  std::string extend_edges;
  std::size_t window = perception::kRateHardnessWindow;
  bool hardness_in_band = false;
  bool depth_known = false;
  bool flip_force = false;  // every recording that is read has the force BY the probe
};

std::pair<std::string, std::string> name_and_file(const std::string& text, const char* option);
// The outward direction of pressing.
Vec3 press_direction_of(const std::string& text, const Recording& real);

// The recording as the options say, its force reversed where they ask for it.
Recording read_recording(const PerceiveOptions& options, const std::string& file);

// Refuses (BadData) a real process that is not sane, against the object where one is given; what is worth knowing goes
// into `notes`.
void check_real(const PerceiveOptions& options, const Recording& real, const Surface* surface,
                std::vector<std::string>& notes);
// Refuses (BadData) a condition whose file has a fault of its own, or that shows the real process with one.
void check_condition(const Recording& real, const Recording& condition);

// The object of --mesh, its open edges continued where the real process presses beyond them, as `evaluate` does it;
// `notes` then says so.
std::shared_ptr<const Surface> rendered_object(const PerceiveOptions& options, const Recording& real,
                                               std::vector<std::string>& notes);
// What the model renders along the real process's own path.
Recording rendered_by(const Model& model, const std::shared_ptr<const Surface>& surface, const Recording& real);

// The files in their order, hashed.
std::vector<InputFile> described(const std::vector<std::pair<std::string, std::string>>& role_and_file);

// Shao, Wu and Ouyang, as published.
ExitStatus perceive_by_paper(const PerceiveOptions& options);

}  // namespace touchstone::apps
