// The inside of NearPairFinder: the tests of two features at one pose, and whether two may come to be near by a small
// move. For feature_contacts.cc alone.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <optional>
#include <span>

#include "tool_renderers/feature_contacts.h"

namespace touchstone::tool_renderers {

// Rounding of directions, and of places relative to the size of a triangle.
inline constexpr double slack = 1e-9;
// Edges that are closer to parallel than this have no normal of their own; their ends touch faces.
inline constexpr double parallel = 1e-6;

struct Corners {
  const Vec3 &a, &b, &c;
};

inline bool above_triangle(const Corners& t, const Vec3& n, const Vec3& p) {
  const auto beside = [&](const Vec3& from, const Vec3& to) {
    const Vec3 along = to - from;
    return along.cross(p - from).dot(n) < -slack * along.squaredNorm();
  };
  return !beside(t.a, t.b) && !beside(t.b, t.c) && !beside(t.c, t.a);
}

class Collector {
 public:
  Collector(double margin_m, double overlap_m, double unit_m, std::span<NearPair> pairs)
      : margin_m_(margin_m), overlap_m_(overlap_m), nearest_(nearest_m / unit_m), pairs_(pairs) {}

  // A vertex that is nearer to an edge has no direction from it.
  [[nodiscard]] double nearest() const { return nearest_; }

  [[nodiscard]] bool wants(double gap) const { return gap <= margin_m_ && gap >= -overlap_m_; }
  void add(const NearPair& pair) {
    if (count_ < pairs_.size()) {
      pairs_[count_++] = pair;
      return;
    }
    const auto largest = std::max_element(pairs_.begin(), pairs_.end(),
                                          [](const NearPair& a, const NearPair& b) { return a.gap_m < b.gap_m; });
    if (pair.gap_m < largest->gap_m) *largest = pair;
  }
  [[nodiscard]] std::size_t count() const { return count_; }

 private:
  static constexpr double nearest_m = 1e-7;

  double margin_m_;
  double overlap_m_;
  double nearest_;
  std::span<NearPair> pairs_;
  std::size_t count_ = 0;
};

inline Corners corners_of(const FeatureMesh& mesh, std::int32_t t) {
  const auto& [a, b, c] = mesh.mesh().triangles[surface::at(t)];
  return {mesh.vertex(a), mesh.vertex(b), mesh.vertex(c)};
}

// In line: Eigen calls a function for this product.
inline Vec3 turned(const Mat3& r, const Vec3& v) {
  return {r(0, 0) * v.x() + r(0, 1) * v.y() + r(0, 2) * v.z(), r(1, 0) * v.x() + r(1, 1) * v.y() + r(1, 2) * v.z(),
          r(2, 0) * v.x() + r(2, 1) * v.y() + r(2, 2) * v.z()};
}

inline bool apart(const Vec3& a, double radius_a, const Vec3& b, double radius_b, double reach) {
  const double touch = radius_a + radius_b + reach;
  return (a - b).squaredNorm() > touch * touch;
}

// A vertex at v beside the ridge edge from a to b, in the wedge outside of both of its faces: from the nearest point of
// the edge to v. Not where they meet: the direction is lost there, and edge pairs or faces hold.
inline std::optional<Vec3> beside_edge(const Vec3& v, const Vec3& a, const Vec3& b, const FeatureMesh::Edge& edge,
                                       double nearest) {
  const Vec3 along = b - a;
  const double share = (v - a).dot(along) / along.squaredNorm();
  if (!(share >= 0.0 && share <= 1.0)) return {};
  const Vec3 away = v - (a + share * along);
  if (away.dot(edge.inward[0]) > 0.0 || away.dot(edge.inward[1]) > 0.0 || !(away.norm() > nearest)) return {};
  return away;
}

// One question: where the tool is, and its triangles and the object's there.
class NearPairFinder::Asked {
 public:
  // Where the features of two triangles stand among the bits of Features: a vertex of the tool's and the object's face,
  // or its edges (3 for each vertex); a vertex of the object's likewise; edges of both (3 of the tool's for each).
  static constexpr unsigned vertex_face = 0, vertex_edge = 3, face_vertex = 12, edge_vertex = 15, edge_edge = 24;
  static constexpr Features all_features = (Features(1) << 33U) - 1;
  static bool has(Features features, unsigned bit) { return ((features >> bit) & 1U) != 0; }
  // A bit, or one of three.
  static bool any(Features features, unsigned bit, unsigned three) {
    return has(features, bit) || ((features >> three) & 7U) != 0;
  }

  Asked(NearPairFinder& finder, const tool::Pose& pose, const Mat3& rotation)
      : tool_(finder.tool_),
        object_(finder.object_),
        tool_W_(finder.tool_W_),
        object_T_(finder.object_T_),
        pose_(pose),
        rotation_(rotation),
        question_(++finder.question_) {}

  Bounds bounds(std::int32_t s, std::int32_t t) {
    turn(s);
    const FeatureMesh::Face& on_tool = tool_.face(s);
    const FeatureMesh::Face& on_object = object_.face(t);
    const auto& corners = object_.mesh().triangles[surface::at(t)];
    const Vec3& origin = object_.vertex(corners[0]);
    const Vec3 tool_origin = corners_W_[0];
    double low = 0.0, high = 0.0, low_T = 0.0, high_T = 0.0;
    for (std::size_t k = 0; k < 3; ++k) {
      const double h = dot(on_object.n, corners_W_[k] - origin);
      const double g = dot(n_W_, object_.vertex(corners[k]) - tool_origin);
      low = k == 0 ? h : std::min(low, h);
      high = k == 0 ? h : std::max(high, h);
      low_T = k == 0 ? g : std::min(low_T, g);
      high_T = k == 0 ? g : std::max(high_T, g);
    }
    const double balls = (center_W_ - on_object.ball.center).norm() - on_tool.ball.radius - on_object.ball.radius;
    return {std::max({balls, low, -high, low_T, -high_T}), on_object.blunt ? low : -1.0, on_tool.blunt ? low_T : -1.0};
  }

  // Of those features alone.
  void pairs(std::int32_t s, std::int32_t t, Features features, double reach, Collector& collector) {
    turn(s);
    const FeatureMesh::Face& on_tool = tool_.face(s);
    const FeatureMesh::Face& on_object = object_.face(t);
    const Corners object_corners = corners_of(object_, t);
    const Corners tool_corners = corners_of(tool_, s);
    for (unsigned k = 0; k < 3; ++k) {
      const std::int32_t v = on_tool.vertices[k];
      if (v < 0 || !any(features, vertex_face + k, vertex_edge + 3 * k)) continue;
      const Vec3& p = tool_W(v);
      const double gap = on_object.n.dot(p - object_corners.a);
      if (has(features, vertex_face + k) && collector.wants(gap) && above_triangle(object_corners, on_object.n, p))
        collector.add({p, on_object.n, gap});
      for (unsigned j = 0; j < 3; ++j) {
        const std::int32_t f = on_object.edges[j];
        if (f < 0 || !has(features, vertex_edge + 3 * k + j)) continue;
        const FeatureMesh::Edge& edge = object_.edge(f);
        if (apart(p, 0.0, edge.ball.center, edge.ball.radius, reach)) continue;
        const auto away =
            beside_edge(p, object_.vertex(edge.ends[0]), object_.vertex(edge.ends[1]), edge, collector.nearest());
        if (away && collector.wants(away->norm())) collector.add({p, away->normalized(), away->norm()});
      }
    }
    // In the tool's frame: one point turns instead of three.
    for (unsigned k = 0; k < 3; ++k) {
      const std::int32_t v = on_object.vertices[k];
      if (v < 0 || !any(features, face_vertex + k, edge_vertex + 3 * k)) continue;
      const Vec3& p_T = object_T(v);
      const double gap = on_tool.n.dot(p_T - tool_corners.a);
      if (has(features, face_vertex + k) && collector.wants(gap) && above_triangle(tool_corners, on_tool.n, p_T))
        collector.add({object_.vertex(v), -n_W_, gap});
      for (unsigned j = 0; j < 3; ++j) {
        const std::int32_t e = on_tool.edges[j];
        if (e < 0 || !has(features, edge_vertex + 3 * k + j)) continue;
        const FeatureMesh::Edge& edge = tool_.edge(e);
        if (apart(p_T, 0.0, edge.ball.center, edge.ball.radius, reach)) continue;
        const auto away =
            beside_edge(p_T, tool_.vertex(edge.ends[0]), tool_.vertex(edge.ends[1]), edge, collector.nearest());
        if (away && collector.wants(away->norm()))
          collector.add({pose_.p_W_m + rotation_ * (p_T - *away), -(rotation_ * away->normalized()), away->norm()});
      }
    }
    for (unsigned k = 0; k < 3; ++k) {
      if (on_object.edges[k] < 0) continue;
      for (unsigned j = 0; j < 3; ++j) {
        if (on_tool.edges[j] >= 0 && has(features, edge_edge + 3 * k + j))
          edge_pair(tool_.edge(on_tool.edges[j]), object_.edge(on_object.edges[k]), reach, collector);
      }
    }
  }

  // Features of the pair that can be near after a move of no more than loose.way_m: each test of pairs() with what it
  // can change by.
  Features may_be_near(std::int32_t s, std::int32_t t, const Loose& loose) {
    turn(s);
    const FeatureMesh::Face& on_tool = tool_.face(s);
    const FeatureMesh::Face& on_object = object_.face(t);
    const Corners object_corners = corners_of(object_, t);
    const Corners tool_corners = corners_of(tool_, s);
    Features features = 0;
    const auto set = [&](unsigned bit, bool may) { features |= Features(may ? 1 : 0) << bit; };
    for (unsigned k = 0; k < 3; ++k) {
      const std::int32_t v = on_tool.vertices[k];
      if (v < 0) continue;
      const Vec3& p = tool_W(v);
      set(vertex_face + k, may_be_above(object_corners, on_object.n, p, loose.way_m, loose));
      for (unsigned j = 0; j < 3; ++j) {
        if (on_object.edges[j] < 0) continue;
        const FeatureMesh::Edge& edge = object_.edge(on_object.edges[j]);
        set(vertex_edge + 3 * k + j,
            may_be_beside(p, object_.vertex(edge.ends[0]), object_.vertex(edge.ends[1]), edge, loose.way_m, loose));
      }
    }
    for (unsigned k = 0; k < 3; ++k) {
      const std::int32_t v = on_object.vertices[k];
      if (v < 0) continue;
      const Vec3& p_T = object_T(v);
      // A point of the object that is farther from the tool's origin moves against it by more.
      const double way_m = loose.way_m * std::max(1.0, (p_T.norm() + loose.way_m) / loose.lever_m);
      set(face_vertex + k, may_be_above(tool_corners, on_tool.n, p_T, way_m, loose));
      for (unsigned j = 0; j < 3; ++j) {
        if (on_tool.edges[j] < 0) continue;
        const FeatureMesh::Edge& edge = tool_.edge(on_tool.edges[j]);
        set(edge_vertex + 3 * k + j,
            may_be_beside(p_T, tool_.vertex(edge.ends[0]), tool_.vertex(edge.ends[1]), edge, way_m, loose));
      }
    }
    for (unsigned k = 0; k < 3; ++k) {
      if (on_object.edges[k] < 0) continue;
      for (unsigned j = 0; j < 3; ++j) {
        if (on_tool.edges[j] >= 0)
          set(edge_edge + 3 * k + j,
              may_be_edge_pair(tool_.edge(on_tool.edges[j]), object_.edge(on_object.edges[k]), loose));
      }
    }
    return features;
  }

 private:
  void edge_pair(const FeatureMesh::Edge& on_tool, const FeatureMesh::Edge& on_object, double reach,
                 Collector& collector) {
    const Vec3& a = tool_W(on_tool.ends[0]);
    const Vec3& end = tool_W(on_tool.ends[1]);
    if (apart(0.5 * (a + end), on_tool.ball.radius, on_object.ball.center, on_object.ball.radius, reach)) return;
    const Vec3 u = end - a;
    const Vec3& b = object_.vertex(on_object.ends[0]);
    const Vec3 v = object_.vertex(on_object.ends[1]) - b;
    Vec3 n = u.cross(v);
    const double square = n.squaredNorm();
    if (square <= parallel * parallel * u.squaredNorm() * v.squaredNorm()) return;
    // The lines' common perpendicular: its feet at a + s u and b + t v.
    const Vec3 between = b - a;
    const double s = between.cross(v).dot(n) / square;
    const double t = between.cross(u).dot(n) / square;
    if (s < -slack || s > 1.0 + slack || t < -slack || t > 1.0 + slack) return;
    n /= std::sqrt(square);
    if (n.dot(on_object.outward) < 0.0) n = -n;
    const double gap = -n.dot(between);
    if (!collector.wants(gap)) return;
    for (int k = 0; k < 2; ++k) {
      const auto i = static_cast<std::size_t>(k);
      if (n.dot(on_object.inward[i]) > slack || n.dot(rotation_ * on_tool.inward[i]) < -slack) return;
    }
    collector.add({a + s * u, n, gap});
  }

  static bool may_be_above(const Corners& corners, const Vec3& n, const Vec3& p, double way_m, const Loose& loose) {
    const double gap = n.dot(p - corners.a);
    if (gap > loose.margin_m + way_m || gap < -loose.overlap_m - way_m) return false;
    const auto beside = [&](const Vec3& from, const Vec3& to) {
      const Vec3 along = to - from;
      const double square = along.squaredNorm();
      return along.cross(p - from).dot(n) < -slack * square - std::sqrt(square) * way_m;
    };
    return !beside(corners.a, corners.b) && !beside(corners.b, corners.c) && !beside(corners.c, corners.a);
  }
  static bool may_be_beside(const Vec3& p, const Vec3& a, const Vec3& b, const FeatureMesh::Edge& edge, double way_m,
                            const Loose& loose) {
    const Vec3 along = b - a;
    const double square = along.squaredNorm();
    const double share = (p - a).dot(along) / square;
    const double more = way_m / std::sqrt(square);
    if (share < -more || share > 1.0 + more) return false;
    const Vec3 away = p - (a + share * along);
    const double farthest = loose.margin_m + way_m;
    return away.dot(edge.inward[0]) <= way_m && away.dot(edge.inward[1]) <= way_m &&
           away.squaredNorm() <= farthest * farthest;
  }
  // The tool's edge u turns by no more than `turn`, which the common normal n follows by an angle of at most
  // asin(sin turn / sin of the angle between u and the object's edge v). Two points of the edges that come to be the
  // feet of the common perpendicular are at most reach + way apart before; of the way between them along n and across
  // it no more can change than `shift`.
  bool may_be_edge_pair(const FeatureMesh::Edge& on_tool, const FeatureMesh::Edge& on_object, const Loose& loose) {
    const double reach = std::max(loose.margin_m, loose.overlap_m);
    const Vec3& a = tool_W(on_tool.ends[0]);
    const Vec3& end = tool_W(on_tool.ends[1]);
    if (apart(0.5 * (a + end), on_tool.ball.radius, on_object.ball.center, on_object.ball.radius, reach + loose.way_m))
      return false;
    const Vec3 u = end - a;
    const Vec3& b = object_.vertex(on_object.ends[0]);
    const Vec3 v = object_.vertex(on_object.ends[1]) - b;
    Vec3 n = u.cross(v);
    const double square = n.squaredNorm();
    const double u_length = u.norm();
    const double v_length = v.norm();
    const double sine = std::sqrt(square) / (u_length * v_length);
    const double turn = loose.way_m / loose.lever_m;
    constexpr double nearly_parallel = 4.0;  // turns: what follows is for angles well above them
    if (!(sine > nearly_parallel * turn)) return true;
    // asin(x) <= pi / 3 x for x <= 1 / 2.
    const double lean = std::numbers::pi / 3.0 * turn / sine;
    n /= std::sqrt(square);
    const double outward = n.dot(on_object.outward);
    if (std::abs(outward) <= lean * on_object.outward.norm()) return true;  // which side it is on can change
    if (outward < 0.0) n = -n;
    const double shift = loose.way_m + lean * reach;
    const Vec3 between = b - a;
    const double gap = -n.dot(between);
    if (gap > loose.margin_m + shift || gap < -loose.overlap_m - shift) return false;
    const Vec3 cross = u.cross(v);
    const double s = between.cross(v).dot(cross) / square;
    const double t = between.cross(u).dot(cross) / square;
    const double more_s = slack + shift / (sine * u_length);
    const double more_t = slack + shift / (sine * v_length);
    if (!(s >= -more_s && s <= 1.0 + more_s && t >= -more_t && t <= 1.0 + more_t)) return false;
    for (int k = 0; k < 2; ++k) {
      const auto i = static_cast<std::size_t>(k);
      if (n.dot(on_object.inward[i]) > slack + lean || n.dot(rotation_ * on_tool.inward[i]) < -slack - lean - turn)
        return false;
    }
    return true;
  }

  const Vec3& tool_W(std::int32_t v) {
    Vec3& p = tool_W_.points[surface::at(v)];
    if (tool_W_.question[surface::at(v)] != question_) {
      tool_W_.question[surface::at(v)] = question_;
      p = pose_.p_W_m + rotation_ * tool_.vertex(v);
    }
    return p;
  }
  const Vec3& object_T(std::int32_t v) {
    Vec3& p = object_T_.points[surface::at(v)];
    if (object_T_.question[surface::at(v)] != question_) {
      object_T_.question[surface::at(v)] = question_;
      p = rotation_.transpose() * (object_.vertex(v) - pose_.p_W_m);
    }
    return p;
  }
  // The tool's triangle s, which comes many times in a row.
  void turn(std::int32_t s) {
    if (s == turned_) return;
    turned_ = s;
    const FeatureMesh::Face& face = tool_.face(s);
    n_W_ = rotation_ * face.n;
    center_W_ = pose_.p_W_m + turned(rotation_, face.ball.center);
    const auto& corners = tool_.mesh().triangles[surface::at(s)];
    for (std::size_t k = 0; k < 3; ++k) corners_W_[k] = tool_W(corners[k]);
  }

  const FeatureMesh& tool_;
  const FeatureMesh& object_;
  Turned& tool_W_;
  Turned& object_T_;
  const tool::Pose& pose_;
  const Mat3& rotation_;
  std::uint64_t question_;
  std::int32_t turned_ = -1;
  Vec3 n_W_ = Vec3::Zero(), center_W_ = Vec3::Zero();
  std::array<Vec3, 3> corners_W_;
};

}  // namespace touchstone::tool_renderers
