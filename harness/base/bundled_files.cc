#include "harness/base/bundled_files.h"

namespace touchstone {
namespace {

std::filesystem::path& stands_at() {
  static std::filesystem::path place;
  return place;
}

}  // namespace

void search_bundled_above(const std::filesystem::path& file) { stands_at() = std::filesystem::absolute(file); }

std::filesystem::path own_program() {
  std::error_code error;
  if (stands_at().empty()) return std::filesystem::read_symlink("/proc/self/exe", error);
  for (auto folder = stands_at().parent_path(); folder.has_relative_path(); folder = folder.parent_path()) {
    const auto place = folder / "bin/touchstone-full";
    if (std::filesystem::exists(place, error)) return place;
  }
  return {};
}

std::optional<std::filesystem::path> find_bundled(std::string_view name) {
  std::error_code error;
  const std::filesystem::path program =
      stands_at().empty() ? std::filesystem::read_symlink("/proc/self/exe", error) : stands_at();
  for (std::filesystem::path folder = program.parent_path(); folder.has_relative_path();
       folder = folder.parent_path()) {
    const auto place = folder / "share/touchstone" / name;
    if (std::filesystem::is_directory(place, error)) return place;
  }
  return std::nullopt;
}

}  // namespace touchstone
