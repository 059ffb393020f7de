#include "harness/base/bundled_files.h"

namespace touchstone {

std::optional<std::filesystem::path> find_bundled(std::string_view name) {
  std::error_code error;
  const std::filesystem::path program = std::filesystem::read_symlink("/proc/self/exe", error);
  for (std::filesystem::path folder = program.parent_path(); folder.has_relative_path();
       folder = folder.parent_path()) {
    const auto place = folder / "share/touchstone" / name;
    if (std::filesystem::is_directory(place, error)) return place;
  }
  return std::nullopt;
}

}  // namespace touchstone
