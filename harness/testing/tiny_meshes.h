// Small meshes of analytic shapes for tests, closed and outward unless said otherwise. (Richer ones with their exact
// answers are made by synthetic/.)
#pragma once

#include <cmath>
#include <numbers>

#include "harness/surface/box_mesh.h"
#include "harness/surface/moved_mesh.h"
#include "harness/surface/sphere_mesh.h"
#include "harness/surface/triangle_mesh.h"

namespace touchstone::testing {

// The cube [-h, h]^3, twelve triangles.
inline surface::TriangleMesh cube(double h) {
  surface::TriangleMesh mesh = surface::box_mesh(Vec3::Constant(-h), Vec3::Constant(h));
  mesh.source = "cube";
  return mesh;
}

// A flat n x n grid of squares over [-h, h]^2 at z = 0, normal +z: open.
inline surface::TriangleMesh grid(double h, int n) {
  surface::TriangleMesh mesh;
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

// surface/sphere_mesh.h under the name that these tests print.
inline surface::TriangleMesh ball(double radius, int levels) {
  surface::TriangleMesh mesh = surface::sphere_mesh(radius, levels);
  mesh.source = "ball";
  return mesh;
}

// A torus about z: ridges, valleys (saddles) and a hole. 2 n m triangles.
inline surface::TriangleMesh torus(double major, double minor, int n, int m) {
  surface::TriangleMesh mesh;
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

}  // namespace touchstone::testing
