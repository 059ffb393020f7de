// A data set that can be given away (harness/recording/dataset.h): its files checked, their hashes written, all of it
// one archive.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "harness/base/vec.h"
#include "harness/recording/clock.h"
#include "harness/recording/dataset.h"

namespace touchstone::datasets {

// The box around a mesh, in metres; the room of surfaces reads meshes, so the caller passes how.
using MeshBounds = std::function<Box3(const std::filesystem::path& file, const std::string& unit)>;

struct DatasetReport {
  std::vector<std::string> errors;    // any: the data set cannot be relied on
  std::vector<std::string> warnings;  // worth a look
  std::vector<std::string> facts;     // one line per recording
};

// Checks that every file exists, is what its hash says and can be read, and that recordings lie where the mesh is.
DatasetReport check_dataset(const recording::Dataset& dataset, const MeshBounds& mesh_bounds,
                            const recording::ClockPolicy& clock = {});

// Computes the hash of every file and rewrites dataset.json; throws BadData, changing nothing, when a file is missing.
void pack_dataset(recording::Dataset& dataset);

// Writes folder and description as one archive (.tar.gz) that is the same for the same content. Throws BadData for
// another extension.
void archive_dataset(const recording::Dataset& dataset, const std::filesystem::path& out);

}  // namespace touchstone::datasets
