// Object File Format, text: "OFF" (or COFF, NOFF, STOFF and their combinations), the counts, one vertex per line, then
// one face per line: n i1 ... in, and perhaps a colour.
#include <fmt/format.h>

#include <algorithm>

#include "harness/surface/mesh_soup.h"

namespace touchstone::surface::mesh_readers {
namespace {

bool known_header(std::string_view word) {
  if (!word.ends_with("OFF")) return false;
  word.remove_suffix(3);
  if (word.starts_with("ST")) word.remove_prefix(2);
  if (word.starts_with("C")) word.remove_prefix(1);
  if (word.starts_with("N")) word.remove_prefix(1);
  return word.empty();
}

}  // namespace

void read_off(std::string_view bytes, Soup& soup) {
  Lines lines(bytes);
  if (!lines.next()) soup.fail("is empty");
  auto words = lines.words();
  if (!known_header(words[0])) {
    soup.fail_at("line", lines.number(),
                 fmt::format("an OFF file starts with the word OFF (COFF, NOFF), not {}", quoted(words[0])));
  }
  words = words.subspan(1);
  if (!words.empty() && words[0] == "BINARY") {
    soup.fail_at("line", lines.number(), "binary OFF is not supported; convert the mesh to text OFF or to PLY");
  }
  if (words.empty()) {
    if (!lines.next()) soup.fail("ends before the counts of vertices and faces");
    words = lines.words();
  }
  if (words.size() < 2) soup.fail_at("line", lines.number(), "the counts of vertices, faces and edges were expected");
  const std::int64_t vertices = to_integer(words[0], soup, lines.number());
  const std::int64_t faces = to_integer(words[1], soup, lines.number());
  if (vertices < 0 || faces < 0) soup.fail_at("line", lines.number(), "counts must not be negative");
  // A vertex takes at least 6 bytes of text, a face 8: a header may claim anything.
  const auto possible = [&](std::int64_t claimed, std::size_t least) {
    return std::min(static_cast<std::size_t>(claimed), bytes.size() / least);
  };
  soup.reserve(possible(vertices, 6), possible(faces, 8));
  for (std::int64_t i = 0; i < vertices; ++i) {
    if (!lines.next()) soup.fail(fmt::format("ends after {} of {} vertices", i, vertices));
    words = lines.words();
    if (words.size() < 3)
      soup.fail_at("line", lines.number(),
                   fmt::format("vertex {}: three coordinates were expected, got {}", i, words.size()));
    Vec3 p;
    for (std::size_t j = 0; j < 3; ++j) p[static_cast<Eigen::Index>(j)] = to_double(words[j], soup, lines.number());
    soup.add_vertex(p, "line", lines.number());
  }
  std::vector<std::int64_t> corners;
  for (std::int64_t i = 0; i < faces; ++i) {
    if (!lines.next()) soup.fail(fmt::format("ends after {} of {} faces", i, faces));
    words = lines.words();
    const std::int64_t n = to_integer(words[0], soup, lines.number());
    if (n < 0 || static_cast<std::size_t>(n) > words.size() - 1) {
      soup.fail_at("line", lines.number(),
                   fmt::format("face {}: {} corners announced, {} numbers follow", i, n, words.size() - 1));
    }
    corners.clear();
    for (const std::string_view word : words.subspan(1, static_cast<std::size_t>(n)))
      corners.push_back(to_integer(word, soup, lines.number()));
    for (const std::int64_t corner : corners) {
      if (corner < 0 || corner >= vertices) {
        soup.fail_at(
            "line", lines.number(),
            fmt::format("face {}: the vertex index {} is out of range: the file has {} vertices (counted from 0)", i,
                        corner, vertices));
      }
    }
    soup.add_polygon(corners, "line", lines.number());
  }
  if (lines.next())
    soup.fail_at("line", lines.number(),
                 "more lines than the header's counts of vertices and faces; are the counts right?");
}

}  // namespace touchstone::surface::mesh_readers
