#include "harness/base/progress.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cstdio>

namespace touchstone {

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
  if (!terminal_) return;
  const auto now = std::chrono::steady_clock::now();
  if (now - drawn_ < std::chrono::milliseconds(100)) return;
  drawn_ = now;
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
