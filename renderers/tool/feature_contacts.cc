#include "renderers/tool/feature_contacts.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace touchstone::renderers {
namespace {

std::vector<Ball> triangle_balls(const TriangleMesh& mesh) {
  std::vector<Ball> balls;
  balls.reserve(mesh.triangle_count());
  for (const auto& t : mesh.triangles) {
    Box3 box;
    for (const std::int32_t v : t) box.extend(mesh.vertices_W_m[at(v)]);
    // The circle about the middle of the longest edge, or the box's centre: whichever is smaller.
    Ball best;
    for (int k = 0; k < 4; ++k) {
      const auto corner = [&](int i) -> const Vec3& {
        return mesh.vertices_W_m[at(t[static_cast<std::size_t>(i % 3)])];
      };
      Ball ball{k == 3 ? Vec3(box.center()) : Vec3(0.5 * (corner(k) + corner(k + 1))), 0.0};
      for (int i = 0; i < 3; ++i) ball.radius = std::max(ball.radius, (corner(i) - ball.center).norm());
      if (k == 0 || ball.radius < best.radius) best = ball;
    }
    balls.push_back(best);
  }
  return balls;
}

// What a triangle owns that can touch (tags of the tree).
constexpr std::uint8_t kHasVertex = 1;
constexpr std::uint8_t kHasEdge = 2;

// Nothing can touch where both sides are only faces, or a face and edges.
bool can_touch(std::uint8_t tool_tags, std::uint8_t object_tags) {
  return ((tool_tags | object_tags) & kHasVertex) != 0 || (tool_tags & object_tags & kHasEdge) != 0;
}

// Rounding of directions, and of places relative to the size of a triangle.
constexpr double kSlack = 1e-9;
// Edges that are closer to parallel than this have no normal of their own; their ends touch faces.
constexpr double kParallel = 1e-6;

struct Corners {
  const Vec3 &a, &b, &c;
};

// How far pairs may be apart that are asked for.
struct Range {
  double reach;  // the larger of margin and overlap
  // Above a face that is blunt: there, what is farther than the margin can only touch by an overlap, and that lies
  // below. A little more, for rounding.
  double above_blunt;
};

Range range_of(double margin_m, double overlap_m) {
  constexpr double kRounding = 1e-6;
  return {std::max(margin_m, overlap_m), margin_m + kRounding * (margin_m + overlap_m)};
}

// All three corners more than `above` above the plane n . x = d, or all more than `below` below it.
bool far_from_plane(const Corners& t, const Vec3& n, double d, double above, double below) {
  const double a = dot(n, t.a) - d, b = dot(n, t.b) - d, c = dot(n, t.c) - d;
  return (a > above && b > above && c > above) || (a < -below && b < -below && c < -below);
}

bool above_triangle(const Corners& t, const Vec3& n, const Vec3& p) {
  const auto beside = [&](const Vec3& from, const Vec3& to) {
    const Vec3 along = to - from;
    return along.cross(p - from).dot(n) < -kSlack * along.squaredNorm();
  };
  return !beside(t.a, t.b) && !beside(t.b, t.c) && !beside(t.c, t.a);
}

class Collector {
 public:
  Collector(double margin_m, double overlap_m, double unit_m, std::span<NearPair> pairs)
      : margin_m_(margin_m), overlap_m_(overlap_m), nearest_(kNearest_m / unit_m), pairs_(pairs) {}

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
  static constexpr double kNearest_m = 1e-7;

  double margin_m_;
  double overlap_m_;
  double nearest_;
  std::span<NearPair> pairs_;
  std::size_t count_ = 0;
};

}  // namespace

FeatureMesh::FeatureMesh(TriangleMesh mesh) : mesh_(std::move(mesh)), tree_(triangle_balls(mesh_)) {
  const MeshTopology topology = make_topology(mesh_);
  std::vector<unsigned char> sticks_out(mesh_.vertices_W_m.size(), 0);
  for (std::size_t t = 0; t < mesh_.triangle_count(); ++t) {
    for (std::size_t e = 0; e < 3; ++e) {
      if (topology.convexity[t][e] != Convexity::ridge) continue;
      sticks_out[at(mesh_.triangles[t][e])] = sticks_out[at(mesh_.triangles[t][(e + 1) % 3])] = 1;
    }
  }
  std::vector<unsigned char> owned(mesh_.vertices_W_m.size(), 0);
  faces_.resize(mesh_.triangle_count());
  for (std::size_t t = 0; t < mesh_.triangle_count(); ++t) {
    Face& face = faces_[t];
    face.n = topology.face_normals[t];
    face.vertices.fill(-1);
    face.edges.fill(-1);
    for (std::size_t e = 0; e < 3; ++e) {
      const std::int32_t v = mesh_.triangles[t][e];
      if (sticks_out[at(v)] != 0 && owned[at(v)] == 0) {
        owned[at(v)] = 1;
        face.vertices[e] = v;
      }
      const std::int32_t beside = topology.neighbours[t][e];
      if (topology.convexity[t][e] != Convexity::ridge || beside < static_cast<std::int32_t>(t)) continue;
      Edge edge;
      edge.ends = {v, mesh_.triangles[t][(e + 1) % 3]};
      const Vec3 along = (vertex(edge.ends[1]) - vertex(edge.ends[0])).normalized();
      const Vec3& other = topology.face_normals[at(beside)];
      edge.outward = face.n + other;
      edge.inward = {face.n.cross(along), along.cross(other)};
      face.blunt = face.blunt && face.n.dot(other) >= 0.0;
      face.edges[e] = static_cast<std::int32_t>(edges_.size());
      edges_.push_back(edge);
    }
  }
  const std::vector<Ball> balls = triangle_balls(mesh_);
  std::vector<std::uint8_t> tags(faces_.size(), 0);
  for (std::size_t t = 0; t < faces_.size(); ++t) {
    faces_[t].ball = balls[t];
    const auto any = [](const std::array<std::int32_t, 3>& owned_features) {
      return std::ranges::any_of(owned_features, [](std::int32_t i) { return i >= 0; });
    };
    tags[t] =
        static_cast<std::uint8_t>((any(faces_[t].vertices) ? kHasVertex : 0) | (any(faces_[t].edges) ? kHasEdge : 0));
  }
  tree_.tag(tags);
  for (const Vec3& v : mesh_.vertices_W_m) reach_m_ = std::max(reach_m_, v.norm());
}

std::size_t FeatureMesh::memory_bytes() const noexcept {
  return mesh_.vertices_W_m.capacity() * sizeof(Vec3) + mesh_.triangles.capacity() * sizeof(mesh_.triangles[0]) +
         faces_.capacity() * sizeof(Face) + edges_.capacity() * sizeof(Edge) + tree_.memory_bytes();
}

namespace {

Corners corners_of(const FeatureMesh& mesh, std::int32_t t) {
  const auto& [a, b, c] = mesh.mesh().triangles[at(t)];
  return {mesh.vertex(a), mesh.vertex(b), mesh.vertex(c)};
}

void edge_pair(const FeatureMesh& tool, const FeatureMesh::Edge& on_tool, const FeatureMesh& object,
               const FeatureMesh::Edge& on_object, const Pose& pose, const Mat3& rotation, Collector& collector) {
  const Vec3 a = pose.p_W_m + rotation * tool.vertex(on_tool.ends[0]);
  const Vec3 u = pose.p_W_m + rotation * tool.vertex(on_tool.ends[1]) - a;
  const Vec3& b = object.vertex(on_object.ends[0]);
  const Vec3 v = object.vertex(on_object.ends[1]) - b;
  Vec3 n = u.cross(v);
  const double square = n.squaredNorm();
  if (square <= kParallel * kParallel * u.squaredNorm() * v.squaredNorm()) return;
  // The lines' common perpendicular: its feet at a + s u and b + t v.
  const Vec3 between = b - a;
  const double s = between.cross(v).dot(n) / square;
  const double t = between.cross(u).dot(n) / square;
  if (s < -kSlack || s > 1.0 + kSlack || t < -kSlack || t > 1.0 + kSlack) return;
  n /= std::sqrt(square);
  if (n.dot(on_object.outward) < 0.0) n = -n;
  const double gap = -n.dot(between);
  if (!collector.wants(gap)) return;
  for (int k = 0; k < 2; ++k) {
    const auto i = static_cast<std::size_t>(k);
    if (n.dot(on_object.inward[i]) > kSlack || n.dot(rotation * on_tool.inward[i]) < -kSlack) return;
  }
  collector.add({a + s * u, n, gap});
}

// A vertex at v beside the ridge edge from a to b, in the wedge outside of both of its faces: from the nearest point of
// the edge to v. Not where they meet: the direction is lost there, and edge pairs or faces hold.
std::optional<Vec3> beside_edge(const Vec3& v, const Vec3& a, const Vec3& b, const FeatureMesh::Edge& edge,
                                double nearest) {
  const Vec3 along = b - a;
  const double share = (v - a).dot(along) / along.squaredNorm();
  if (!(share >= 0.0 && share <= 1.0)) return {};
  const Vec3 away = v - (a + share * along);
  if (away.dot(edge.inward[0]) > 0.0 || away.dot(edge.inward[1]) > 0.0 || !(away.norm() > nearest)) return {};
  return away;
}

// No pair of these two triangles is in the range: every pair spans from a point of one triangle to a point of the
// other, so that neither is farther from the other's plane. The object's plane in T, and the tool's in W.
bool apart(const FeatureMesh& tool, std::int32_t s, const FeatureMesh& object, std::int32_t t, const Pose& pose,
           const Mat3& rotation, const Range& range) {
  const Corners tool_corners = corners_of(tool, s);
  const Corners object_corners = corners_of(object, t);
  const FeatureMesh::Face& on_object = object.face(t);
  const auto above = [&](const FeatureMesh::Face& face) { return face.blunt ? range.above_blunt : range.reach; };
  if (far_from_plane(tool_corners, rotation.transpose() * on_object.n, dot(on_object.n, object_corners.a - pose.p_W_m),
                     above(on_object), range.reach))
    return true;
  const FeatureMesh::Face& on_tool = tool.face(s);
  const Vec3 tool_n_W = rotation * on_tool.n;
  return far_from_plane(object_corners, tool_n_W, dot(on_tool.n, tool_corners.a) + dot(tool_n_W, pose.p_W_m),
                        above(on_tool), range.reach);
}

double between_balls(const FeatureMesh& tool, std::int32_t s, const FeatureMesh& object, std::int32_t t,
                     const Pose& pose, const Mat3& rotation) {
  const Ball& a = tool.face(s).ball;
  const Ball& b = object.face(t).ball;
  return (pose.p_W_m + rotation * a.center - b.center).norm() - a.radius - b.radius;
}

void triangle_pair(const FeatureMesh& tool, std::int32_t s, const FeatureMesh& object, std::int32_t t, const Pose& pose,
                   const Mat3& rotation, Collector& collector) {
  const FeatureMesh::Face& on_tool = tool.face(s);
  const FeatureMesh::Face& on_object = object.face(t);
  const Corners object_corners = corners_of(object, t);
  const Corners tool_corners = corners_of(tool, s);
  const Vec3 tool_n_W = rotation * on_tool.n;
  for (const std::int32_t v : on_tool.vertices) {
    if (v < 0) continue;
    const Vec3 p = pose.p_W_m + rotation * tool.vertex(v);
    const double gap = on_object.n.dot(p - object_corners.a);
    if (collector.wants(gap) && above_triangle(object_corners, on_object.n, p)) collector.add({p, on_object.n, gap});
    for (const std::int32_t f : on_object.edges) {
      if (f < 0) continue;
      const FeatureMesh::Edge& edge = object.edge(f);
      const auto away =
          beside_edge(p, object.vertex(edge.ends[0]), object.vertex(edge.ends[1]), edge, collector.nearest());
      if (away && collector.wants(away->norm())) collector.add({p, away->normalized(), away->norm()});
    }
  }
  // In the tool's frame: one point turns instead of three.
  for (const std::int32_t v : on_object.vertices) {
    if (v < 0) continue;
    const Vec3 p_T = rotation.transpose() * (object.vertex(v) - pose.p_W_m);
    const double gap = on_tool.n.dot(p_T - tool_corners.a);
    if (collector.wants(gap) && above_triangle(tool_corners, on_tool.n, p_T))
      collector.add({object.vertex(v), -tool_n_W, gap});
    for (const std::int32_t e : on_tool.edges) {
      if (e < 0) continue;
      const FeatureMesh::Edge& edge = tool.edge(e);
      const auto away =
          beside_edge(p_T, tool.vertex(edge.ends[0]), tool.vertex(edge.ends[1]), edge, collector.nearest());
      if (away && collector.wants(away->norm()))
        collector.add({pose.p_W_m + rotation * (p_T - *away), -(rotation * away->normalized()), away->norm()});
    }
  }
  for (const std::int32_t f : on_object.edges) {
    if (f < 0) continue;
    for (const std::int32_t e : on_tool.edges) {
      if (e >= 0) edge_pair(tool, tool.edge(e), object, object.edge(f), pose, rotation, collector);
    }
  }
}

}  // namespace

namespace {

// The pairs of triangles of which one comes within `reach` of the other's plane, in the order of the trees.
template <typename Found>
void visit_near(const FeatureMesh& tool, const FeatureMesh& object, const Pose& pose, const Mat3& rotation,
                double reach, Found&& found) {
  struct Open {  // NOLINT(cppcoreguidelines-pro-type-member-init): written before it is read
    std::int32_t a, b;
  };
  std::array<Open, 2 * SphereTree::kDepth> stack;  // NOLINT(cppcoreguidelines-pro-type-member-init)
  std::size_t size = 0;
  stack[size++] = {0, 0};
  while (size > 0) {
    const Open open = stack[--size];
    const SphereTree::Node& a = tool.tree().node(open.a);
    const SphereTree::Node& b = object.tree().node(open.b);
    if (!can_touch(a.tags, b.tags)) continue;
    const double touch = a.ball.radius + b.ball.radius + reach;
    if ((pose.p_W_m + rotation * a.ball.center - b.ball.center).squaredNorm() > touch * touch) continue;
    if (a.child < 0 && b.child < 0) {
      if (!apart(tool, a.item, object, b.item, pose, rotation, {reach, reach})) found(a.item, b.item);
    } else if (b.child < 0 || (a.child >= 0 && a.ball.radius >= b.ball.radius)) {
      stack[size++] = {a.child + 1, open.b};
      stack[size++] = {a.child, open.b};
    } else {
      stack[size++] = {open.a, b.child + 1};
      stack[size++] = {open.a, b.child};
    }
  }
}

}  // namespace

namespace {

// Of all of the tool's triangle above the object's plane, where the object's face is blunt.
double above_face(const FeatureMesh& tool, std::int32_t s, const FeatureMesh& object, std::int32_t t, const Pose& pose,
                  const Mat3& rotation) {
  const FeatureMesh::Face& face = object.face(t);
  if (!face.blunt) return -1.0;
  const Corners corners = corners_of(tool, s);
  const Vec3 n_T = rotation.transpose() * face.n;
  return std::min({dot(n_T, corners.a), dot(n_T, corners.b), dot(n_T, corners.c)}) -
         dot(face.n, corners_of(object, t).a - pose.p_W_m);
}

// A number of single precision that is not above the value.
float rounded_down(double value) {
  constexpr double kShare = 1e-6;
  return static_cast<float>(value - kShare * std::abs(value));
}

}  // namespace

NearPairFinder::NearPairFinder(const FeatureMesh& tool, const FeatureMesh& object, double unit_m)
    : tool_(tool), object_(object), unit_m_(unit_m) {
  // More are not kept: the trees are then visited for each question.
  constexpr std::size_t kMostCandidates = 16384;
  candidates_.reserve(kMostCandidates);
}

std::size_t NearPairFinder::find(const Pose& pose, double margin_m, double overlap_m,
                                 std::span<NearPair> pairs) noexcept {
  // How far the tool may move before the trees are visited again. More of it lengthens the list.
  constexpr double kSpare_m = 0.3e-3;
  Collector collector(margin_m, overlap_m, unit_m_, pairs);
  const Mat3 rotation = pose.q_WT.toRotationMatrix();
  const double reach = std::max(margin_m, overlap_m);
  // No point of the tool has moved farther: a turn moves a point by no more than its angle times the point's distance.
  const Displacement since = displacement(listed_at_, pose);
  const double moved_m = since.translation_m.norm() + tool_.reach_m() * since.rotation_rad.norm();
  const Range range = range_of(margin_m, overlap_m);
  const auto ask = [&](std::int32_t s, std::int32_t t) {
    if (!apart(tool_, s, object_, t, pose, rotation, range))
      triangle_pair(tool_, s, object_, t, pose, rotation, collector);
  };
  if (!(reach + moved_m <= listed_reach_m_)) {
    // Asked and listed in one visit; a list that does not hold all is none.
    const double listed_reach_m = reach + kSpare_m / unit_m_;
    candidates_.clear();
    bool whole = true;
    visit_near(tool_, object_, pose, rotation, listed_reach_m, [&](std::int32_t s, std::int32_t t) {
      ask(s, t);
      if (candidates_.size() < candidates_.capacity()) {
        candidates_.push_back({s, t, rounded_down(between_balls(tool_, s, object_, t, pose, rotation)),
                               rounded_down(above_face(tool_, s, object_, t, pose, rotation))});
      } else {
        whole = false;
      }
    });
    listed_at_ = pose;
    listed_reach_m_ = whole ? listed_reach_m : -1.0;
    return collector.count();
  }
  // The tool's points have come nearer by no more than they moved: most of the list is passed over by these alone.
  const double still_apart = reach + moved_m;
  const double still_above = range.above_blunt + moved_m;
  std::int32_t turned = -1;  // the tool's triangle whose ball is turned into W already
  Vec3 center_W = Vec3::Zero();
  for (const TrianglePair& near : candidates_) {
    if (double(near.apart_m) > still_apart || double(near.above_m) > still_above) continue;
    const Ball& a = tool_.face(near.on_tool).ball;
    const Ball& b = object_.face(near.on_object).ball;
    if (near.on_tool != turned) {
      turned = near.on_tool;
      center_W = pose.p_W_m + rotation * a.center;
    }
    const double touch = a.radius + b.radius + reach;
    if ((center_W - b.center).squaredNorm() > touch * touch) continue;
    ask(near.on_tool, near.on_object);
  }
  return collector.count();
}

}  // namespace touchstone::renderers
