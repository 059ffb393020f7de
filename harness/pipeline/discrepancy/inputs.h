// What a search for missing effects works on, read from files.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "harness/pipeline/discrepancy/request.h"
#include "harness/recording/trajectory.h"
#include "harness/rendering/catalogue.h"
#include "harness/rendering/model.h"
#include "harness/rendering/predictor.h"
#include "harness/surface/surface.h"

namespace touchstone::pipeline {

struct DiscrepancyInputs {
  rendering::Model model;
  surface::TriangleMesh mesh;
  std::shared_ptr<const surface::Surface> surface;
  recording::Recording train;
  std::optional<recording::Recording> holdout;
  std::vector<std::string> remarks;  // on mesh and recordings: what was repaired, what is wrong
};

// Throws BadData naming the file: also for a recording that is not sane (harness/recording_checks/check_recording.h).
DiscrepancyInputs load_inputs(const rendering::Catalogue& catalogue, const DiscrepancyFiles& files);

// Every contact effect and instrument entry of the catalogue, and the effects that these files declare. Throws BadData
// for a file that is wrong or has a name twice.
std::vector<rendering::Candidate> all_candidates(const rendering::Catalogue& catalogue,
                                                 const std::vector<std::filesystem::path>& effects = {});

}  // namespace touchstone::pipeline
