// An indexed triangle mesh in metres with outward orientation (counter-clockwise seen from outside): the plain arrays
// that readers fill and queries and renderers build their own structures from.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "harness/base/vec.h"

namespace touchstone::surface {

// An index that files keep as 32 bits, as one of std::vector.
constexpr std::size_t at(std::int32_t i) { return static_cast<std::size_t>(i); }

// What a reader had to do to make triangles of what the file says.
struct MeshReadingNote {
  std::string name;  // "folded-polygons", "joined-corners"
  std::size_t count = 0;
  std::string what;  // one sentence, with the place of the first in the file's unit as well
  Vec3 first_W_m = Vec3::Zero();
};

struct TriangleMesh {
  std::vector<Vec3> vertices_W_m;
  std::vector<std::array<std::int32_t, 3>> triangles;
  std::string source;  // the file or generator it came from, for messages
  std::vector<MeshReadingNote> notes;

  [[nodiscard]] std::size_t triangle_count() const noexcept { return triangles.size(); }
  [[nodiscard]] Box3 bounds() const {
    Box3 box;
    for (const Vec3& v : vertices_W_m) box.extend(v);
    return box;
  }
  // Not normalised: its length is twice the triangle's area.
  [[nodiscard]] Vec3 scaled_normal(std::size_t triangle) const {
    const auto& [a, b, c] = triangles[triangle];
    const Vec3& origin = vertices_W_m[static_cast<std::size_t>(a)];
    return (vertices_W_m[static_cast<std::size_t>(b)] - origin)
        .cross(vertices_W_m[static_cast<std::size_t>(c)] - origin);
  }
};

}  // namespace touchstone::surface
