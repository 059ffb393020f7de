// A golden case of a closed gap: mesh, the held-out recording's positions and the model found, so that what the model
// renders there cannot change unnoticed.
#pragma once

#include <filesystem>

#include "harness/pipeline/discrepancy/inputs.h"

namespace touchstone::pipeline {

// Writes FOLDER/{case.json, mesh.ply, in.h5}; the folder's name is the case's. What is expected is taken by
// `touchstone check` and `touchstone golden accept`, as for every case. Throws UsageError for a folder that exists.
void write_golden_case(const std::filesystem::path& folder, const surface::TriangleMesh& mesh,
                       const recording::Recording& recording, const rendering::Model& found);

// The commands that make it golden.
std::string golden_commands(const std::filesystem::path& folder);

}  // namespace touchstone::pipeline
