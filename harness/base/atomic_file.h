// Output files appear whole or not at all: written beside their place, then renamed over it. An existing file is never
// left half-written, whatever goes wrong, and no file that the program reads is replaced (input_files.h).
#pragma once

#include <cstdint>
#include <filesystem>
#include <string_view>

namespace touchstone {

// Whether a file that the program has read may be replaced: only where changing it is what the user asked for.
enum class Replace : std::uint8_t { outputs, inputs_too };

// A file being written beside `target`. commit() renames it into place; without commit() it is removed. A symbolic link
// stays one: the file that it leads to is replaced. What is no file (/dev/stdout, a pipe) is written at once.
class AtomicFile {
 public:
  // Throws UsageError where `target` is an input.
  explicit AtomicFile(std::filesystem::path target, Replace replace = Replace::outputs);
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
void write_file(const std::filesystem::path& target, std::string_view text, Replace replace = Replace::outputs);

// Adds lines to a file that several processes write to at once: each comes whole, none is lost. A last line without its
// end gets one first. Throws BadData naming the file and the reason; then what was there is as it was.
void append_locked(const std::filesystem::path& target, std::string_view lines);

// The whole file as text; throws BadData naming the file.
std::string read_file(const std::filesystem::path& path);

// A folder that a command makes by default, in whatever repository it is run: git is told to leave it alone, so that it
// is no change of the tree.
void hide_from_git(const std::filesystem::path& folder);

// Creates the folder and checks that a file can be written into it; throws BadData otherwise.
void ensure_writable_folder(const std::filesystem::path& folder);

}  // namespace touchstone
