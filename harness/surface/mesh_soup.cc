#include "harness/surface/mesh_soup.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <limits>

#include "harness/base/error.h"
#include "harness/surface/mesh_file.h"
#include "harness/surface/polygon_ears.h"

namespace touchstone::surface::mesh_readers {
namespace {

// Trying all corners of a polygon costs the square of their number.
constexpr std::size_t largest_hub = 64;
// Cutting ears costs the square of their number too, and in the worst case the cube.
constexpr std::size_t largest_polygon = 4096;

bool is_space(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\v' || c == '\f'; }

}  // namespace

std::string quoted(std::string_view word) {
  std::string out = "'";
  for (const char c : word.substr(0, 40)) out += (c >= 32 && c < 127) ? c : '?';
  return out + (word.size() > 40 ? "...'" : "'");
}

void Soup::fail(std::string_view message) const { throw BadData(fmt::format("{}: {}", source_, message)); }

void Soup::fail_at(std::string_view where, std::uint64_t number, std::string_view message) const {
  throw BadData(fmt::format("{}: {} {}: {}", source_, where, number, message));
}

void Soup::reserve(std::size_t vertices, std::size_t polygons) {
  vertices_.reserve(vertices);
  triangles_.reserve(polygons);
}

void Soup::add_vertex(const Vec3& p, std::string_view where, std::uint64_t number) {
  if (!p.allFinite()) {
    fail_at(where, number, fmt::format("the vertex ({}, {}, {}) is not finite", p.x(), p.y(), p.z()));
  }
  const Vec3 scaled = unit_m_ * p;
  if (!(scaled.cwiseAbs().maxCoeff() <= largest_mesh_coordinate_m)) {
    fail_at(where, number,
            fmt::format("the vertex ({}, {}, {}) is more than {} m away from the origin; is the mesh unit right?",
                        p.x(), p.y(), p.z(), largest_mesh_coordinate_m));
  }
  if (vertices_.size() >= static_cast<std::size_t>(std::numeric_limits<std::int32_t>::max())) {
    fail_at(where, number, "more vertices than a 32-bit index can name");
  }
  vertices_.push_back(scaled);
}

void Soup::add_polygon(std::span<const std::int64_t> corners, std::string_view where, std::uint64_t number) {
  if (corners.size() < 3)
    fail_at(where, number, fmt::format("a face needs at least 3 corners, this one has {}", corners.size()));
  corners_.clear();
  std::int64_t largest = 0;
  for (const std::int64_t corner : corners) {
    if (corner < 0 || corner > std::numeric_limits<std::int32_t>::max()) {
      fail_at(where, number, fmt::format("the vertex index {} (counted from 0) does not exist", corner));
    }
    largest = std::max(largest, corner);
    corners_.push_back(static_cast<std::int32_t>(corner));
  }
  if (triangles_.size() + corners.size() >= static_cast<std::size_t>(std::numeric_limits<std::int32_t>::max())) {
    fail_at(where, number, "more triangles than a 32-bit index can name");
  }
  const Place place{where, number, largest, triangles_.size()};
  if (largest >= static_cast<std::int64_t>(vertices_.size())) pending_.push_back(place);
  if (corners_.size() > 3) polygons_.emplace_back(place, corners_);
  for (std::size_t i = 2; i < corners_.size(); ++i) triangles_.push_back({corners_[0], corners_[i - 1], corners_[i]});
}

bool Soup::fan_is_upright(std::span<const std::int32_t> corners, std::size_t hub) const {
  const auto at = [&](std::size_t i) -> const Vec3& {
    return vertices_[static_cast<std::size_t>(corners[(hub + i) % corners.size()])];
  };
  // Newell's normal is the sum of the fan's scaled normals: the polygon's own orientation.
  Vec3 normal = Vec3::Zero();
  double size = 0.0, largest = 0.0;
  for (std::size_t i = 2; i < corners.size(); ++i) {
    const Vec3 one = (at(i - 1) - at(0)).cross(at(i) - at(0));
    normal += one;
    largest = std::max(largest, one.norm());
    size = std::max({size, (at(i - 1) - at(0)).squaredNorm(), (at(i) - at(0)).squaredNorm()});
  }
  // As much of it faces the one way as the other: it crosses itself.
  constexpr double nothing = 1e-9;
  if (normal.norm() <= nothing * largest) return largest == 0.0;
  // Corners on one line, and corners that text rounded to six digits, may turn a fan triangle by less than this.
  const double rounding = 1e-5 * size * normal.norm();
  for (std::size_t i = 2; i < corners.size(); ++i) {
    if ((at(i - 1) - at(0)).cross(at(i) - at(0)).dot(normal) < -rounding) return false;
  }
  return true;
}

void Soup::cut(const Place& place, std::span<const std::int32_t> corners) {
  for (std::size_t hub = 0; hub < std::min(corners.size(), largest_hub); ++hub) {
    if (!fan_is_upright(corners, hub)) continue;
    const auto at = [&](std::size_t i) { return corners[(hub + i) % corners.size()]; };
    for (std::size_t i = 2; hub > 0 && i < corners.size(); ++i)
      triangles_[place.triangle + i - 2] = {at(0), at(i - 1), at(i)};
    return;
  }
  if (corners.size() > largest_polygon) {
    fail_at(place.where, place.number,
            fmt::format("the polygon has {} corners and is not convex; at most {} are cut: give triangles",
                        corners.size(), largest_polygon));
  }
  std::vector<Vec3> points;
  for (const std::int32_t corner : corners) points.push_back(vertices_[static_cast<std::size_t>(corner)]);
  const Ears ears = cut_ears(points);
  for (std::size_t i = 0; i < ears.triangles.size(); ++i) {
    const auto& [a, b, c] = ears.triangles[i];
    triangles_[place.triangle + i] = {corners[a], corners[b], corners[c]};
  }
  if (!ears.folded) return;
  if (folded_.count++ == 0) {
    folded_.name = "folded-polygons";
    folded_.first_W_m = points.front();
    folded_.what = fmt::format("the first in {} {}", place.where, place.number);
  }
}

TriangleMesh Soup::finish() && {
  const auto count = static_cast<std::int64_t>(vertices_.size());
  for (const Place& place : pending_) {
    if (place.index >= count) {
      fail_at(place.where, place.number,
              fmt::format("the vertex index {} (counted from 0) is out of range: the file has {} vertices", place.index,
                          count));
    }
  }
  if (triangles_.empty()) {
    fail(count == 0 ? "has no vertices and no triangles"
                    : fmt::format("has {} vertices but no triangles; a surface was expected", count));
  }
  for (const auto& [place, corners] : polygons_) cut(place, corners);
  Box3 box;
  for (const auto& triangle : triangles_) {
    for (const std::int32_t corner : triangle) box.extend(vertices_[static_cast<std::size_t>(corner)]);
  }
  if (!(box.sizes().maxCoeff() >= smallest_mesh_extent_m)) {
    fail(fmt::format("all triangles lie within {} m; is the mesh unit right?", box.sizes().maxCoeff()));
  }
  TriangleMesh mesh;
  mesh.vertices_W_m = std::move(vertices_);
  mesh.triangles = std::move(triangles_);
  mesh.source = source_;
  if (folded_.count > 0) {
    folded_.what =
        fmt::format("{}, and cut into triangles of which some are turned over; {}",
                    folded_.count == 1 ? "1 polygon crosses itself or is folded"
                                       : fmt::format("{} polygons cross themselves or are folded", folded_.count),
                    folded_.what);
    mesh.notes.push_back(std::move(folded_));
  }
  return mesh;
}

bool Lines::next() {
  words_.clear();
  while (position_ < text_.size()) {
    std::size_t end = text_.find('\n', position_);
    if (end == std::string_view::npos) end = text_.size();
    std::string_view line = text_.substr(position_, end - position_);
    position_ = std::min(end + 1, text_.size());
    ++line_;
    if (words_.empty()) number_ = line_;
    if (const std::size_t comment = line.find('#'); comment != std::string_view::npos) line = line.substr(0, comment);
    while (!line.empty() && is_space(line.back())) line.remove_suffix(1);
    const bool continues = joins_ && !line.empty() && line.back() == '\\';
    if (continues) line.remove_suffix(1);
    std::size_t i = 0;
    while (i < line.size()) {
      while (i < line.size() && is_space(line[i])) ++i;
      const std::size_t start = i;
      while (i < line.size() && !is_space(line[i])) ++i;
      if (i > start) words_.push_back(line.substr(start, i - start));
    }
    if (!words_.empty() && !continues) return true;
  }
  return !words_.empty();
}

double to_double(std::string_view word, const Soup& soup, std::uint64_t line) {
  std::string_view digits = word;
  if (digits.size() > 1 && digits.front() == '+' && digits[1] != '-') digits.remove_prefix(1);
  double value = 0.0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (end != digits.data() + digits.size() || error == std::errc::invalid_argument) {
    soup.fail_at("line", line, fmt::format("{} is not a number", quoted(word)));
  }
  if (error == std::errc::result_out_of_range)
    return std::strtod(std::string(digits).c_str(), nullptr);  // 0 or infinity
  return value;
}

std::int64_t to_integer(std::string_view word, const Soup& soup, std::uint64_t line) {
  std::int64_t value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (end != word.data() + word.size() || error != std::errc()) {
    soup.fail_at("line", line, fmt::format("{} is not a whole number", quoted(word)));
  }
  return value;
}

}  // namespace touchstone::surface::mesh_readers
