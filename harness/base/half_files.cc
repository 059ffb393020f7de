#include "harness/base/half_files.h"

#include <unistd.h>

#include <array>
#include <atomic>
#include <csignal>
#include <cstring>

namespace touchstone {
namespace {

// A signal handler may neither allocate nor lock: a fixed table of paths. One more than it holds stays behind.
constexpr std::size_t most_files = 64;
constexpr std::size_t longest_path = 1024;
enum State : int { unused, taken, registered };

struct Slot {
  std::atomic<int> state = unused;
  std::array<char, longest_path> path{};
};
std::array<Slot, most_files> slots;

extern "C" void remove_and_end(int signal) {
  for (const Slot& slot : slots) {
    if (slot.state == registered) ::unlink(slot.path.data());
  }
  std::signal(signal, SIG_DFL);
  std::raise(signal);
}

}  // namespace

void add_half_file(const std::filesystem::path& path) noexcept {
  static_assert(std::atomic<int>::is_always_lock_free);
  const auto& text = path.native();
  if (text.size() >= longest_path) return;
  for (Slot& slot : slots) {
    int expected = unused;
    if (!slot.state.compare_exchange_strong(expected, taken)) continue;
    std::memcpy(slot.path.data(), text.c_str(), text.size() + 1);
    slot.state = registered;
    return;
  }
}

void drop_half_file(const std::filesystem::path& path) noexcept {
  for (Slot& slot : slots) {
    if (slot.state == registered && path.native() == slot.path.data()) slot.state = unused;
  }
}

void remove_half_files_when_interrupted() {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    // What the caller ignores (nohup) stays ignored.
    if (std::signal(signal, &remove_and_end) == SIG_IGN) std::signal(signal, SIG_IGN);
  }
}

}  // namespace touchstone
