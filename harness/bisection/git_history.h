// What a search needs to know of a git repository. Nothing in it is changed; its checkout stays as it is.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "harness/base/other_program.h"

namespace touchstone::bisection {

class GitHistory {
 public:
  // Throws UsageError when there is no repository.
  explicit GitHistory(std::filesystem::path repository);

  // The full name of a commit; throws UsageError naming `option` when there is none.
  [[nodiscard]] std::string commit(const std::string& revision, const std::string& option) const;
  [[nodiscard]] bool is_ancestor(const std::string& old, const std::string& young) const;
  // From `old` to `young`, each the parent of the next: the first parent where that descends from `old`. What merges
  // brought in is not on the line; see merged().
  [[nodiscard]] std::vector<std::string> line(const std::string& old, const std::string& young) const;
  // The branches that a merge brought to `before`, one of its parents: from where each left it to its last commit.
  struct Branch {
    std::string from, to;
  };
  [[nodiscard]] std::vector<Branch> merged(const std::string& merge, const std::string& before) const;
  // "subject (date)".
  [[nodiscard]] std::string title(const std::string& commit) const;

  // The output of git, without the last line's end; throws BadData with what git said when it fails.
  [[nodiscard]] std::string git(const std::vector<std::string>& words) const;
  [[nodiscard]] const std::filesystem::path& repository() const noexcept { return repository_; }

 private:
  [[nodiscard]] ProgramEnd ask(const std::vector<std::string>& words) const;
  std::filesystem::path repository_;
};

}  // namespace touchstone::bisection
