#include "texture_library.h"

#include <fmt/format.h>

#include <cstdint>
#include <string_view>
#include <system_error>

#include "harness/base/atomic_file.h"
#include "harness/base/error.h"

namespace touchstone::texture {
namespace {

constexpr std::string_view name{"touchstone-hatt\n", 16};
constexpr std::size_t length_bytes = 8;

}  // namespace

std::filesystem::path plain_texture_library() {
  std::error_code error;
  const std::filesystem::path program = std::filesystem::read_symlink("/proc/self/exe", error);
  const std::filesystem::path library =
      program.parent_path().parent_path() / "libexec" / "touchstone" / "touchstone-texture-plugin.so";
  if (error || !std::filesystem::exists(library, error))
    throw BadData(
        fmt::format("{}: the plug-in that plays textures is not there; install Touchstone again", library.string()));
  return library;
}

void write_texture_library(const std::filesystem::path& library, const std::string& xml,
                           const std::filesystem::path& out) {
  std::string bytes = read_file(library) + xml;
  for (std::size_t i = 0; i < length_bytes; ++i) bytes += static_cast<char>((xml.size() >> (8 * i)) & 0xff);
  write_file(out, bytes.append(name));
}

std::optional<std::string> model_in_library(const std::filesystem::path& library) {
  const std::string bytes = read_file(library);
  if (!bytes.ends_with(name) || bytes.size() < name.size() + length_bytes) return std::nullopt;
  const std::size_t end = bytes.size() - name.size() - length_bytes;
  std::uint64_t length = 0;
  for (std::size_t i = 0; i < length_bytes; ++i)
    length |= static_cast<std::uint64_t>(static_cast<unsigned char>(bytes[end + i])) << (8 * i);
  if (length > end) return std::nullopt;
  return bytes.substr(end - length, length);
}

}  // namespace touchstone::texture
