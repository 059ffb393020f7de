#include "harness/base/progress.h"

#include <fmt/format.h>
#include <unistd.h>

#include <atomic>
#include <cstdio>
#include <mutex>
#include <utility>

namespace touchstone {
namespace {

static_assert(std::atomic<bool>::is_always_lock_free);  // set by signal handlers
std::atomic<bool> stop_asked = false;

struct Watch {
  std::atomic<bool> on = false;
  std::mutex mutex;
  ProgressWatcher watcher;
};

Watch& watch() {
  static Watch one;
  return one;
}

}  // namespace

void ask_to_stop() noexcept { stop_asked = true; }
void allow_work() noexcept { stop_asked = false; }
bool asked_to_stop() noexcept { return stop_asked.load(std::memory_order_relaxed); }

void watch_progress(ProgressWatcher watcher) {
  Watch& one = watch();
  const std::lock_guard lock(one.mutex);
  one.watcher = std::move(watcher);
  one.on = static_cast<bool>(one.watcher);
}

Progress::Progress(std::string what, std::uint64_t total)
    : what_(std::move(what)),
      total_(total),
      start_(std::chrono::steady_clock::now()),
      drawn_(start_),
      terminal_(::isatty(STDERR_FILENO) == 1) {}

Progress::~Progress() {
  if (terminal_ && drawn_ != start_) fmt::print(stderr, "\r\x1b[K");
}

void Progress::update(std::uint64_t done) {
  stop_if_asked();
  Watch& watched = watch();
  if (!terminal_ && !watched.on) return;
  const auto now = std::chrono::steady_clock::now();
  if (now - drawn_ < std::chrono::milliseconds(100)) return;
  drawn_ = now;
  if (watched.on) {
    const std::lock_guard lock(watched.mutex);
    if (watched.watcher) watched.watcher(what_, done, total_);
  }
  if (!terminal_) return;
  const double elapsed_s = std::chrono::duration<double>(now - start_).count();
  const double rate = static_cast<double>(done) / elapsed_s;
  if (total_ > 0 && rate > 0.0) {
    const double left_s = static_cast<double>(total_ - done) / rate;
    fmt::print(stderr, "\r\x1b[K{}: {}/{} ({:.0f} %), {:.3g}/s, {:.0f} s left", what_, done, total_,
               100.0 * static_cast<double>(done) / static_cast<double>(total_), rate, left_s);
  } else {
    fmt::print(stderr, "\r\x1b[K{}: {}, {:.3g}/s", what_, done, rate);
  }
  std::fflush(stderr);
}

}  // namespace touchstone
