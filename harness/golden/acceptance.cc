#include "harness/golden/acceptance.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>

#include "harness/base/error.h"
#include "harness/base/hash.h"
#include "harness/base/repository_state.h"

namespace touchstone::golden {
namespace {

namespace fs = std::filesystem;

bool expected_result(const std::string& line) {
  const bool summary = line.ends_with("/expected.summary.json");
  return line.find("golden/") != std::string::npos && (summary || line.find("/expected/") != std::string::npos);
}

}  // namespace

std::vector<PendingResult> pending_results(const fs::path& out) {
  std::vector<PendingResult> pending;
  std::error_code error;
  for (const auto& folder : fs::directory_iterator(out, error)) {
    if (!folder.is_directory()) continue;
    for (const auto& model : fs::directory_iterator(folder.path(), error)) {
      if (fs::exists(model.path() / "obtained.h5")) {
        pending.push_back({folder.path().filename().string(), model.path().filename().string(), model.path()});
      }
    }
  }
  std::ranges::sort(pending, {}, [](const auto& p) { return std::pair(p.case_name, p.model); });
  return pending;
}

std::optional<std::string> acceptance_refused(const fs::path& golden) {
  const char* const ci = std::getenv("CI");
  if (ci != nullptr && *ci != '\0' && std::string_view(ci) != "false" && std::string_view(ci) != "0") {
    return "this runs under CI (the environment variable CI is set); goldens are accepted by a person";
  }
  const auto state = repository_state(golden);
  if (!state)
    return fmt::format("{} is not in a git checkout, so that no commit could be named as the golden's origin",
                       golden.string());
  if (const auto change = first_change_of_source(*state)) {
    return fmt::format(
        "the tree has changes that are not committed ({}); commit them first, so that the golden can say what made it",
        *change);
  }
  return std::nullopt;
}

std::optional<std::string> first_change_of_source(const RepositoryState& state) {
  const auto found = std::ranges::find_if_not(state.changes, expected_result);
  return found == state.changes.end() ? std::nullopt : std::optional(*found);
}

std::optional<std::string> run_refused(const Provenance& run) {
  const auto value = [&](const char* name) {
    const auto found = run.find(name);
    return found == run.end() ? std::string() : found->second;
  };
  if (const std::string other = value("renderer_in_place"); !other.empty()) {
    return fmt::format(
        "it was rendered by {}, which --renderer put in the place of the case's own; a golden is made by the renderer "
        "that the case names",
        other);
  }
  const std::string library = value("plugin_library");
  if (library.empty()) return std::nullopt;
  if (const std::string state = value("plugin_state"); state != "clean") {
    return fmt::format(
        "when it was rendered, the repository of the plug-in {} was not clean: {}; commit, build the plug-in, and run "
        "touchstone check again",
        library, state.empty() ? "nothing is known of it" : state);
  }
  if (!fs::exists(library)) {
    return fmt::format("the plug-in {} that rendered it is no longer there; build it and run touchstone check again",
                       library);
  }
  if (const std::string now = sha256_file(library); now != value("plugin_sha256")) {
    return fmt::format(
        "the plug-in {} is not the one that rendered it (SHA-256 {:.12} then, {:.12} now); run touchstone check again",
        library, value("plugin_sha256"), now);
  }
  return std::nullopt;
}

fs::path result_folder(const fs::path& out, const std::string& case_name, const std::string& model) {
  const fs::path folder = out / case_name / model;
  for (const fs::path& part : {out / case_name, folder}) {
    if (!fs::is_symlink(fs::symlink_status(part))) continue;
    throw BadData(
        fmt::format("{}: is a symbolic link; results are removed here before a new run, and nothing is removed through "
                    "a link. Remove the link, or give another --out",
                    part.string()));
  }
  return folder;
}

void clear_result_folder(const fs::path& folder) {
  std::error_code error;
  // Once more where another run removed from it or wrote into it at the same time.
  for (int attempt = 0; attempt < 3; ++attempt) {
    fs::remove_all(folder, error);
    if (!error) return;
  }
  throw BadData(fmt::format("{}: cannot be removed: {}; is another run writing here? Give each its own --out",
                            folder.string(), error.message()));
}

}  // namespace touchstone::golden
