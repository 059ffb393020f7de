#include "contacts/tool_meshes.h"

#include <cmath>
#include <map>
#include <numbers>

#include "synthetic/surfaces/icosphere.h"

namespace touchstone::contacts {
using surface::TriangleMesh;

namespace {

void add_quad(TriangleMesh& mesh, std::int32_t a, std::int32_t b, std::int32_t c, std::int32_t d) {
  mesh.triangles.push_back({a, b, c});
  mesh.triangles.push_back({a, c, d});
}

}  // namespace

TriangleMesh box_mesh(const Vec3& low_m, const Vec3& high_m, int divisions) {
  TriangleMesh mesh;
  mesh.source = "box";
  std::map<std::array<int, 3>, std::int32_t> known;
  const auto vertex = [&](const std::array<int, 3>& i) {
    const auto [found, is_new] = known.try_emplace(i, static_cast<std::int32_t>(mesh.vertices_W_m.size()));
    if (is_new) {
      Vec3 p;
      for (int k = 0; k < 3; ++k) {
        const double share = double(i[std::size_t(k)]) / divisions;
        p[k] = low_m[k] * (1.0 - share) + high_m[k] * share;
      }
      mesh.vertices_W_m.push_back(p);
    }
    return found->second;
  };
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (const bool top : {false, true}) {
      for (int u = 0; u < divisions; ++u) {
        for (int v = 0; v < divisions; ++v) {
          const auto corner = [&](int du, int dv) {
            std::array<int, 3> i{};
            i[axis] = top ? divisions : 0;
            i[(axis + 1) % 3] = u + du;
            i[(axis + 2) % 3] = v + dv;
            return vertex(i);
          };
          if (top)
            add_quad(mesh, corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1));
          else
            add_quad(mesh, corner(0, 0), corner(0, 1), corner(1, 1), corner(1, 0));
        }
      }
    }
  }
  return mesh;
}

TriangleMesh ellipsoid_mesh(const Vec3& center_m, const Vec3& semi_axes_m, std::size_t triangles) {
  TriangleMesh mesh = synthetic::icosphere(triangles, [](const Vec3&) { return 1.0; });
  for (Vec3& v : mesh.vertices_W_m) v = center_m + semi_axes_m.cwiseProduct(v);
  mesh.source = "ellipsoid";
  return mesh;
}

TriangleMesh cylinder_mesh(const Vec3& center_m, double radius_m, double length_m, int sides) {
  TriangleMesh mesh;
  mesh.source = "cylinder";
  for (const double end : {-0.5, 0.5}) mesh.vertices_W_m.push_back(center_m + Vec3(end * length_m, 0, 0));
  for (int i = 0; i < sides; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / sides;
    for (const double end : {-0.5, 0.5}) {
      mesh.vertices_W_m.push_back(center_m +
                                  Vec3(end * length_m, radius_m * std::cos(angle), radius_m * std::sin(angle)));
    }
  }
  for (int i = 0; i < sides; ++i) {
    const std::int32_t a = 2 + 2 * i;
    const std::int32_t b = 2 + 2 * ((i + 1) % sides);
    add_quad(mesh, a, a + 1, b + 1, b);
    mesh.triangles.push_back({0, a, b});
    mesh.triangles.push_back({1, b + 1, a + 1});
  }
  for (auto& t : mesh.triangles) std::swap(t[1], t[2]);
  return mesh;
}

TriangleMesh groove_mesh(double depth_m, double angle_rad, double half_size_m) {
  TriangleMesh mesh;
  mesh.source = "groove";
  const double half_width = depth_m / std::tan(angle_rad);
  // The section in the plane of y and z, counter-clockwise seen from +x; fans of the two parts that are convex.
  const std::vector<std::array<double, 2>> section{{-half_size_m, -3.0 * depth_m},
                                                   {0.0, -3.0 * depth_m},
                                                   {half_size_m, -3.0 * depth_m},
                                                   {half_size_m, 0.0},
                                                   {half_width, 0.0},
                                                   {0.0, -depth_m},
                                                   {-half_width, 0.0},
                                                   {-half_size_m, 0.0}};
  const auto n = static_cast<std::int32_t>(section.size());
  for (const double x : {-half_size_m, half_size_m})
    for (const auto& [y, z] : section) mesh.vertices_W_m.emplace_back(x, y, z);
  for (std::int32_t i = 0; i < n; ++i) {
    const std::int32_t j = (i + 1) % n;
    add_quad(mesh, i, n + i, n + j, j);
  }
  for (auto& t : mesh.triangles) std::swap(t[1], t[2]);
  for (const auto& [a, b, c] :
       std::vector<std::array<std::int32_t, 3>>{{1, 2, 3}, {1, 3, 4}, {1, 4, 5}, {1, 5, 6}, {1, 6, 7}, {1, 7, 0}}) {
    mesh.triangles.push_back({n + a, n + b, n + c});
    mesh.triangles.push_back({a, c, b});
  }
  return mesh;
}

TriangleMesh hole_mesh(double hole_half_width_m, double half_size_m, double depth_m) {
  TriangleMesh mesh;
  mesh.source = "hole";
  // Rings of four corners, counter-clockwise seen from above: 0 inner top, 4 outer top, 8 inner bottom, 12 outer
  // bottom.
  for (const double z : {0.0, -depth_m}) {
    for (const double w : {hole_half_width_m, half_size_m}) {
      for (const auto& [x, y] : std::vector<std::array<double, 2>>{{1, 1}, {-1, 1}, {-1, -1}, {1, -1}})
        mesh.vertices_W_m.emplace_back(w * x, w * y, z);
    }
  }
  for (std::int32_t i = 0; i < 4; ++i) {
    const std::int32_t j = (i + 1) % 4;
    add_quad(mesh, i, 4 + i, 4 + j, j);            // top
    add_quad(mesh, 8 + i, 8 + j, 12 + j, 12 + i);  // bottom
    add_quad(mesh, 4 + i, 12 + i, 12 + j, 4 + j);  // outside
    add_quad(mesh, i, j, 8 + j, 8 + i);            // walls of the hole
  }
  return mesh;
}

TriangleMesh joined(const TriangleMesh& a, const TriangleMesh& b) {
  TriangleMesh mesh = a;
  const auto offset = static_cast<std::int32_t>(a.vertices_W_m.size());
  mesh.vertices_W_m.insert(mesh.vertices_W_m.end(), b.vertices_W_m.begin(), b.vertices_W_m.end());
  for (const auto& [i, j, k] : b.triangles) mesh.triangles.push_back({i + offset, j + offset, k + offset});
  mesh.source = a.source + " and " + b.source;
  return mesh;
}

}  // namespace touchstone::contacts
