// The inputs of an evaluation, read and looked at before anything runs: a mistake in them is said at once, with what to
// do about it.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "harness/base/error.h"
#include "harness/pipeline/evaluation/request.h"
#include "harness/recording/recording_stream.h"
#include "harness/recording_checks/repeat_floor.h"
#include "harness/rendering/catalogue.h"
#include "harness/report/provenance.h"
#include "harness/surface/surface.h"

namespace touchstone::pipeline {

// What one pass over the recording tells.
struct RecordingSurvey {
  std::uint64_t samples = 0;
  recording::ClockReport clock;
  Box3 tips_W_m;
  bool has_force = false;
  double usual_force_N = 0.0;  // 99th percentile of the magnitude, within 0.1 %
  std::vector<std::string> notes;
  // Every n-th sample, a few thousand at most.
  std::vector<double> some_times_s;
  std::vector<Vec3> some_tips_W_m;
  std::vector<Vec3> some_forces_W_N;
  std::vector<Quat> some_orientations_WS;  // empty where not recorded
};

// The renderer cannot represent the tip of the recording: it does not enter.
class TipNotRepresentable : public UsageError {
 public:
  using UsageError::UsageError;
};

// Whether the renderer of this model holds its proxy back by friction: it declares a coefficient (mu_static,
// mu_dynamic) of its own, as the friction cone does, and the model's is above 0 or among `fitted`. Friction that an
// effect adds to the force of a frictionless proxy is none.
bool has_friction_in_proxy(const rendering::Catalogue& catalogue, const rendering::Model& model,
                           std::span<const std::string> fitted = {});

// The in-trajectory where the user chose none: the whole force if any of the renderers that are compared has friction
// in its proxy, else equation 2 (in_trajectory.h derives which input is fair to which).
recording::InTrajectoryMode usual_in_trajectory(bool friction_in_proxy);

// Whether a model of the catalogue's or a plug-in's renderer can have a tip of this radius; see TipNotRepresentable.
bool can_have_tip(const rendering::Catalogue& catalogue, const rendering::Model& model, double tip_radius_m);

struct EvaluationInputs {
  surface::TriangleMesh mesh;
  double extended_m = 0.0;     // by which open edges were continued
  std::size_t open_edges = 0;  // 0: inside and outside exist
  std::shared_ptr<const surface::Surface> surface;
  RecordingSurvey survey;
  rendering::Model model;                              // with the tip radius that was asked for
  double tip_radius_m = 0.0;                           // 0 where neither model nor request name one
  double stiffness_N_per_m = 0.0;                      // 0 where the renderer has none and none was given
  std::optional<recording_checks::RepeatFloor> floor;  // where the request names a repeat
  std::vector<report::InputFile> files;                // hashed
  std::vector<std::string> messages;
};

// Opens the recording as the request says. Forces still have the file's sign.
recording::RecordingStream open_recording(const EvaluationRequest& request);

// Throws BadData: unreadable files, a recording that is not sane (harness/recording_checks/check_recording.h: nowhere
// near the mesh, forces reversed or in another frame), a model that cannot run. Throws TipNotRepresentable for a tip
// that the renderer cannot have.
EvaluationInputs load_inputs(const rendering::Catalogue& catalogue, const EvaluationRequest& request);

}  // namespace touchstone::pipeline
