// Small meshes of analytic shapes for tests, closed and outward unless said otherwise. (Richer ones with their exact
// answers are made by synthetic/.)
#pragma once

#include <cmath>
#include <map>
#include <numbers>
#include <utility>

#include "harness/surface/triangle_mesh.h"
#include "harness/testing/testing_rooms.h"

namespace touchstone::testing {

// The cube [-h, h]^3, twelve triangles.
inline TriangleMesh cube(double h) {
  TriangleMesh mesh;
  for (int i = 0; i < 8; ++i) mesh.vertices_W_m.emplace_back(i & 1 ? h : -h, i & 2 ? h : -h, i & 4 ? h : -h);
  mesh.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                    {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  mesh.source = "cube";
  return mesh;
}

// A flat n x n grid of squares over [-h, h]^2 at z = 0, normal +z: open.
inline TriangleMesh grid(double h, int n) {
  TriangleMesh mesh;
  for (int j = 0; j <= n; ++j) {
    for (int i = 0; i <= n; ++i) mesh.vertices_W_m.emplace_back(h * (2.0 * i / n - 1.0), h * (2.0 * j / n - 1.0), 0.0);
  }
  for (int j = 0; j < n; ++j) {
    for (int i = 0; i < n; ++i) {
      const int v = j * (n + 1) + i;
      mesh.triangles.push_back({v, v + 1, v + n + 2});
      mesh.triangles.push_back({v, v + n + 2, v + n + 1});
    }
  }
  mesh.source = "grid";
  return mesh;
}

// An octahedron refined `levels` times towards the sphere of that radius: 8 * 4^levels triangles, corners on the
// sphere.
inline TriangleMesh ball(double radius, int levels) {
  TriangleMesh mesh;
  mesh.vertices_W_m = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
  mesh.triangles = {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4}, {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};
  for (int level = 0; level < levels; ++level) {
    std::map<std::pair<int, int>, int> middles;
    const auto middle = [&](int a, int b) {
      const auto [it, added] = middles.try_emplace(std::minmax(a, b), static_cast<int>(mesh.vertices_W_m.size()));
      if (added) {
        const Vec3 p = mesh.vertices_W_m[static_cast<std::size_t>(a)] + mesh.vertices_W_m[static_cast<std::size_t>(b)];
        mesh.vertices_W_m.push_back(p.normalized());
      }
      return it->second;
    };
    std::vector<std::array<std::int32_t, 3>> finer;
    for (const auto& [a, b, c] : mesh.triangles) {
      const int ab = middle(a, b);
      const int bc = middle(b, c);
      const int ca = middle(c, a);
      finer.insert(finer.end(), {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
    }
    mesh.triangles = std::move(finer);
  }
  for (Vec3& v : mesh.vertices_W_m) v *= radius;
  mesh.source = "ball";
  return mesh;
}

// A torus about z: ridges, valleys (saddles) and a hole. 2 n m triangles.
inline TriangleMesh torus(double major, double minor, int n, int m) {
  TriangleMesh mesh;
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < m; ++j) {
      const double u = 2.0 * std::numbers::pi * i / n;
      const double v = 2.0 * std::numbers::pi * j / m;
      const double r = major + minor * std::cos(v);
      mesh.vertices_W_m.emplace_back(r * std::cos(u), r * std::sin(u), minor * std::sin(v));
    }
  }
  const auto at = [&](int i, int j) { return (i % n) * m + j % m; };
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < m; ++j) {
      mesh.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      mesh.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  }
  mesh.source = "torus";
  return mesh;
}

inline TriangleMesh moved(TriangleMesh mesh, const Quat& rotation, const Vec3& shift, double scale = 1.0) {
  for (Vec3& v : mesh.vertices_W_m) v = rotation * (scale * v) + shift;
  return mesh;
}

}  // namespace touchstone::testing
