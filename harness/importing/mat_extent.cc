#include "harness/importing/mat_extent.h"

#include <fmt/format.h>

#include <cstdint>

#include "harness/base/error.h"

namespace touchstone::importing {

std::size_t count_mat5_elements(std::string_view file, const std::string& source) {
  constexpr std::size_t head = 128, tag = 8;
  constexpr std::uint32_t matrix = 14, compressed = 15;
  if (file.size() < head) {
    throw BadData(fmt::format("{}: ends after {} bytes, within the head of a MATLAB file: was it cut short?", source,
                              file.size()));
  }
  const bool little = file.substr(126, 2) == "IM";
  const auto number = [&](std::size_t at) {
    std::uint32_t value = 0;
    for (std::size_t i = 0; i < 4; ++i) {
      const auto byte = static_cast<std::uint32_t>(static_cast<unsigned char>(file[at + (little ? 3 - i : i)]));
      value = value << 8U | byte;
    }
    return value;
  };
  std::size_t elements = 0;
  for (std::size_t at = head; at < file.size(); ++elements) {
    const bool whole_tag = file.size() - at >= tag;
    if (whole_tag && number(at) != matrix && number(at) != compressed) {
      throw BadData(
          fmt::format("{}: byte {}: a variable of MATLAB was expected (element 14 or 15), not element {}; the "
                      "file is damaged",
                      source, at, number(at)));
    }
    if (!whole_tag || number(at + 4) > file.size() - at - tag) {
      throw BadData(
          fmt::format("{}: ends at byte {}, within the variable that begins at byte {}: was the file cut short?",
                      source, file.size(), at));
    }
    at += tag + number(at + 4);
  }
  return elements;
}

}  // namespace touchstone::importing
