#include "renderers/mesh_traversal/mesh_regularity.h"

#include <algorithm>
#include <atomic>
#include <bit>
#include <memory>

#include "harness/surface/exact_predicates.h"
#include "harness/surface/triangle_queries.h"
#include "renderers/mesh_traversal/flush.h"

namespace touchstone::renderers {
using surface::TriangleMesh;

namespace {

using Corners = std::array<Vec3, 3>;

Corners corners_of(const TriangleMesh& mesh, std::int32_t t) {
  const auto& c = mesh.triangles[surface::at(t)];
  return {mesh.vertices_W_m[surface::at(c[0])], mesh.vertices_W_m[surface::at(c[1])],
          mesh.vertices_W_m[surface::at(c[2])]};
}

// Whether the edge passes through the other triangle or touches it; one within its plane does not count.
bool edge_crosses(const Corners& edges_of, std::size_t edge, const Corners& other) {
  const Vec3& a = edges_of[edge];
  const Vec3& b = edges_of[(edge + 1) % 3];
  const auto& [u, v, w] = other;
  const int from = surface::side_of_plane(u, v, w, a);
  const int to = surface::side_of_plane(u, v, w, b);
  if (from * to > 0 || (from == 0 && to == 0)) return false;
  const int first = surface::side_of_plane(a, b, u, v);
  const int second = surface::side_of_plane(a, b, v, w);
  const int third = surface::side_of_plane(a, b, w, u);
  return first * second >= 0 && second * third >= 0 && third * first >= 0;
}

// The corners that two triangles have in common, a bit for each corner of either. Asked of millions of pairs: without
// branches.
struct Shared {
  unsigned a = 0;
  unsigned b = 0;
  Shared(const std::array<std::int32_t, 3>& first, const std::array<std::int32_t, 3>& second) {
    for (unsigned i = 0; i < 3; ++i) {
      for (unsigned j = 0; j < 3; ++j) {
        const auto same = static_cast<unsigned>(first[i] == second[j]);
        a |= same << i;
        b |= same << j;
      }
    }
  }
  [[nodiscard]] int count() const { return std::popcount(a); }
  // The first corner if there is none: a triangle that names a corner twice may have no lone one.
  static std::size_t last(unsigned corners) { return static_cast<std::size_t>(std::bit_width(corners | 1U) - 1); }
  static std::size_t lone(unsigned corners) { return last(~corners & 7U); }
};

// Of two triangles that share one corner: whether both other corners of the second lie on one side of the first one's
// plane for sure, as nearly always; then they meet in the corner alone.
bool only_meet_there(const TriangleMesh& mesh, const std::array<std::int32_t, 3>& a, std::size_t i,
                     const std::array<std::int32_t, 3>& b, std::size_t j) {
  const auto vertex = [&](std::int32_t k) -> const Vec3& { return mesh.vertices_W_m[surface::at(k)]; };
  const surface::PlaneFilter plane(vertex(a[i]), vertex(a[(i + 1) % 3]), vertex(a[(i + 2) % 3]));
  return plane.side(vertex(b[(j + 1) % 3])) * plane.side(vertex(b[(j + 2) % 3])) > 0;
}

// Whether two triangles meet other than along what they share.
bool cross(const TriangleMesh& mesh, std::int32_t s, std::int32_t t) {
  const auto& a = mesh.triangles[surface::at(s)];
  const auto& b = mesh.triangles[surface::at(t)];
  const Shared shared(a, b);
  if (shared.count() == 1 && only_meet_there(mesh, a, Shared::last(shared.a), b, Shared::last(shared.b))) return false;
  const Corners p = corners_of(mesh, s);
  const Corners q = corners_of(mesh, t);
  // The far sides of two triangles apart: nothing meets.
  const auto apart = [](const Corners& plane, const Corners& other) {
    int least = 2;
    int most = -2;
    for (const Vec3& x : other) {
      const int side = surface::side_of_plane(plane[0], plane[1], plane[2], x);
      least = std::min(least, side);
      most = std::max(most, side);
    }
    return least > 0 || most < 0;
  };
  if (shared.count() == 0) {
    if (apart(p, q) || apart(q, p)) return false;
    for (std::size_t e = 0; e < 3; ++e) {
      if (edge_crosses(p, e, q) || edge_crosses(q, e, p)) return true;
    }
    return false;
  }
  if (shared.count() == 1) {
    // Only the edges opposite to the shared corner can cross.
    return edge_crosses(p, (Shared::last(shared.a) + 1) % 3, q) || edge_crosses(q, (Shared::last(shared.b) + 1) % 3, p);
  }
  if (shared.count() == 3) return true;
  // Folded flat onto its neighbour: the free corners lie in one plane with the edge, on the same side of it.
  const std::size_t lone_a = Shared::lone(shared.a);
  const std::size_t lone_b = Shared::lone(shared.b);
  if (surface::side_of_plane(p[0], p[1], p[2], q[lone_b]) != 0) return false;
  const Vec3& from = p[(lone_a + 1) % 3];
  const Vec3 along = p[(lone_a + 2) % 3] - from;
  return along.cross(p[lone_a] - from).dot(along.cross(q[lone_b] - from)) > 0.0;
}

// The number of each triangle's body; empty where there is one only.
std::vector<std::int32_t> bodies(const surface::MeshTopology& topology) {
  const std::size_t count = topology.neighbours.size();
  std::vector<std::int32_t> body(count, -1);
  std::vector<std::int32_t> queue;
  queue.reserve(count);
  std::int32_t found = 0;
  for (std::size_t seed = 0; seed < count; ++seed) {
    if (body[seed] >= 0) continue;
    body[seed] = found;
    queue.assign(1, static_cast<std::int32_t>(seed));
    for (std::size_t head = 0; head < queue.size(); ++head) {
      for (const std::int32_t next : topology.neighbours[surface::at(queue[head])]) {
        if (next < 0 || body[surface::at(next)] >= 0) continue;
        body[surface::at(next)] = found;
        queue.push_back(next);
      }
    }
    if (queue.size() == count) return {};
    ++found;
  }
  return body;
}

double squared_distance_of_segments(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  // C. Ericson, Real-Time Collision Detection, 2005, section 5.1.9.
  const Vec3 u = b - a;
  const Vec3 v = d - c;
  const Vec3 r = a - c;
  const double uu = u.squaredNorm();
  const double vv = v.squaredNorm();
  const double uv = u.dot(v);
  const double ur = u.dot(r);
  const double vr = v.dot(r);
  const double det = uu * vv - uv * uv;
  double s = det > 0.0 ? std::clamp((uv * vr - ur * vv) / det, 0.0, 1.0) : 0.0;
  double t = vv > 0.0 ? (uv * s + vr) / vv : 0.0;
  if (t < 0.0 || t > 1.0) {
    t = std::clamp(t, 0.0, 1.0);
    s = uu > 0.0 ? std::clamp((uv * t - ur) / uu, 0.0, 1.0) : 0.0;
  }
  return (r + s * u - t * v).squaredNorm();
}

// Whether the triangles come as close as that: a corner to a triangle, or an edge to an edge, as wherever they do not
// cross.
bool within_reach(const Corners& p, const Vec3& p_normal, const Corners& q, const Vec3& q_normal, double reach) {
  const double most = reach * reach;
  for (std::size_t i = 0; i < 3; ++i) {
    if (surface::closest_on_triangle(q, q_normal, p[i]).squared_distance <= most) return true;
    if (surface::closest_on_triangle(p, p_normal, q[i]).squared_distance <= most) return true;
    for (std::size_t j = 0; j < 3; ++j) {
      if (squared_distance_of_segments(p[i], p[(i + 1) % 3], q[j], q[(j + 1) % 3]) <= most) return true;
    }
  }
  return false;
}

double magnitude_of(const TriangleMesh& mesh) {
  double magnitude = 0.0;
  for (const auto& triangle : mesh.triangles) {
    for (const std::int32_t corner : triangle)
      magnitude = std::max(magnitude, mesh.vertices_W_m[surface::at(corner)].cwiseAbs().maxCoeff());
  }
  return magnitude;
}

}  // namespace

std::vector<bool> regular_triangles(const TriangleMesh& mesh, const surface::MeshTopology& topology,
                                    const surface::TriangleTree& tree) {
  const std::size_t count = mesh.triangle_count();
  std::vector<bool> regular(count);
  for (std::size_t t = 0; t < count; ++t) {
    bool good = !topology.face_normals[t].isZero(0.0);
    for (std::size_t e = 0; e < 3; ++e) {
      const std::int32_t neighbour = topology.neighbours[t][e];
      good = good && neighbour != surface::non_manifold_edge &&
             (neighbour < 0 || !topology.face_normals[surface::at(neighbour)].isZero(0.0));
      good = good && (topology.vertex_flags[surface::at(mesh.triangles[t][e])] & surface::vertex_non_manifold) == 0;
    }
    regular[t] = good;
  }
  const std::vector<std::int32_t> body = bodies(topology);
  const double flush = body.empty() ? 0.0 : flush_m(magnitude_of(mesh));
  const auto touch = [&](std::int32_t s, std::int32_t t) {
    return !body.empty() && body[surface::at(s)] != body[surface::at(t)] &&
           within_reach(corners_of(mesh, s), topology.face_normals[surface::at(s)], corners_of(mesh, t),
                        topology.face_normals[surface::at(t)], flush);
  };
  // Pairs come from several threads at a time.
  const auto crossed = std::make_unique<std::atomic<bool>[]>(count);
  tree.overlapping_pairs([&](std::int32_t s, std::int32_t t) {
    if (s < t && (cross(mesh, s, t) || touch(s, t))) crossed[surface::at(s)] = crossed[surface::at(t)] = true;
  });
  for (std::size_t t = 0; t < count; ++t) regular[t] = regular[t] && !crossed[t];
  return regular;
}

}  // namespace touchstone::renderers
