// The recordings of a PerceiveRequest: read and checked, and rendered by models along the real process's path.
#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "harness/pipeline/perceiving/request.h"
#include "harness/recording/trajectory.h"
#include "harness/rendering/catalogue.h"
#include "harness/report/provenance.h"
#include "harness/surface/surface.h"

namespace touchstone::pipeline {

// The outward direction of pressing, of length 1. Throws UsageError for a text that names none, BadData if the real
// process has none.
Vec3 press_direction_of(const std::string& text, const recording::Recording& real);

// The recording as the request says, its force reversed if it asks for it. Throws BadData as load_recording() does.
recording::Recording read_recording(const PerceiveRequest& request, const std::string& file);

// Refuses (BadData) a real process that is not sane, against the object if one is given; what is worth knowing goes
// into `notes`.
void check_real(const PerceiveRequest& request, const recording::Recording& real, const surface::Surface* surface,
                std::vector<std::string>& notes);
// Refuses (BadData) a condition whose file has a fault of its own, or that shows the real process with one.
void check_condition(const recording::Recording& real, const recording::Recording& condition);

// The object of the request's mesh, its open edges continued if the real process presses beyond them, as `evaluate`
// does it; `notes` then says so. Throws BadData as load_mesh() does.
std::shared_ptr<const surface::Surface> rendered_object(const PerceiveRequest& request,
                                                        const recording::Recording& real,
                                                        std::vector<std::string>& notes);
// What models are fed where the user chose nothing: the path as measured, but of an object that is rigid to a hand
// (in_trajectory.h) the path made of the force, as `evaluate` makes it, and then `notes` says so.
recording::InTrajectoryMode models_path_of(const rendering::Catalogue& catalogue, const PerceiveRequest& request,
                                           const recording::Recording& real, const surface::Surface& surface,
                                           std::vector<std::string>& notes);
// What the model renders along the real process's own path, by `mode` (in_trajectory.h); where its forces are to be
// judged, `along` is that path without the tracker's noise (perception::replay_path).
recording::Recording rendered_by(const rendering::Catalogue& catalogue, const rendering::Model& model,
                                 const std::shared_ptr<const surface::Surface>& surface,
                                 const recording::Recording& real, const MotionColumns& along,
                                 recording::InTrajectoryMode mode);

using RolesAndFiles = std::vector<std::pair<std::string, std::string>>;
// The files in their order, hashed.
std::vector<report::InputFile> described(const RolesAndFiles& role_and_file);

}  // namespace touchstone::pipeline
