#include "harness/bisection/worktrees.h"

#include <fmt/format.h>

#include <algorithm>

#include "harness/base/error.h"

namespace touchstone::bisection {

Worktrees::Worktrees(const GitHistory& history, const std::filesystem::path& folder, std::size_t count)
    : history_(&history), used_(count, false) {
  for (std::size_t i = 0; i < count; ++i) {
    places_.push_back(folder / fmt::format("{}", i));
    // What a run that was killed left.
    std::filesystem::remove_all(places_.back() / "source");
    std::filesystem::create_directories(places_.back() / "build");
  }
  static_cast<void>(history.git({"worktree", "prune"}));
}

Worktrees::~Worktrees() {
  for (const auto& place : places_) {
    try {
      if (std::filesystem::exists(place / "source"))
        static_cast<void>(history_->git({"worktree", "remove", "--force", (place / "source").string()}));
    } catch (const Error&) {
      std::error_code ignored;
      std::filesystem::remove_all(place / "source", ignored);
    }
    std::error_code ignored;
    std::filesystem::remove_all(place, ignored);
  }
  try {
    static_cast<void>(history_->git({"worktree", "prune"}));
  } catch (const Error&) {
  }
}

Worktrees::Checkout::Checkout(Worktrees& trees, const std::string& commit) : trees_(&trees), index_(0) {
  std::unique_lock lock(trees.mutex_);
  trees.freed_.wait(lock, [&] { return std::ranges::find(trees.used_, false) != trees.used_.end(); });
  index_ = static_cast<std::size_t>(std::ranges::find(trees.used_, false) - trees.used_.begin());
  trees.used_[index_] = true;
  place_ = trees.places_[index_];
  try {
    // Within the lock: git's own locks would make two of these fail.
    if (std::filesystem::exists(source())) {
      const GitHistory tree(source());
      static_cast<void>(tree.git({"checkout", "--quiet", "--force", "--detach", commit}));
      static_cast<void>(tree.git({"clean", "-ffdq"}));
    } else {
      static_cast<void>(
          trees.history_->git({"worktree", "add", "--quiet", "--force", "--detach", source().string(), commit}));
    }
    if (std::filesystem::exists(source() / ".gitmodules"))
      static_cast<void>(GitHistory(source()).git({"submodule", "--quiet", "update", "--init", "--recursive"}));
  } catch (...) {
    trees.used_[index_] = false;
    throw;
  }
}

Worktrees::Checkout::~Checkout() {
  {
    const std::lock_guard lock(trees_->mutex_);
    trees_->used_[index_] = false;
  }
  trees_->freed_.notify_one();
}

}  // namespace touchstone::bisection
