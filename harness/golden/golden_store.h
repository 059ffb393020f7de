// Finding golden cases; how results become goldens, and goldens files: review of what failed, acceptance by a person's
// decision, and export.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "harness/golden/acceptance.h"
#include "harness/golden/golden_case.h"
#include "harness/rendering/generators.h"

namespace touchstone::golden {

// `own` if a case lies in it; otherwise the cases that come with the program, if there are any. A folder named "golden"
// may be something else's, such as CMake's for the build of the cases.
std::filesystem::path usual_golden_folder(const std::filesystem::path& own);

// The cases of these names in the folder, or those that are folders themselves (with a slash); without names, all.
// Throws UsageError that lists the known ones.
std::vector<GoldenCase> choose_cases(const std::filesystem::path& golden, const std::vector<std::string>& names);

// What failed runs left in `out`, of the cases and the model that are named; without names, of all.
std::vector<PendingResult> chosen_pending(const std::filesystem::path& out, const std::vector<std::string>& cases,
                                          const std::string& model);

// For people: numbers and pictures of each, and how to accept it.
std::string review_text(const std::vector<PendingResult>& pending, const std::string& golden_folder,
                        const std::string& out);

// Makes one result the golden of its case in the folder `golden`, with the reason in it; the folder that the failed run
// left is removed. Says "new", "replaced" or, if only the operations are others, "operations": the trajectory then
// stays as it is, with what is known of its origin. Throws UsageError for a result that must not become one
// (acceptance.h).
std::string accept_result(const PendingResult& pending, const std::filesystem::path& golden,
                          const std::filesystem::path& out, const std::string& reason);

// The case as files that any version of the program can replay, by the interface that stays: mesh.obj, trajectory.csv
// (m, s), MODEL.json and, if there is a golden, MODEL.h5.
void export_case(const rendering::Generators& generators, const GoldenCase& golden,
                 const std::vector<std::string>& models, const std::filesystem::path& to);

}  // namespace touchstone::golden
