// The expected result of one model of a golden case: a rendered file in HDF5 (shuffled, deflated, a checksum on every
// chunk) whose attributes say where it came from.
#pragma once

#include <filesystem>
#include <map>
#include <string>

#include "harness/recording/trajectory.h"

namespace touchstone::golden {

// Name to value: geometry_sha256, trajectory_sha256, seed, version, commit, dirty, compiler, flags, cpu, command,
// reason.
using Provenance = std::map<std::string, std::string>;

// What is known of this build and machine: version, commit, dirty, compiler, flags, cpu. The CPU's model name, for
// drift is only comparable on the class of machine that made the golden.
Provenance build_provenance();

// Atomic; throws BadData.
void write_golden(const std::filesystem::path& path, const recording::RenderedTrajectory& rendered,
                  const Provenance& provenance);
// Copies `from` to `to`, adding or changing attributes on the way; atomic.
void copy_golden(const std::filesystem::path& from, const std::filesystem::path& to, const Provenance& changes);
// The text attributes of the file; throws BadData when it is not HDF5.
Provenance read_provenance(const std::filesystem::path& path);

}  // namespace touchstone::golden
