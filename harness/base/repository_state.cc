#include "harness/base/repository_state.h"

#include <algorithm>
#include <sstream>

#include "harness/base/other_program.h"

namespace touchstone {
namespace {

// The standard output of git with these words; nothing where it fails.
std::optional<std::string> ask_git(const std::filesystem::path& folder, std::vector<std::string> words) {
  words.insert(words.begin(), {"git", "-C", folder.string()});
  const auto end = run_other({std::move(words), Printed::kept, Printed::dropped});
  return end && end->status == 0 ? std::optional(end->out) : std::nullopt;
}

}  // namespace

std::optional<RepositoryState> repository_state(const std::filesystem::path& folder) {
  const auto status = ask_git(folder, {"status", "--porcelain", "--untracked-files=normal"});
  if (!status) return std::nullopt;
  RepositoryState state;
  if (auto commit = ask_git(folder, {"rev-parse", "--verify", "--quiet", "HEAD"})) {
    state.commit = std::move(*commit);
    while (!state.commit.empty() && state.commit.back() == '\n') state.commit.pop_back();
  }
  std::istringstream lines(*status);
  for (std::string line; std::getline(lines, line);) {
    constexpr std::size_t marks = 3;  // two letters and a space
    state.changes.push_back(line.substr(std::min(marks, line.size())));
  }
  return state;
}

}  // namespace touchstone
