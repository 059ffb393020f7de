#include "harness/diagnosis/meshes.h"

#include <cmath>
#include <map>
#include <utility>

namespace touchstone::diagnosis {
namespace {

// Corners 0..3 below, 4..7 above, x fastest.
const std::vector<std::array<std::int32_t, 3>> kBoxTriangles{{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6},
                                                             {0, 1, 4}, {1, 5, 4}, {2, 6, 3}, {3, 6, 7},
                                                             {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};

}  // namespace

TriangleMesh block(const Vec3& low, const Vec3& high) {
  TriangleMesh mesh;
  for (int i = 0; i < 8; ++i) {
    mesh.vertices_W_m.emplace_back((i & 1) != 0 ? high.x() : low.x(), (i & 2) != 0 ? high.y() : low.y(),
                                   (i & 4) != 0 ? high.z() : low.z());
  }
  mesh.triangles = kBoxTriangles;
  mesh.source = "block";
  return mesh;
}

TriangleMesh together(const TriangleMesh& a, const TriangleMesh& b) {
  TriangleMesh mesh = a;
  const auto first = static_cast<std::int32_t>(a.vertices_W_m.size());
  mesh.vertices_W_m.insert(mesh.vertices_W_m.end(), b.vertices_W_m.begin(), b.vertices_W_m.end());
  for (const auto& [i, j, k] : b.triangles) mesh.triangles.push_back({first + i, first + j, first + k});
  mesh.source = a.source + " and " + b.source;
  return mesh;
}

TriangleMesh nested_sheet(double h, double smallest_m) {
  TriangleMesh mesh;
  mesh.source = "nested sheet";
  // A ring of eight corners at half-width w, counter-clockwise from (1, 0).
  constexpr std::array<std::pair<int, int>, 8> kRing{
      {{1, 0}, {1, 1}, {0, 1}, {-1, 1}, {-1, 0}, {-1, -1}, {0, -1}, {1, -1}}};
  double w = h;
  std::int32_t outer = 0;
  const auto add_ring = [&] {
    const auto first = static_cast<std::int32_t>(mesh.vertices_W_m.size());
    for (const auto& [x, y] : kRing) mesh.vertices_W_m.emplace_back(w * x, w * y, 0.0);
    return first;
  };
  add_ring();
  while (w > smallest_m) {
    w *= 0.5;
    const std::int32_t inner = add_ring();
    for (std::int32_t i = 0; i < 8; ++i) {
      const std::int32_t next = (i + 1) % 8;
      // The diagonal goes from the ring's corner, so that no angle gets small.
      if (i % 2 == 0) {
        mesh.triangles.push_back({outer + i, outer + next, inner + next});
        mesh.triangles.push_back({outer + i, inner + next, inner + i});
      } else {
        mesh.triangles.push_back({outer + i, outer + next, inner + i});
        mesh.triangles.push_back({outer + next, inner + next, inner + i});
      }
    }
    outer = inner;
  }
  const auto middle = static_cast<std::int32_t>(mesh.vertices_W_m.size());
  mesh.vertices_W_m.push_back(Vec3::Zero());
  for (std::int32_t i = 0; i < 8; ++i) mesh.triangles.push_back({middle, outer + i, outer + (i + 1) % 8});
  return mesh;
}

TriangleMesh roof(double h, double angle_rad) {
  TriangleMesh mesh;
  mesh.source = "roof";
  const double end = -h * std::tan(angle_rad);
  const std::array<std::pair<double, double>, 6> profile{
      {{-h, -h}, {0.0, -h}, {h, -h}, {h, end}, {0.0, 0.0}, {-h, 0.0}}};
  for (const double y : {-h, h}) {
    for (const auto& [x, z] : profile) mesh.vertices_W_m.emplace_back(x, y, z);
  }
  for (std::int32_t i = 0; i < 6; ++i) {
    const std::int32_t next = (i + 1) % 6;
    mesh.triangles.push_back({i, 6 + i, next});
    mesh.triangles.push_back({next, 6 + i, 6 + next});
  }
  // The profile runs counter-clockwise in x and z, which is seen so from -y: the end at -y as it is, the other turned.
  const std::array<std::array<std::int32_t, 3>, 4> front{{{0, 1, 5}, {1, 4, 5}, {1, 2, 4}, {2, 3, 4}}};
  for (const auto& [a, b, c] : front) {
    mesh.triangles.push_back({a, b, c});
    mesh.triangles.push_back({6 + a, 6 + c, 6 + b});
  }
  return mesh;
}

TriangleMesh sphere(double radius_m, int levels) {
  TriangleMesh mesh;
  mesh.source = "sphere";
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
  for (Vec3& v : mesh.vertices_W_m) v *= radius_m;
  return mesh;
}

TriangleMesh moved(TriangleMesh mesh, const Quat& turn, const Vec3& shift, double unit) {
  for (Vec3& v : mesh.vertices_W_m) v = turn * (unit * v) + shift;
  return mesh;
}

}  // namespace touchstone::diagnosis
