#include "harness/base/repository_state.h"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <sstream>

namespace touchstone {
namespace {

// The standard output of git with these words; nothing where it fails.
std::optional<std::string> ask_git(const std::filesystem::path& folder, std::vector<std::string> words) {
  words.insert(words.begin(), {"git", "-C", folder.string()});
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  std::array<int, 2> ends{};
  if (::pipe2(ends.data(), O_CLOEXEC) != 0) return std::nullopt;
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, ends[1], 1);
  posix_spawn_file_actions_addopen(&actions, 2, "/dev/null", O_WRONLY, 0);
  pid_t child = 0;
  const bool started = posix_spawnp(&child, "git", &actions, nullptr, arguments.data(), environ) == 0;
  posix_spawn_file_actions_destroy(&actions);
  ::close(ends[1]);
  std::string text;
  std::array<char, 4096> block{};
  for (ssize_t n = 0; started && (n = ::read(ends[0], block.data(), block.size())) > 0;)
    text.append(block.data(), static_cast<std::size_t>(n));
  ::close(ends[0]);
  int status = 1;
  if (started) ::waitpid(child, &status, 0);
  return status == 0 ? std::optional(text) : std::nullopt;
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
