// What the readers of the formats have in common: the polygons as the file gives them, and the text as lines of words.
// Private to the readers.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "harness/surface/triangle_mesh.h"

namespace touchstone::surface::mesh_readers {

// Collects vertices and polygons; place() strings tell errors where in the file. Indices count from 0.
class Soup {
 public:
  explicit Soup(std::string source, double unit_m) : source_(std::move(source)), unit_m_(unit_m) {}

  void reserve(std::size_t vertices, std::size_t polygons);
  // Coordinates in the file's unit.
  void add_vertex(const Vec3& p, std::string_view where, std::uint64_t number);
  // `where` and `number` name the place: "line" 12, "face" 3.
  void add_polygon(std::span<const std::int64_t> corners, std::string_view where, std::uint64_t number);
  [[nodiscard]] std::size_t vertex_count() const noexcept { return vertices_.size(); }
  // The triangles, once every index is known to exist; refuses an empty or absurdly sized mesh.
  TriangleMesh finish() &&;

  [[noreturn]] void fail(std::string_view message) const;
  [[noreturn]] void fail_at(std::string_view where, std::uint64_t number, std::string_view message) const;

 private:
  struct Place {
    std::string_view where;  // points to a literal
    std::uint64_t number;
    std::int64_t index;
    std::size_t triangle;  // the first that the polygon became
  };
  [[nodiscard]] bool fan_is_upright(std::span<const std::int32_t> corners, std::size_t hub) const;
  void cut(const Place& place, std::span<const std::int32_t> corners);

  std::string source_;
  double unit_m_;
  std::vector<Vec3> vertices_;
  std::vector<std::array<std::int32_t, 3>> triangles_;
  MeshReadingNote folded_;
  std::vector<std::int32_t> corners_;  // of the polygon at hand
  std::vector<Place> pending_;         // polygons that name vertices which the file had not given yet
  std::vector<std::pair<Place, std::vector<std::int32_t>>> polygons_;  // those with more than three corners
};

// Walks over text line by line, each split at white space. Comments start with '#'.
class Lines {
 public:
  explicit Lines(std::string_view text, bool joins_backslash = false) : text_(text), joins_(joins_backslash) {}

  // The next line that has a word in it; false at the end.
  bool next();
  [[nodiscard]] std::span<const std::string_view> words() const noexcept { return words_; }
  [[nodiscard]] std::uint64_t number() const noexcept { return number_; }
  // Where the line after the present one starts.
  [[nodiscard]] std::size_t offset() const noexcept { return position_; }

 private:
  std::string_view text_;
  bool joins_;
  std::size_t position_ = 0;
  std::uint64_t line_ = 0;    // of position_
  std::uint64_t number_ = 0;  // of words_
  std::vector<std::string_view> words_;
};

// In quotes, cut short and printable: a word must not flood the terminal.
std::string quoted(std::string_view word);

// The whole word as a number, or an error that quotes it.
double to_double(std::string_view word, const Soup& soup, std::uint64_t line);
std::int64_t to_integer(std::string_view word, const Soup& soup, std::uint64_t line);

void read_obj(std::string_view bytes, Soup& soup);
void read_off(std::string_view bytes, Soup& soup);
void read_ply(std::string_view bytes, Soup& soup);
void read_stl(std::string_view bytes, Soup& soup);

}  // namespace touchstone::surface::mesh_readers
