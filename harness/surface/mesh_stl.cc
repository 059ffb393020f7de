// STL: text ("solid ... facet ... vertex x y z") and binary (80 bytes, count, 50 bytes per triangle, little-endian
// floats).
#include <fmt/format.h>

#include <bit>
#include <cstring>

#include "harness/surface/mesh_soup.h"

namespace touchstone::surface::mesh_readers {
namespace {

static_assert(std::endian::native == std::endian::little, "binary STL and PLY are read as little-endian");

constexpr std::size_t header_bytes = 84;
constexpr std::size_t triangle_bytes = 50;

std::uint32_t claimed_triangles(std::string_view bytes) {
  std::uint32_t count = 0;
  std::memcpy(&count, bytes.data() + 80, sizeof count);
  return count;
}

void add_triangle(Soup& soup, std::string_view where, std::uint64_t number) {
  const auto n = static_cast<std::int64_t>(soup.vertex_count());
  const std::array<std::int64_t, 3> corners{n - 3, n - 2, n - 1};
  soup.add_polygon(corners, where, number);
}

void read_binary(std::string_view bytes, std::uint32_t count, Soup& soup) {
  soup.reserve(3UL * count, count);
  for (std::uint32_t i = 0; i < count; ++i) {
    std::array<float, 12> numbers{};  // the normal, which is not used, and the corners
    std::memcpy(numbers.data(), bytes.data() + header_bytes + i * triangle_bytes, sizeof numbers);
    for (std::size_t corner = 3; corner < 12; corner += 3) {
      soup.add_vertex(Vec3(static_cast<double>(numbers[corner]), static_cast<double>(numbers[corner + 1]),
                           static_cast<double>(numbers[corner + 2])),
                      "triangle", i);
    }
    add_triangle(soup, "triangle", i);
  }
}

void read_text(std::string_view bytes, Soup& soup) {
  Lines lines(bytes);
  int corners = -1;  // of the open facet; -1 outside
  bool ended = false;
  while (lines.next()) {
    const auto words = lines.words();
    const std::string_view key = words[0];
    if (key == "facet") {
      if (corners >= 0) soup.fail_at("line", lines.number(), "'facet' within a facet; 'endfacet' is missing");
      corners = 0;
      ended = false;
    } else if (key == "vertex") {
      if (words.size() != 4)
        soup.fail_at("line", lines.number(),
                     fmt::format("three coordinates were expected after 'vertex', got {}", words.size() - 1));
      if (corners < 0 || corners == 3)
        soup.fail_at("line", lines.number(),
                     corners < 0 ? "'vertex' outside a facet" : "a facet has more than three vertices");
      Vec3 p;
      for (std::size_t i = 0; i < 3; ++i)
        p[static_cast<Eigen::Index>(i)] = to_double(words[i + 1], soup, lines.number());
      soup.add_vertex(p, "line", lines.number());
      ++corners;
    } else if (key == "endfacet") {
      if (corners != 3)
        soup.fail_at("line", lines.number(),
                     fmt::format("the facet has {} vertices, three were expected", corners < 0 ? 0 : corners));
      add_triangle(soup, "line", lines.number());
      corners = -1;
    } else if (key == "endsolid") {
      ended = true;
    } else if (key != "solid" && key != "outer" && key != "endloop") {
      soup.fail_at("line", lines.number(), fmt::format("{} is not a word of an STL file", quoted(key)));
    }
  }
  if (corners >= 0) soup.fail("ends within a facet");
  if (!ended) soup.fail("ends without 'endsolid'; is the file truncated?");
}

}  // namespace

void read_stl(std::string_view bytes, Soup& soup) {
  if (bytes.empty()) soup.fail("is empty");
  const bool has_header = bytes.size() >= header_bytes;
  // Binary files may start with "solid" too: the size decides.
  if (has_header && bytes.size() == header_bytes + triangle_bytes * std::size_t{claimed_triangles(bytes)}) {
    read_binary(bytes, claimed_triangles(bytes), soup);
  } else if (bytes
                 .substr(bytes.find_first_not_of(" \t\r\n") == std::string_view::npos
                             ? 0
                             : bytes.find_first_not_of(" \t\r\n"))
                 .starts_with("solid")) {
    read_text(bytes, soup);
  } else if (has_header) {
    soup.fail(fmt::format(
        "binary STL announces {} triangles, which take {} bytes, but the file has {}; is it truncated?",
        claimed_triangles(bytes), header_bytes + triangle_bytes * std::size_t{claimed_triangles(bytes)}, bytes.size()));
  } else {
    soup.fail(
        fmt::format("{} bytes are neither text STL (which starts with 'solid') nor binary STL (at least {} bytes)",
                    bytes.size(), header_bytes));
  }
}

}  // namespace touchstone::surface::mesh_readers
