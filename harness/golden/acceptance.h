// What a failing golden test leaves behind, and the rules under which it may become the new golden.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "harness/base/repository_state.h"
#include "harness/golden/golden_file.h"

namespace touchstone::golden {

// A folder <out>/<case>/<model> with obtained.h5, table.txt, comparison.json and, where gnuplot is, pictures.
struct PendingResult {
  std::string case_name;
  std::string model;
  std::filesystem::path folder;
  [[nodiscard]] std::filesystem::path obtained() const { return folder / "obtained.h5"; }
};

// By case, then model. No folder: none.
std::vector<PendingResult> pending_results(const std::filesystem::path& out);

// Why nothing may be accepted now: under CI, outside a git checkout, or with changes to the tree other than to the
// expected results themselves (a golden must say which commit made it). Empty when it may.
std::optional<std::string> acceptance_refused(const std::filesystem::path& golden);
// The first change of the state that is not to expected results of golden cases.
std::optional<std::string> first_change_of_source(const RepositoryState& state);

// Why the result of a run with this provenance may not become a golden: another renderer stood in for the case's own,
// or it is a plug-in's whose repository was not clean when it ran, or that is not the same file any more.
std::optional<std::string> run_refused(const Provenance& run);

// out/case/model, where a failed run leaves its files. Throws BadData where a part of it below `out` is a symbolic
// link: what it points to is somebody else's.
std::filesystem::path result_folder(const std::filesystem::path& out, const std::string& case_name,
                                    const std::string& model);
// Removes the folder and what is in it. Throws BadData where that fails.
void clear_result_folder(const std::filesystem::path& folder);

}  // namespace touchstone::golden
