// Makes a golden case of a scene of one's own: a mesh, a path and models become a folder that `touchstone check` runs,
// with tolerances that have a reason: what rounding alone changes on this path, measured, and what a finger could feel.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "harness/golden/case_runner.h"

namespace touchstone::golden {

struct NewCase {
  std::string name;     // of lower-case letters, digits and '-'
  std::string summary;  // one line; empty: made from the files' names
  std::filesystem::path mesh;
  std::string mesh_unit = "m";
  std::filesystem::path trajectory;           // a trajectory or a recording: its positions are the path as they are
  double from_s = 0.0, to_s = 0.0;            // the part of the path; to_s 0: all of it
  std::vector<std::filesystem::path> models;  // named by their files
  std::optional<CaseLoop> loop = {};
};

struct MadeCase {
  GoldenCase golden;
  // What a change of the path by rounding (a few units in the last place of each coordinate) makes of the force, at
  // most.
  double rounding_N = 0.0;
  double largest_N = 0.0;  // the largest force of all models
};

// Writes golden/<name>/ with case.json, the mesh and the path. Throws UsageError if the case is there already or a name
// is none, BadData if an input cannot be read or a model does not run on the path; then nothing is left behind.
MadeCase make_case(const Catalogues& catalogues, const std::filesystem::path& golden, const NewCase& wanted,
                   const ChangeModel& change = {});

// Changes limits of a case's tolerance in its case.json, and the reason that stands with them. `limits` are
// "force.atol_N=2e-5"; an empty value takes the limit out. Returns a line for each, before and after. Throws UsageError
// or BadData, and then the file is as it was.
std::vector<std::string> edit_tolerance(const std::filesystem::path& case_folder,
                                        const std::vector<std::string>& limits, const std::string& reason);

// Where `golden new` puts a case: the folder `own` that holds cases already, upwards to the top of the repository; else
// at its top.
std::filesystem::path own_golden_folder(const std::filesystem::path& own);

}  // namespace touchstone::golden
