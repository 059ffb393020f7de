#include "harness/base/atomic_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <sstream>
#include <string>

#include "harness/base/error.h"
#include "harness/base/half_files.h"
#include "harness/base/input_files.h"

namespace touchstone {
namespace {

std::filesystem::path beside(const std::filesystem::path& target) {
  static std::atomic<unsigned> counter{0};
  auto name = fmt::format(".{}.{}-{}.part", target.filename().string(), ::getpid(), counter++);
  return target.parent_path() / name;
}

// The file that symbolic links lead to, which need not be there yet.
std::filesystem::path end_of_links(std::filesystem::path path) {
  constexpr int most_links = 40;  // as Linux follows
  std::error_code error;
  for (int i = 0; i < most_links && std::filesystem::is_symlink(path, error); ++i) {
    const auto next = std::filesystem::read_symlink(path, error);
    if (error) break;
    path = next.is_absolute() ? next : path.parent_path() / next;
  }
  return path;
}

// A device, a pipe, or an open file of a process (/dev/stdout leads to /proc/self/fd/1): renaming would put a file in
// its place.
bool is_written_in_place(const std::filesystem::path& path) {
  std::error_code error;
  const auto type = std::filesystem::status(path, error).type();
  using std::filesystem::file_type;
  return type == file_type::character || type == file_type::block || type == file_type::fifo ||
         type == file_type::socket || path.native().starts_with("/proc/");
}

}  // namespace

AtomicFile::AtomicFile(std::filesystem::path target, Replace replace) : target_(end_of_links(std::move(target))) {
  if (replace == Replace::outputs) refuse_to_replace_input(target_);
  if (is_written_in_place(target_)) {
    temporary_ = target_;
    committed_ = true;
    return;
  }
  temporary_ = beside(target_);
  add_half_file(temporary_);
}

AtomicFile::~AtomicFile() {
  if (temporary_ == target_) return;
  std::error_code ignored;
  if (!committed_) std::filesystem::remove(temporary_, ignored);
  drop_half_file(temporary_);
}

void AtomicFile::commit() {
  if (temporary_ == target_) return;
  std::error_code error;
  std::filesystem::rename(temporary_, target_, error);
  if (error) throw BadData(fmt::format("{}: cannot be written: {}", target_.string(), error.message()));
  committed_ = true;
  note_output_file(target_);
}

void write_file(const std::filesystem::path& target, std::string_view text, Replace replace) {
  AtomicFile file(target, replace);
  errno = 0;
  std::ofstream out(file.path(), std::ios::binary);
  out.write(text.data(), static_cast<std::streamsize>(text.size()));
  out.close();
  if (!out) throw BadData(fmt::format("{}: cannot be written: {}", target.string(), std::strerror(errno)));
  file.commit();
}

std::string read_file(const std::filesystem::path& path) {
  std::error_code error;
  if (std::filesystem::is_directory(path, error)) {
    throw BadData(fmt::format("{}: is a folder; a file was expected", path.string()));
  }
  std::ifstream in(path, std::ios::binary);
  if (!in)
    throw BadData(fmt::format("{}: cannot be opened for reading; does it exist, and may you read it?", path.string()));
  std::ostringstream text;
  text << in.rdbuf();
  return std::move(text).str();
}

void append_locked(const std::filesystem::path& target, std::string_view lines) {
  const int fd = ::open(target.c_str(), O_RDWR | O_CREAT | O_APPEND | O_CLOEXEC, 0666);
  const auto failed = [&] {
    const int error = errno;
    if (fd >= 0) ::close(fd);
    return BadData(fmt::format("{}: cannot be written: {}", target.string(), std::strerror(error)));
  };
  if (fd < 0 || ::flock(fd, LOCK_EX) != 0) throw failed();  // freed when the descriptor is closed
  const off_t size = ::lseek(fd, 0, SEEK_END);
  char last = '\n';
  if (size < 0 || (size > 0 && ::pread(fd, &last, 1, size - 1) != 1)) throw failed();
  const std::string text = (last == '\n' ? "" : "\n") + std::string(lines);
  std::size_t written = 0;
  while (written < text.size()) {
    const auto n = ::write(fd, text.data() + written, text.size() - written);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) {
      const int error = errno;
      if (::ftruncate(fd, size) != 0) errno = error;
      errno = error;
      throw failed();
    }
    written += static_cast<std::size_t>(n);
  }
  ::close(fd);
}

void hide_from_git(const std::filesystem::path& folder) {
  if (const auto ignore = folder / ".gitignore"; !std::filesystem::exists(ignore)) write_file(ignore, "*\n");
}

void ensure_writable_folder(const std::filesystem::path& folder) {
  const std::error_code error = make_folders(folder);
  if (!error) {
    AtomicFile probe(folder / "probe");
    if (std::ofstream(probe.path()).good()) return;
  }
  throw BadData(fmt::format("{}: the output folder cannot be written{}; choose another --out or change its permissions",
                            folder.string(), error ? ": " + error.message() : ""));
}

}  // namespace touchstone
