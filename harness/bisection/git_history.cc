#include "harness/bisection/git_history.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <sstream>

#include "harness/base/error.h"

namespace touchstone::bisection {
namespace {

std::vector<std::string> words_of(const std::string& text) {
  std::istringstream in(text);
  std::vector<std::string> words;
  for (std::string word; in >> word;) words.push_back(word);
  return words;
}

}  // namespace

GitHistory::GitHistory(std::filesystem::path repository) : repository_(std::move(repository)) {
  if (ask({"rev-parse", "--git-dir"}).status != 0)
    throw UsageError(fmt::format("--repository {}: is no git repository", repository_.string()));
}

ProgramEnd GitHistory::ask(const std::vector<std::string>& words) const {
  // Without a terminal: it asks for nothing, and an interrupt of the bisection does not reach it half-way.
  OtherProgram program{{"git", "-C", repository_.string()}, Printed::kept, Printed::kept, "/dev/null", true};
  program.words.insert(program.words.end(), words.begin(), words.end());
  auto end = run_other(program);
  if (!end) throw UsageError("git cannot be run; it is needed to bisect");
  ProgramEnd answer = *std::move(end);
  while (answer.out.ends_with('\n')) answer.out.pop_back();
  return answer;
}

std::string GitHistory::git(const std::vector<std::string>& words) const {
  ProgramEnd answer = ask(words);
  if (answer.status != 0)
    throw BadData(fmt::format("git {} failed in {}: {}", fmt::join(words, " "), repository_.string(), answer.err));
  return std::move(answer.out);
}

std::string GitHistory::commit(const std::string& revision, const std::string& option) const {
  ProgramEnd answer = ask({"rev-parse", "--verify", "--quiet", revision + "^{commit}"});
  if (answer.status != 0 || answer.out.empty())
    throw UsageError(fmt::format("{}: {} is no commit in {}", option, revision, repository_.string()));
  return std::move(answer.out);
}

bool GitHistory::is_ancestor(const std::string& old, const std::string& young) const {
  return ask({"merge-base", "--is-ancestor", old, young}).status == 0;
}

std::vector<std::string> GitHistory::line(const std::string& old, const std::string& young) const {
  // Every commit between the two that descends from `old`, with its parents.
  std::map<std::string, std::vector<std::string>> parents;
  std::istringstream lines(git({"rev-list", "--parents", "--ancestry-path", old + ".." + young}));
  for (std::string text; std::getline(lines, text);) {
    const auto words = words_of(text);
    parents[words.front()] = {words.begin() + 1, words.end()};
  }
  std::vector<std::string> line{young};
  while (line.back() != old) {
    const auto found = parents.find(line.back());
    if (found == parents.end()) throw BadData(fmt::format("no line of commits leads from {} to {}", old, young));
    const auto next = std::ranges::find_if(
        found->second, [&](const std::string& parent) { return parent == old || parents.contains(parent); });
    if (next == found->second.end()) throw BadData(fmt::format("no line of commits leads from {} to {}", old, young));
    line.push_back(*next);
  }
  std::ranges::reverse(line);
  return line;
}

std::vector<GitHistory::Branch> GitHistory::merged(const std::string& merge, const std::string& before) const {
  std::vector<Branch> branches;
  for (const std::string& parent : words_of(git({"show", "-s", "--format=%P", merge}))) {
    if (parent == before) continue;
    const ProgramEnd base = ask({"merge-base", before, parent});
    // Histories without a common commit: nothing to compare with.
    if (base.status == 0 && base.out != parent) branches.push_back({base.out, parent});
  }
  return branches;
}

std::string GitHistory::title(const std::string& commit) const {
  return git({"show", "-s", "--format=%s (%as)", commit});
}

}  // namespace touchstone::bisection
