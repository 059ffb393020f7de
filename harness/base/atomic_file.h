// Output files appear whole or not at all: written beside their place, then renamed over it. An existing file is never
// left half-written, whatever goes wrong.
#pragma once

#include <filesystem>
#include <string_view>

namespace touchstone {

// A file being written beside `target`. commit() renames it into place; without commit() it is removed.
class AtomicFile {
 public:
  explicit AtomicFile(std::filesystem::path target);
  ~AtomicFile();
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;

  // Where to write now: in the target's folder, so that the rename stays within one file system.
  [[nodiscard]] const std::filesystem::path& path() const noexcept { return temporary_; }
  // Throws BadData naming the target when the rename fails.
  void commit();

 private:
  std::filesystem::path target_;
  std::filesystem::path temporary_;
  bool committed_ = false;
};

// Writes `text` to `target` atomically; throws BadData naming the file and the reason.
void write_file(const std::filesystem::path& target, std::string_view text);

// The whole file as text; throws BadData naming the file.
std::string read_file(const std::filesystem::path& path);

// Creates the folder and checks that a file can be written into it; throws BadData otherwise.
void ensure_writable_folder(const std::filesystem::path& folder);

}  // namespace touchstone
