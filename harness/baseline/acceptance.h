// What a failing golden test leaves behind, and the rules under which it may become the new golden.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace touchstone {

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

}  // namespace touchstone
