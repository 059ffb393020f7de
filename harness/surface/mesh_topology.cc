#include "harness/surface/mesh_topology.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "harness/base/huge_pages.h"
#include "harness/base/in_parallel.h"

namespace touchstone::surface {
namespace {

// A triangle that names a vertex twice is no neighbour of anything.
bool collapsed(const std::array<std::int32_t, 3>& t) { return t[0] == t[1] || t[1] == t[2] || t[2] == t[0]; }

// Half-edge 3 t + e.
struct HalfEdge {
  std::int32_t other;  // the larger vertex
  std::int32_t halfedge;
  bool forward;  // runs from the smaller vertex to the larger
};

class Builder {
 public:
  explicit Builder(const TriangleMesh& mesh) : mesh_(mesh) {}

  MeshTopology build() {
    const std::size_t triangles = mesh_.triangles.size();
    const std::size_t vertices = mesh_.vertices_W_m.size();
    reserve_in_huge_pages(out_.neighbours, triangles);
    reserve_in_huge_pages(out_.convexity, triangles);
    out_.neighbours.assign(triangles, {open_edge, open_edge, open_edge});
    out_.convexity.assign(triangles, {Convexity::flat, Convexity::flat, Convexity::flat});
    out_.vertex_flags.assign(vertices, 0);
    face_normals();
    match_edges();
    edge_convexity();
    fans();
    vertex_normals();
    return std::move(out_);
  }

 private:
  // In extended precision: the error of a sliver's normal is that of its cross product times length over width, and a
  // far query point multiplies it by its distance.
  void face_normals() {
    using Long3 = Eigen::Matrix<long double, 3, 1>;
    reserve_in_huge_pages(out_.face_normals, mesh_.triangles.size());
    out_.face_normals.resize(mesh_.triangles.size());
    in_parallel(mesh_.triangles.size(), [&](std::size_t t) {
      const auto& [a, b, c] = mesh_.triangles[t];
      const Long3 origin = mesh_.vertices_W_m[at(a)].cast<long double>();
      const Long3 u = mesh_.vertices_W_m[at(b)].cast<long double>() - origin;
      const Long3 v = mesh_.vertices_W_m[at(c)].cast<long double>() - origin;
      const Long3 n = u.cross(v);
      const long double length = n.norm();
      const long double longest = std::max({u.squaredNorm(), v.squaredNorm(), (v - u).squaredNorm()});
      // Below this the cross product of the (exactly known) corners would be rounding in double precision.
      const bool has_area = length > 8.0L * std::numeric_limits<double>::epsilon() * longest;
      out_.face_normals[t] = has_area ? Vec3((n / length).cast<double>()) : Vec3::Zero();
    });
  }

  [[nodiscard]] Vec3 edge(std::int32_t from, std::int32_t to) const {
    return mesh_.vertices_W_m[at(to)] - mesh_.vertices_W_m[at(from)];
  }

  // Half-edges in buckets by their smaller vertex; those of a bucket with the same other vertex are one edge.
  void match_edges() {
    std::vector<std::int32_t> start(mesh_.vertices_W_m.size() + 1, 0);
    const auto each = [&](auto&& visit) {
      for (std::size_t t = 0; t < mesh_.triangles.size(); ++t) {
        const auto& corners = mesh_.triangles[t];
        if (collapsed(corners)) continue;
        for (std::size_t e = 0; e < 3; ++e)
          visit(corners[e], corners[(e + 1) % 3], static_cast<std::int32_t>(3 * t + e));
      }
    };
    each([&](std::int32_t from, std::int32_t to, std::int32_t) { ++start[at(std::min(from, to)) + 1]; });
    std::partial_sum(start.begin(), start.end(), start.begin());
    std::vector<HalfEdge> halfedges;
    reserve_in_huge_pages(halfedges, at(start.back()));
    halfedges.resize(at(start.back()));
    std::vector<std::int32_t> fill(start.begin(), start.end() - 1);
    each([&](std::int32_t from, std::int32_t to, std::int32_t h) {
      halfedges[at(fill[at(std::min(from, to))]++)] = {std::max(from, to), h, from < to};
    });
    for (std::size_t v = 0; v + 1 < start.size(); ++v) {
      const auto first = halfedges.begin() + start[v];
      const auto last = halfedges.begin() + start[v + 1];
      // Few per bucket, except at the hub of a large fan.
      std::sort(first, last, [](const HalfEdge& a, const HalfEdge& b) {
        return a.other != b.other ? a.other < b.other : a.halfedge < b.halfedge;
      });
      for (auto group = first; group != last;) {
        const auto end = std::find_if(group, last, [&](const HalfEdge& h) { return h.other != group->other; });
        join(std::span(group, end), static_cast<std::int32_t>(v));
        group = end;
      }
    }
  }

  void join(std::span<const HalfEdge> group, std::int32_t vertex) {
    const auto set = [&](const HalfEdge& h, std::int32_t neighbour) {
      out_.neighbours[at(h.halfedge) / 3][at(h.halfedge) % 3] = neighbour;
    };
    const std::int32_t other = group.front().other;
    if (group.size() == 1) {
      ++out_.open_edge_count;
      for (const std::int32_t v : {vertex, other}) out_.vertex_flags[at(v)] |= vertex_open;
    } else if (group.size() == 2 && group[0].forward != group[1].forward) {
      set(group[0], group[1].halfedge / 3);
      set(group[1], group[0].halfedge / 3);
    } else {
      (group.size() == 2 ? out_.disoriented_edges : out_.non_manifold_edges).push_back({vertex, other});
      for (const HalfEdge& h : group) set(h, non_manifold_edge);
      for (const std::int32_t v : {vertex, other}) out_.vertex_flags[at(v)] |= vertex_non_manifold;
    }
  }

  // The corner of `triangle` that is not on the edge from `from` to `to`.
  [[nodiscard]] Vec3 opposite(std::int32_t triangle, std::int32_t from, std::int32_t to) const {
    for (const std::int32_t v : mesh_.triangles[at(triangle)]) {
      if (v != from && v != to) return mesh_.vertices_W_m[at(v)];
    }
    return mesh_.vertices_W_m[at(from)];
  }

  void edge_convexity() {
    in_parallel(mesh_.triangles.size(), [&](std::size_t t) {
      for (std::size_t e = 0; e < 3; ++e) {
        const std::int32_t neighbour = out_.neighbours[t][e];
        if (neighbour < 0) continue;
        const std::int32_t from = mesh_.triangles[t][e];
        const std::int32_t to = mesh_.triangles[t][(e + 1) % 3];
        // Both triangles give the same answer: each asks for the side of the other's free corner.
        const Vec3 reach = opposite(neighbour, from, to) - mesh_.vertices_W_m[at(from)];
        const Vec3 back = opposite(static_cast<std::int32_t>(t), from, to) - mesh_.vertices_W_m[at(from)];
        const double here = reach.dot(out_.face_normals[t]);
        const double there = back.dot(out_.face_normals[at(neighbour)]);
        const double rounding = 16.0 * std::numeric_limits<double>::epsilon() * (reach.norm() + back.norm());
        const double side = std::abs(here) > std::abs(there) ? here : there;
        out_.convexity[t][e] = side < -rounding  ? Convexity::ridge
                               : side > rounding ? Convexity::valley
                                                 : Convexity::flat;
      }
    });
  }

  void fans() {
    const std::size_t vertices = mesh_.vertices_W_m.size();
    out_.fan_start.assign(vertices + 1, 0);
    for (const auto& triangle : mesh_.triangles) {
      if (collapsed(triangle)) continue;
      for (const std::int32_t corner : triangle) ++out_.fan_start[at(corner) + 1];
    }
    std::partial_sum(out_.fan_start.begin(), out_.fan_start.end(), out_.fan_start.begin());
    reserve_in_huge_pages(out_.fan_triangles, at(out_.fan_start.back()));
    out_.fan_triangles.resize(at(out_.fan_start.back()));
    std::vector<std::int32_t> fill(out_.fan_start.begin(), out_.fan_start.end() - 1);
    for (std::size_t t = 0; t < mesh_.triangles.size(); ++t) {
      if (collapsed(mesh_.triangles[t])) continue;
      for (const std::int32_t corner : mesh_.triangles[t]) {
        const std::size_t v = at(corner);
        out_.fan_triangles[at(fill[v]++)] = static_cast<std::int32_t>(t);
        out_.vertex_flags[v] |= vertex_used;
      }
    }
    done_.assign(mesh_.triangles.size(), 0);
    for (std::size_t v = 0; v < vertices; ++v) order_fan(static_cast<std::int32_t>(v));
  }

  [[nodiscard]] std::size_t corner_of(std::int32_t triangle, std::int32_t vertex) const {
    const auto& corners = mesh_.triangles[at(triangle)];
    return corners[0] == vertex ? 0 : corners[1] == vertex ? 1 : 2;
  }
  // Counter-clockwise about the vertex lies the triangle across the edge that ends in it, clockwise that across the one
  // that starts in it.
  [[nodiscard]] std::int32_t counter_clockwise(std::int32_t triangle, std::int32_t vertex) const {
    return out_.neighbours[at(triangle)][(corner_of(triangle, vertex) + 2) % 3];
  }
  [[nodiscard]] std::int32_t clockwise(std::int32_t triangle, std::int32_t vertex) const {
    return out_.neighbours[at(triangle)][corner_of(triangle, vertex)];
  }

  void order_fan(std::int32_t vertex) {
    const std::span<std::int32_t> fan(out_.fan_triangles.data() + out_.fan_start[at(vertex)],
                                      at(out_.fan_start[at(vertex) + 1] - out_.fan_start[at(vertex)]));
    if (fan.empty()) return;
    ++mark_;
    ordered_.clear();
    int parts = 0;
    const auto walk = [&](std::int32_t triangle) {
      ++parts;
      while (triangle >= 0 && done_[at(triangle)] != mark_) {
        done_[at(triangle)] = mark_;
        ordered_.push_back(triangle);
        triangle = counter_clockwise(triangle, vertex);
      }
    };
    for (const std::int32_t t : fan) {
      if (clockwise(t, vertex) < 0 && done_[at(t)] != mark_) walk(t);
    }
    for (const std::int32_t t : fan) {
      if (done_[at(t)] != mark_) walk(t);
    }
    if (parts > 1) out_.vertex_flags[at(vertex)] |= vertex_non_manifold;
    std::copy(ordered_.begin(), ordered_.end(), fan.begin());
  }

  void vertex_normals() {
    std::vector<std::array<double, 3>> angles;
    reserve_in_huge_pages(angles, mesh_.triangles.size());
    angles.resize(mesh_.triangles.size());
    in_parallel(angles.size(), [&](std::size_t t) {
      const auto& corners = mesh_.triangles[t];
      for (std::size_t i = 0; i < 3; ++i) {
        const Vec3 u = edge(corners[i], corners[(i + 1) % 3]);
        const Vec3 w = edge(corners[i], corners[(i + 2) % 3]);
        angles[t][i] = std::atan2(u.cross(w).norm(), u.dot(w));
      }
    });
    // Summed in the triangles' order: the same bits on any number of threads.
    reserve_in_huge_pages(out_.vertex_normals, mesh_.vertices_W_m.size());
    out_.vertex_normals.assign(mesh_.vertices_W_m.size(), Vec3::Zero());
    for (std::size_t t = 0; t < angles.size(); ++t) {
      for (std::size_t i = 0; i < 3; ++i)
        out_.vertex_normals[at(mesh_.triangles[t][i])] += angles[t][i] * out_.face_normals[t];
    }
    for (Vec3& n : out_.vertex_normals) n.normalize();
  }

  const TriangleMesh& mesh_;
  MeshTopology out_;
  std::vector<std::int32_t> done_;  // the mark of the last vertex whose fan has the triangle
  std::vector<std::int32_t> ordered_;
  std::int32_t mark_ = 0;
};

}  // namespace

Vec3 MeshTopology::edge_normal(std::size_t triangle, std::size_t edge) const {
  const std::int32_t neighbour = neighbours[triangle][edge];
  if (neighbour < 0) return face_normals[triangle];
  // Face normals that cancel (a fold) have no pseudo-normal: the face's own is as good as any.
  const Vec3 sum = face_normals[triangle] + face_normals[at(neighbour)];
  const double length = sum.norm();
  return length > 8.0 * std::numeric_limits<double>::epsilon() ? Vec3(sum / length) : face_normals[triangle];
}

MeshTopology make_topology(const TriangleMesh& mesh) { return Builder(mesh).build(); }

}  // namespace touchstone::surface
