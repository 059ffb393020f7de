#include "harness/surface/extend_edges.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <queue>
#include <utility>
#include <vector>

#include "harness/base/error.h"

namespace touchstone::surface {
namespace {

using Index = std::int32_t;

// The open edges as links from vertex to vertex, in the direction in which their triangle has them: the mesh lies on
// the left, seen from outside.
class Outline {
  using Work = std::priority_queue<std::pair<double, Index>>;  // shortest new edge first: lengths stand negative

 public:
  Outline(TriangleMesh& mesh, double width_m)
      : mesh_(mesh), width_m_(width_m), normals_(mesh.vertices_W_m.size(), Vec3::Zero()) {
    std::map<std::pair<Index, Index>, int> edges;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
      const auto& corners = mesh.triangles[t];
      for (std::size_t e = 0; e < 3; ++e) {
        if (++edges[{corners[e], corners[(e + 1) % 3]}] > 1)
          refuse("triangles meet at an edge with different orientations");
        normals_[static_cast<std::size_t>(corners[e])] += mesh.scaled_normal(t);
      }
    }
    for (const auto& [edge, count] : edges) {
      if (edges.contains({edge.second, edge.first})) continue;
      const bool single =
          next_.emplace(edge.first, edge.second).second && previous_.emplace(edge.second, edge.first).second;
      if (!single) refuse("open edges meet at one vertex");
    }
  }

  // Adds triangles where the outline turns inward. One that would cover another vertex of the outline waits until the
  // others have changed it.
  void fill_notches() {
    Work work;
    for (const auto& [vertex, following] : next_) push(vertex, work);
    std::vector<Index> waiting;
    bool changed = true;
    while (changed) {
      changed = false;
      for (const Index vertex : std::exchange(waiting, {})) {
        if (next_.contains(vertex)) push(vertex, work);
      }
      while (!work.empty()) {
        const auto [length, vertex] = work.top();
        work.pop();
        // Where the outline has changed since, the vertex stands in the queue again with its new neighbours.
        if (!next_.contains(vertex) || -length != span(vertex) || !turns_inward(vertex)) continue;
        if (covers_another(vertex)) {
          waiting.push_back(vertex);
        } else {
          cut(vertex, work);
          changed = true;
        }
      }
    }
  }

  void continue_outward() {
    std::map<Index, Index> outer;
    for (const auto& [vertex, following] : next_) {
      outer[vertex] = static_cast<Index>(mesh_.vertices_W_m.size());
      const Vec3 along =
          (point(vertex) - point(previous_[vertex])).normalized() + (point(following) - point(vertex)).normalized();
      mesh_.vertices_W_m.push_back(point(vertex) + width_m_ * along.cross(normal(vertex)).normalized());
    }
    for (const auto& [vertex, following] : next_) {
      mesh_.triangles.push_back({following, vertex, outer[vertex]});
      mesh_.triangles.push_back({following, outer[vertex], outer[following]});
    }
  }

 private:
  [[noreturn]] void refuse(const char* what) const {
    throw BadData(
        fmt::format("{}: {}; its open edges cannot be continued (touchstone doctor says where)", mesh_.source, what));
  }
  [[nodiscard]] const Vec3& point(Index i) const { return mesh_.vertices_W_m[static_cast<std::size_t>(i)]; }
  [[nodiscard]] Vec3 normal(Index i) const { return normals_[static_cast<std::size_t>(i)].normalized(); }

  [[nodiscard]] bool turns_inward(Index vertex) {
    const Vec3 in = point(vertex) - point(previous_[vertex]);
    const Vec3 out = point(next_[vertex]) - point(vertex);
    // Sines of a few roundings are straight on.
    return in.cross(out).dot(normal(vertex)) < -1e-9 * in.norm() * out.norm();
  }

  [[nodiscard]] double span(Index vertex) { return (point(next_[vertex]) - point(previous_[vertex])).norm(); }

  void push(Index vertex, Work& work) {
    if (turns_inward(vertex) && span(vertex) <= width_m_ && looks_alike(vertex)) work.emplace(-span(vertex), vertex);
  }

  // Whether the triangle at the vertex looks the way that the surface does at its corners.
  [[nodiscard]] bool looks_alike(Index vertex) {
    const Vec3& here = point(vertex);
    const Vec3 up = (here - point(next_[vertex])).cross(point(previous_[vertex]) - here).normalized();
    return std::ranges::all_of(std::array{vertex, previous_[vertex], next_[vertex]},
                               [&](Index corner) { return up.dot(normal(corner)) > 0.5; });
  }

  // Whether the triangle at the vertex has another vertex of the outline inside.
  [[nodiscard]] bool covers_another(Index vertex) {
    const std::array<Index, 3> corners{next_[vertex], vertex, previous_[vertex]};
    const Vec3 up = normal(vertex);
    for (const auto& [other, following] : next_) {
      if (std::ranges::find(corners, other) != corners.end()) continue;
      // Only what lies near the triangle's plane: the far side of the object is no obstacle.
      if (std::abs((point(other) - point(vertex)).dot(up)) > span(vertex)) continue;
      bool inside = true;
      for (std::size_t i = 0; i < 3; ++i) {
        const Vec3& from = point(corners[i]);
        inside = inside && (point(corners[(i + 1) % 3]) - from).cross(point(other) - from).dot(up) >= 0.0;
      }
      if (inside) return true;
    }
    return false;
  }

  void cut(Index vertex, Work& work) {
    const Index before = previous_[vertex];
    const Index after = next_[vertex];
    mesh_.triangles.push_back({after, vertex, before});
    const Vec3 area = mesh_.scaled_normal(mesh_.triangles.size() - 1);
    for (const Index corner : {before, vertex, after}) normals_[static_cast<std::size_t>(corner)] += area;
    next_.erase(vertex);
    previous_.erase(vertex);
    if (next_[after] == before) {
      // That triangle closed the hole.
      for (const Index corner : {before, after}) next_.erase(corner), previous_.erase(corner);
      return;
    }
    next_[before] = after;
    previous_[after] = before;
    push(before, work);
    push(after, work);
  }

  TriangleMesh& mesh_;
  double width_m_;
  std::vector<Vec3> normals_;  // at each vertex, weighted by area
  std::map<Index, Index> next_, previous_;
};

}  // namespace

TriangleMesh extend_open_edges(const TriangleMesh& mesh, double width_m) {
  if (!(width_m > 0.0) || !std::isfinite(width_m)) {
    throw UsageError(fmt::format("open edges cannot be continued by {} m; expected more than 0", width_m));
  }
  TriangleMesh out = mesh;
  Outline outline(out, width_m);
  outline.fill_notches();
  outline.continue_outward();
  return out;
}

double share_at_open_edges(const Surface& surface, const MeshTopology& topology, std::span<const Vec3> tips_W_m) {
  const TriangleMesh& mesh = *surface.mesh();
  const auto on_open_edge = [&](const SurfacePoint& point) {
    if (point.feature != Feature::edge && point.feature != Feature::vertex) return false;
    const auto triangle = static_cast<std::size_t>(point.triangle);
    const auto& corners = mesh.triangles[triangle];
    for (std::size_t e = 0; e < 3; ++e) {
      const auto from = static_cast<std::size_t>(corners[e]);
      const Vec3& a = mesh.vertices_W_m[from];
      const Vec3 along = mesh.vertices_W_m[static_cast<std::size_t>(corners[(e + 1) % 3])] - a;
      if (point.p_W_m == a) return (topology.vertex_flags[from] & vertex_open) != 0;
      if (topology.neighbours[triangle][e] != open_edge) continue;
      // The point lies on one of the edges: on this one where it is nearest to it, up to the rounding of its
      // coordinates.
      const double off_m = (point.p_W_m - a).cross(along).norm() / along.norm();
      if (off_m <= 1e-9 * (along.norm() + point.p_W_m.norm())) return true;
    }
    return false;
  };
  std::size_t count = 0;
  for (const Vec3& tip : tips_W_m) count += on_open_edge(surface.closest(tip)) ? 1 : 0;
  return tips_W_m.empty() ? 0.0 : static_cast<double>(count) / static_cast<double>(tips_W_m.size());
}

}  // namespace touchstone::surface
