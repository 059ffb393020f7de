#include "synthetic/surfaces/icosphere.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <utility>

namespace touchstone::synthetic {
using surface::TriangleMesh;

namespace {

constexpr double phi = std::numbers::phi;
const std::array<Vec3, 12> corners{Vec3{-1, phi, 0}, {1, phi, 0}, {-1, -phi, 0}, {1, -phi, 0},
                                   {0, -1, phi},     {0, 1, phi}, {0, -1, -phi}, {0, 1, -phi},
                                   {phi, 0, -1},     {phi, 0, 1}, {-phi, 0, -1}, {-phi, 0, 1}};
constexpr std::array<std::array<std::int32_t, 3>, 20> faces{
    {{0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
     {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
     {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}}};

// Vertices of a subdivided icosahedron: 12 corners, n - 1 inner ones on each of 30 edges, the rest inside the faces.
class Subdivision {
 public:
  explicit Subdivision(std::int32_t n) : n_(n) {
    for (const Vec3& corner : corners) points.push_back(corner);
  }

  // The triangles of one face, its vertices at barycentric (i, j, n - i - j) / n.
  void add_face(const std::array<std::int32_t, 3>& face, std::vector<std::array<std::int32_t, 3>>& triangles) {
    std::vector<std::vector<std::int32_t>> rows(static_cast<std::size_t>(n_ + 1));
    for (std::int32_t i = 0; i <= n_; ++i) {
      for (std::int32_t j = 0; j <= n_ - i; ++j) rows[static_cast<std::size_t>(i)].push_back(vertex(face, i, j));
    }
    for (std::size_t i = 0; i + 1 < rows.size(); ++i) {
      for (std::size_t j = 0; j + 1 < rows[i].size(); ++j) {
        triangles.push_back({rows[i][j], rows[i + 1][j], rows[i][j + 1]});
        if (j + 1 < rows[i + 1].size()) triangles.push_back({rows[i + 1][j], rows[i + 1][j + 1], rows[i][j + 1]});
      }
    }
  }

  std::vector<Vec3> points;  // not yet on the sphere

 private:
  std::int32_t vertex(const std::array<std::int32_t, 3>& face, std::int32_t i, std::int32_t j) {
    const std::int32_t k = n_ - i - j;
    if (i == n_) return face[0];
    if (j == n_) return face[1];
    if (k == n_) return face[2];
    if (k == 0) return on_edge(face[0], face[1], j);
    if (i == 0) return on_edge(face[1], face[2], k);
    if (j == 0) return on_edge(face[0], face[2], k);
    points.push_back((i * corner(face[0]) + j * corner(face[1]) + k * corner(face[2])) / n_);
    return static_cast<std::int32_t>(points.size() - 1);
  }
  // The step-th vertex from a towards b, the same for both faces of the edge.
  std::int32_t on_edge(std::int32_t a, std::int32_t b, std::int32_t step) {
    if (a > b) {
      std::swap(a, b);
      step = n_ - step;
    }
    const auto [found, fresh] = edges_.try_emplace({a, b}, static_cast<std::int32_t>(points.size()));
    if (fresh) {
      for (std::int32_t s = 1; s < n_; ++s) points.push_back(((n_ - s) * corner(a) + s * corner(b)) / n_);
    }
    return found->second + step - 1;
  }
  [[nodiscard]] static const Vec3& corner(std::int32_t index) { return corners[static_cast<std::size_t>(index)]; }

  std::int32_t n_;
  std::map<std::pair<std::int32_t, std::int32_t>, std::int32_t> edges_;
};

}  // namespace

TriangleMesh icosphere(std::size_t triangles, const std::function<double(const Vec3&)>& radius_m) {
  const double n = std::round(std::sqrt(static_cast<double>(triangles) / 20.0));
  Subdivision subdivision(static_cast<std::int32_t>(std::max(1.0, n)));
  TriangleMesh mesh;
  for (const auto& face : faces) subdivision.add_face(face, mesh.triangles);
  mesh.vertices_W_m = std::move(subdivision.points);
  for (Vec3& v : mesh.vertices_W_m) {
    const Vec3 u = v.normalized();
    v = radius_m(u) * u;
  }
  return mesh;
}

double longest_edge_m(const TriangleMesh& mesh) {
  double longest = 0.0;
  for (const auto& t : mesh.triangles) {
    for (std::size_t i = 0; i < 3; ++i) {
      const auto a = static_cast<std::size_t>(t[i]);
      const auto b = static_cast<std::size_t>(t[(i + 1) % 3]);
      longest = std::max(longest, (mesh.vertices_W_m[b] - mesh.vertices_W_m[a]).squaredNorm());
    }
  }
  return std::sqrt(longest);
}

}  // namespace touchstone::synthetic
