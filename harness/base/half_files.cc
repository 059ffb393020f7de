#include "harness/base/half_files.h"

#include <unistd.h>

#include <array>
#include <atomic>
#include <csignal>
#include <cstring>
#include <vector>

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
using Slots = std::array<Slot, most_files>;
Slots files, folders;

void add(Slots& slots, const std::filesystem::path& path) noexcept {
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

extern "C" void remove_and_end(int signal) {
  for (const Slot& slot : files) {
    if (slot.state == registered) ::unlink(slot.path.data());
  }
  // The deepest were added last; rmdir() leaves what is not empty.
  for (auto slot = folders.rbegin(); slot != folders.rend(); ++slot) {
    if (slot->state == registered) ::rmdir(slot->path.data());
  }
  std::signal(signal, SIG_DFL);
  std::raise(signal);
}

}  // namespace

void add_half_file(const std::filesystem::path& path) noexcept { add(files, path); }

void drop_half_file(const std::filesystem::path& path) noexcept {
  for (Slot& slot : files) {
    if (slot.state == registered && path.native() == slot.path.data()) slot.state = unused;
  }
}

std::error_code make_folders(const std::filesystem::path& folder) {
  namespace fs = std::filesystem;
  std::error_code error;
  std::vector<fs::path> missing;
  for (fs::path at = folder; !at.empty() && !fs::exists(at, error); at = at.parent_path()) {
    if (at.has_filename()) missing.push_back(at);
  }
  fs::create_directories(folder, error);
  if (error) return error;
  if (!fs::is_directory(folder, error)) return std::make_error_code(std::errc::not_a_directory);
  for (auto made = missing.rbegin(); made != missing.rend(); ++made) add(folders, fs::absolute(*made));
  return {};
}

void remove_empty_made_folders(bool keep) noexcept {
  namespace fs = std::filesystem;
  for (auto slot = folders.rbegin(); slot != folders.rend(); ++slot) {
    if (slot->state != registered) continue;
    const fs::path folder = slot->path.data();
    std::error_code error;
    fs::directory_iterator entry(folder, error);
    if (!keep && !error && entry != fs::directory_iterator() && entry->path().filename() == ".gitignore" &&
        ++entry == fs::directory_iterator())
      ::unlink((folder / ".gitignore").c_str());
    if (!keep) ::rmdir(folder.c_str());
    slot->state = unused;
  }
}

void remove_half_files_when_interrupted() {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    // What the caller ignores (nohup) stays ignored.
    if (std::signal(signal, &remove_and_end) == SIG_IGN) std::signal(signal, SIG_IGN);
  }
}

}  // namespace touchstone
