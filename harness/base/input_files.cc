#include "harness/base/input_files.h"

#include <fmt/format.h>
#include <sys/stat.h>

#include <atomic>
#include <map>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <utility>

#include "harness/base/error.h"

namespace touchstone {
namespace {

// A file whatever its names: device and number.
using FileIdentity = std::pair<dev_t, ino_t>;

struct KnownFiles {
  std::mutex mutex;
  std::map<FileIdentity, std::string> read;  // with the name under which each was read
  std::set<FileIdentity> written;
};

std::atomic<bool> inputs_protected = false;

KnownFiles& known_files() {
  static KnownFiles files;
  return files;
}

// Of regular files only: a pipe or device cannot be destroyed by writing.
std::optional<FileIdentity> identity_of(const std::string& path) {
  struct stat about {};
  if (::stat(path.c_str(), &about) != 0 || !S_ISREG(about.st_mode)) return std::nullopt;
  return FileIdentity{about.st_dev, about.st_ino};
}

}  // namespace

void protect_input_files() { inputs_protected = true; }

void forget_input_files() {
  inputs_protected = false;
  KnownFiles& files = known_files();
  const std::lock_guard lock(files.mutex);
  files.read.clear();
  files.written.clear();
}

void note_input_file(const std::filesystem::path& path) {
  if (!inputs_protected) return;
  const auto identity = identity_of(path.native());
  if (!identity) return;
  KnownFiles& files = known_files();
  const std::lock_guard lock(files.mutex);
  if (!files.written.contains(*identity)) files.read.emplace(*identity, path.native());
}

void note_output_file(const std::filesystem::path& path) {
  if (!inputs_protected) return;
  const auto identity = identity_of(path.native());
  if (!identity) return;
  KnownFiles& files = known_files();
  const std::lock_guard lock(files.mutex);
  files.written.insert(*identity);
  files.read.erase(*identity);
}

void refuse_to_replace_input(const std::filesystem::path& target) {
  if (!inputs_protected) return;
  const auto identity = identity_of(target.native());
  if (!identity) return;
  KnownFiles& files = known_files();
  const std::lock_guard lock(files.mutex);
  const auto found = files.read.find(*identity);
  // The number of a file that is gone may be given to a new one: only a file that is still there can be destroyed.
  if (found == files.read.end() || identity_of(found->second) != identity) return;
  throw UsageError(fmt::format("{}: is {}, which this command reads; nothing was written. Give the output another name",
                               target.string(),
                               found->second == target.native() ? "an input" : "the same file as " + found->second));
}

}  // namespace touchstone
