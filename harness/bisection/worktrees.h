// Checkouts of a repository to build commits in, several at a time, gone afterwards. Each keeps its build folder from
// commit to commit, so that only what changed is compiled.
#pragma once

#include <atomic>
#include <condition_variable>
#include <filesystem>
#include <mutex>
#include <string>
#include <vector>

#include "harness/bisection/git_history.h"

namespace touchstone::bisection {

class Worktrees {
 public:
  Worktrees(const GitHistory& history, const std::filesystem::path& folder, std::size_t count);
  ~Worktrees();
  Worktrees(const Worktrees&) = delete;
  Worktrees& operator=(const Worktrees&) = delete;

  // One that nobody else uses, with the commit checked out; free again when this ends.
  class Checkout {
   public:
    Checkout(Worktrees& trees, const std::string& commit);
    ~Checkout();
    Checkout(const Checkout&) = delete;
    Checkout& operator=(const Checkout&) = delete;
    [[nodiscard]] std::filesystem::path source() const { return place_ / "source"; }
    [[nodiscard]] std::filesystem::path build() const { return place_ / "build"; }

   private:
    Worktrees* trees_;
    std::size_t index_;
    std::filesystem::path place_;
  };

 private:
  const GitHistory* history_;
  std::vector<std::filesystem::path> places_;
  std::vector<bool> used_;
  std::mutex mutex_;
  std::condition_variable freed_;
};

}  // namespace touchstone::bisection
