// Things that are expensive to make and shared by many cases: each is made once, by whichever thread needs it
// first, and kept while it is in use or among the last used within a budget.
#pragma once

#include <cstdint>
#include <functional>
#include <future>
#include <map>
#include <memory>
#include <mutex>
#include <string>

namespace touchstone::runs {

template <typename Thing>
class SharedCache {
 public:
  // `weigh` says how much of `budget` a thing takes.
  SharedCache(std::uint64_t budget, std::function<std::uint64_t(const Thing&)> weigh)
      : budget_(budget), weigh_(std::move(weigh)) {}

  // The thing of that name; `make` runs once for it, and what it throws is thrown to all who wait. Other threads that
  // want it wait.
  std::shared_ptr<Thing> get(const std::string& key, const std::function<std::shared_ptr<Thing>()>& make) {
    std::promise<std::shared_ptr<Thing>> promise;
    std::shared_future<std::shared_ptr<Thing>> future;
    bool mine = false;
    {
      const std::lock_guard lock(mutex_);
      const auto [entry, added] = entries_.try_emplace(key);
      if (added) {
        entry->second.future = promise.get_future().share();
        ++made_;
        mine = true;
      }
      entry->second.last_used = ++clock_;
      future = entry->second.future;
    }
    if (mine) fill(key, make, promise);
    return future.get();
  }

  [[nodiscard]] std::uint64_t made() const {
    const std::lock_guard lock(mutex_);
    return made_;
  }

 private:
  struct Entry {
    std::shared_future<std::shared_ptr<Thing>> future;
    std::uint64_t last_used = 0;
    std::uint64_t weight = 0;
  };

  void fill(const std::string& key, const std::function<std::shared_ptr<Thing>()>& make,
            std::promise<std::shared_ptr<Thing>>& promise) {
    try {
      auto thing = make();
      const std::uint64_t weight = weigh_(*thing);
      promise.set_value(std::move(thing));
      const std::lock_guard lock(mutex_);
      entries_.at(key).weight = weight;
      held_ += weight;
      while (held_ > budget_ && entries_.size() > 1 && drop_oldest(key)) {
      }
    } catch (...) {
      promise.set_exception(std::current_exception());
    }
  }

  // Who still uses it keeps it alive. False when all others are still being made.
  bool drop_oldest(const std::string& except) {
    auto oldest = entries_.end();
    for (auto at = entries_.begin(); at != entries_.end(); ++at) {
      const bool candidate = at->second.weight > 0 && at->first != except;
      if (candidate && (oldest == entries_.end() || at->second.last_used < oldest->second.last_used)) oldest = at;
    }
    if (oldest == entries_.end()) return false;
    held_ -= oldest->second.weight;
    entries_.erase(oldest);
    return true;
  }

  mutable std::mutex mutex_;
  std::uint64_t budget_;
  std::function<std::uint64_t(const Thing&)> weigh_;
  std::map<std::string, Entry> entries_;
  std::uint64_t clock_ = 0;
  std::uint64_t held_ = 0;
  std::uint64_t made_ = 0;
};

}  // namespace touchstone::runs
