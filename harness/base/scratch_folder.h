// A folder for files of a moment, empty at first, which goes with the object.
#pragma once

#include <cstdlib>
#include <filesystem>
#include <string>

#include "harness/base/error.h"

namespace touchstone {

class ScratchFolder {
 public:
  explicit ScratchFolder(const std::filesystem::path& in = std::filesystem::temp_directory_path()) {
    std::string pattern = (in / "touchstone-XXXXXX").string();
    if (::mkdtemp(pattern.data()) == nullptr) throw BadData(pattern + ": no folder can be made for temporary files");
    path_ = pattern;
  }
  ~ScratchFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;
  [[nodiscard]] const std::filesystem::path& path() const noexcept { return path_; }

 private:
  std::filesystem::path path_;
};

}  // namespace touchstone
