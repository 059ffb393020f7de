#include "harness/report/object_view.h"

#include <fmt/format.h>

#include <cmath>
#include <map>
#include <queue>
#include <tuple>

namespace touchstone::report {
using surface::TriangleMesh;

namespace {

using Triangle = std::array<std::int32_t, 3>;

const Vec3& corner(const TriangleMesh& mesh, std::int32_t index) {
  return mesh.vertices_W_m[static_cast<std::size_t>(index)];
}

// Which edge is longest, and how long.
std::pair<std::size_t, double> longest_edge(const TriangleMesh& mesh, const Triangle& t) {
  std::pair<std::size_t, double> out{0, -1.0};
  for (std::size_t e = 0; e < 3; ++e) {
    const double length = (corner(mesh, t[e]) - corner(mesh, t[(e + 1) % 3])).norm();
    if (length > out.second) out = {e, length};
  }
  return out;
}

TriangleMesh thinned(const TriangleMesh& mesh, double cell_m) {
  TriangleMesh out;
  std::map<std::array<std::int64_t, 3>, std::int32_t> cells;
  std::vector<std::int32_t> joined(mesh.vertices_W_m.size());
  std::vector<double> counts;
  for (std::size_t i = 0; i < mesh.vertices_W_m.size(); ++i) {
    const Vec3& v = mesh.vertices_W_m[i];
    const std::array<std::int64_t, 3> cell{static_cast<std::int64_t>(std::floor(v.x() / cell_m)),
                                           static_cast<std::int64_t>(std::floor(v.y() / cell_m)),
                                           static_cast<std::int64_t>(std::floor(v.z() / cell_m))};
    const auto [place, made] = cells.try_emplace(cell, static_cast<std::int32_t>(out.vertices_W_m.size()));
    if (made) out.vertices_W_m.emplace_back(Vec3::Zero()), counts.push_back(0.0);
    joined[i] = place->second;
    out.vertices_W_m[static_cast<std::size_t>(place->second)] += v;
    counts[static_cast<std::size_t>(place->second)] += 1.0;
  }
  for (std::size_t i = 0; i < counts.size(); ++i) out.vertices_W_m[i] /= counts[i];
  for (const Triangle& t : mesh.triangles) {
    const Triangle u{joined[static_cast<std::size_t>(t[0])], joined[static_cast<std::size_t>(t[1])],
                     joined[static_cast<std::size_t>(t[2])]};
    if (u[0] != u[1] && u[1] != u[2] && u[2] != u[0]) out.triangles.push_back(u);
  }
  return out;
}

void split(TriangleMesh& mesh, const Box3& touched, double detail_m, std::size_t most_triangles) {
  // Longest edges first, so that the limit leaves the finest mesh that it allows.
  std::priority_queue<std::pair<double, std::size_t>> work;
  const auto consider = [&](std::size_t index) {
    Box3 box;
    for (const std::int32_t i : mesh.triangles[index]) box.extend(corner(mesh, i));
    const double length = longest_edge(mesh, mesh.triangles[index]).second;
    if (length > detail_m && touched.intersects(box)) work.emplace(length, index);
  };
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) consider(i);
  std::map<std::pair<std::int32_t, std::int32_t>, std::int32_t> middles;
  while (!work.empty() && mesh.triangles.size() < most_triangles) {
    const std::size_t index = work.top().second;
    work.pop();
    const Triangle t = mesh.triangles[index];
    const std::size_t e = longest_edge(mesh, t).first;
    const std::int32_t a = t[e], b = t[(e + 1) % 3], c = t[(e + 2) % 3];
    const auto [place, made] =
        middles.try_emplace(std::minmax(a, b), static_cast<std::int32_t>(mesh.vertices_W_m.size()));
    if (made) mesh.vertices_W_m.push_back(0.5 * (corner(mesh, a) + corner(mesh, b)));
    mesh.triangles[index] = {a, place->second, c};
    mesh.triangles.push_back({place->second, b, c});
    consider(index);
    consider(mesh.triangles.size() - 1);
  }
}

}  // namespace

TriangleMesh drawn_mesh(const TriangleMesh& mesh, const Box3& touched, double detail_m, std::size_t most_triangles) {
  TriangleMesh out = mesh;
  const double size = mesh.bounds().diagonal().norm();
  for (double cell = size / 256.0; out.triangles.size() > most_triangles; cell *= 1.25) out = thinned(mesh, cell);
  const double margin = 2.0 * detail_m;
  const Box3 wide(touched.min() - Vec3::Constant(margin), touched.max() + Vec3::Constant(margin));
  if (detail_m > 0.0 && !touched.isEmpty()) split(out, wide, detail_m, most_triangles);
  return out;
}

ObjectView object_view(const TriangleMesh& mesh, const metrics::ErrorMap& errors, const Box3& touched,
                       double detail_m) {
  const TriangleMesh drawn = drawn_mesh(mesh, touched, detail_m);
  ObjectView view;
  view.vertices_W_m = drawn.vertices_W_m;
  view.triangles = drawn.triangles;
  for (const Vec3& v : drawn.vertices_W_m) view.error.push_back(errors.at(v).value_or(std::nan("")));
  if (mesh.triangles.size() > most_drawn_triangles) {
    view.note = fmt::format("The mesh has {} triangles; the drawing has {}, the renderer saw all.",
                            mesh.triangles.size(), drawn.triangles.size());
  }
  return view;
}

}  // namespace touchstone::report
