// Wavefront OBJ, text: "v x y z", "f a b c ..." with a as i, i/j, i//k or i/j/k; negative indices count back from the
// newest vertex. Free-form curves and surfaces are refused, attributes and groups ignored.
#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "harness/surface/mesh_soup.h"

namespace touchstone::surface::mesh_readers {
namespace {

constexpr std::array<std::string_view, 20> ignored_words{
    "vt",     "vn", "vp", "g",     "o",        "s",        "mg",  "usemtl",     "mtllib",    "usemap",
    "maplib", "l",  "p",  "bevel", "c_interp", "d_interp", "lod", "shadow_obj", "trace_obj", "call"};

std::int64_t corner_index(std::string_view word, const Soup& soup, std::uint64_t line) {
  const std::int64_t index = to_integer(word.substr(0, word.find('/')), soup, line);
  if (index > 0) return index - 1;
  const auto count = static_cast<std::int64_t>(soup.vertex_count());
  if (index == 0) soup.fail_at("line", line, "the vertex index 0 does not exist: OBJ counts from 1");
  if (index < -count) {
    soup.fail_at("line", line,
                 fmt::format("the relative vertex index {} points before the first of {} vertices", index, count));
  }
  return count + index;
}

}  // namespace

void read_obj(std::string_view bytes, Soup& soup) {
  Lines lines(bytes, true);
  std::vector<std::int64_t> corners;
  while (lines.next()) {
    const auto words = lines.words();
    const std::string_view key = words[0];
    if (key == "v") {
      if (words.size() < 4) {
        soup.fail_at("line", lines.number(),
                     fmt::format("three coordinates were expected after 'v', got {}", words.size() - 1));
      }
      Vec3 p;
      for (std::size_t i = 0; i < 3; ++i)
        p[static_cast<Eigen::Index>(i)] = to_double(words[i + 1], soup, lines.number());
      soup.add_vertex(p, "line", lines.number());
    } else if (key == "f" || key == "fo") {
      corners.clear();
      for (const std::string_view word : words.subspan(1)) corners.push_back(corner_index(word, soup, lines.number()));
      soup.add_polygon(corners, "line", lines.number());
    } else if (std::find(ignored_words.begin(), ignored_words.end(), key) == ignored_words.end()) {
      soup.fail_at("line", lines.number(),
                   fmt::format("{} is not an OBJ statement that describes a polygon mesh; expected v, f, or attributes",
                               quoted(key)));
    }
  }
}

}  // namespace touchstone::surface::mesh_readers
