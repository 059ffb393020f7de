// Progress of long work: one line on stderr, redrawn, and only where stderr is a terminal. A program that is no
// terminal's (a notebook) may watch it instead, and ask it to stop.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <string>

namespace touchstone {

// Long work ends with this when it was asked to stop. No std::exception, so that nobody who collects the failures of
// single cases takes it for one of them.
struct Stopped {};

// Asks all long work of this process to stop, until allow_work(). For signal handlers too.
void ask_to_stop() noexcept;
void allow_work() noexcept;
[[nodiscard]] bool asked_to_stop() noexcept;
// Long work calls it between its parts. Throws Stopped.
inline void stop_if_asked() {
  if (asked_to_stop()) throw Stopped{};
}

// What sees progress besides the terminal: what is being done, how much of it is done, and the whole (0: unknown). It
// is called on the thread that does the work, one at a time, at most ten times a second for each piece of work. An
// empty one ends it.
using ProgressWatcher = std::function<void(const std::string& what, std::uint64_t done, std::uint64_t total)>;
void watch_progress(ProgressWatcher watcher);

class Progress {
 public:
  // `total` 0: unknown, then only the count and rate show.
  Progress(std::string what, std::uint64_t total);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  // Cheap: redraws at most ten times a second. Throws Stopped where that was asked for.
  void update(std::uint64_t done);

 private:
  std::string what_;
  std::uint64_t total_;
  std::chrono::steady_clock::time_point start_;
  std::chrono::steady_clock::time_point drawn_;
  bool terminal_;
};

}  // namespace touchstone
