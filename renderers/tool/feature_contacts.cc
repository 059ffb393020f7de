#include "renderers/tool/feature_contacts.h"

#include <algorithm>
#include <cmath>
#include <limits>
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
      edge.ball = {0.5 * (vertex(edge.ends[0]) + vertex(edge.ends[1])),
                   0.5 * (vertex(edge.ends[1]) - vertex(edge.ends[0])).norm()};
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

// In line: Eigen calls a function for this product.
inline Vec3 turned(const Mat3& r, const Vec3& v) {
  return {r(0, 0) * v.x() + r(0, 1) * v.y() + r(0, 2) * v.z(), r(1, 0) * v.x() + r(1, 1) * v.y() + r(1, 2) * v.z(),
          r(2, 0) * v.x() + r(2, 1) * v.y() + r(2, 2) * v.z()};
}

bool apart(const Vec3& a, double radius_a, const Vec3& b, double radius_b, double reach) {
  const double touch = radius_a + radius_b + reach;
  return (a - b).squaredNorm() > touch * touch;
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

// A number of single precision that is not above, or not below, the value.
constexpr double kSingle = 1e-6;
float rounded_down(double value) { return static_cast<float>(value - kSingle * std::abs(value)); }
float rounded_up(double value) { return static_cast<float>(value + kSingle * std::abs(value)); }

}  // namespace

// One question: where the tool is, and its triangles and the object's there.
class NearPairFinder::Asked {
 public:
  Asked(NearPairFinder& finder, const Pose& pose, const Mat3& rotation)
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
    const auto& corners = object_.mesh().triangles[at(t)];
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

  void pairs(std::int32_t s, std::int32_t t, double reach, Collector& collector) {
    turn(s);
    const FeatureMesh::Face& on_tool = tool_.face(s);
    const FeatureMesh::Face& on_object = object_.face(t);
    const Corners object_corners = corners_of(object_, t);
    const Corners tool_corners = corners_of(tool_, s);
    for (const std::int32_t v : on_tool.vertices) {
      if (v < 0) continue;
      const Vec3& p = tool_W(v);
      const double gap = on_object.n.dot(p - object_corners.a);
      if (collector.wants(gap) && above_triangle(object_corners, on_object.n, p)) collector.add({p, on_object.n, gap});
      for (const std::int32_t f : on_object.edges) {
        if (f < 0) continue;
        const FeatureMesh::Edge& edge = object_.edge(f);
        if (apart(p, 0.0, edge.ball.center, edge.ball.radius, reach)) continue;
        const auto away =
            beside_edge(p, object_.vertex(edge.ends[0]), object_.vertex(edge.ends[1]), edge, collector.nearest());
        if (away && collector.wants(away->norm())) collector.add({p, away->normalized(), away->norm()});
      }
    }
    // In the tool's frame: one point turns instead of three.
    for (const std::int32_t v : on_object.vertices) {
      if (v < 0) continue;
      const Vec3& p_T = object_T(v);
      const double gap = on_tool.n.dot(p_T - tool_corners.a);
      if (collector.wants(gap) && above_triangle(tool_corners, on_tool.n, p_T))
        collector.add({object_.vertex(v), -n_W_, gap});
      for (const std::int32_t e : on_tool.edges) {
        if (e < 0) continue;
        const FeatureMesh::Edge& edge = tool_.edge(e);
        if (apart(p_T, 0.0, edge.ball.center, edge.ball.radius, reach)) continue;
        const auto away =
            beside_edge(p_T, tool_.vertex(edge.ends[0]), tool_.vertex(edge.ends[1]), edge, collector.nearest());
        if (away && collector.wants(away->norm()))
          collector.add({pose_.p_W_m + rotation_ * (p_T - *away), -(rotation_ * away->normalized()), away->norm()});
      }
    }
    for (const std::int32_t f : on_object.edges) {
      if (f < 0) continue;
      for (const std::int32_t e : on_tool.edges) {
        if (e >= 0) edge_pair(tool_.edge(e), object_.edge(f), reach, collector);
      }
    }
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
      if (n.dot(on_object.inward[i]) > kSlack || n.dot(rotation_ * on_tool.inward[i]) < -kSlack) return;
    }
    collector.add({a + s * u, n, gap});
  }

  const Vec3& tool_W(std::int32_t v) {
    Vec3& p = tool_W_.points[at(v)];
    if (tool_W_.question[at(v)] != question_) {
      tool_W_.question[at(v)] = question_;
      p = pose_.p_W_m + rotation_ * tool_.vertex(v);
    }
    return p;
  }
  const Vec3& object_T(std::int32_t v) {
    Vec3& p = object_T_.points[at(v)];
    if (object_T_.question[at(v)] != question_) {
      object_T_.question[at(v)] = question_;
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
    const auto& corners = tool_.mesh().triangles[at(s)];
    for (std::size_t k = 0; k < 3; ++k) corners_W_[k] = tool_W(corners[k]);
  }

  const FeatureMesh& tool_;
  const FeatureMesh& object_;
  Turned& tool_W_;
  Turned& object_T_;
  const Pose& pose_;
  const Mat3& rotation_;
  std::uint64_t question_;
  std::int32_t turned_ = -1;
  Vec3 n_W_ = Vec3::Zero(), center_W_ = Vec3::Zero();
  std::array<Vec3, 3> corners_W_;
};

NearPairFinder::NearPairFinder(const FeatureMesh& tool, const FeatureMesh& object, double unit_m)
    : tool_(tool), object_(object), unit_m_(unit_m) {
  // More are not kept: the trees are then visited for each question.
  constexpr std::size_t kMostPairs = 16384;
  now_.pairs.reserve(kMostPairs);
  next_.pairs.reserve(kMostPairs);
  const auto make_room = [](Turned& turned, const FeatureMesh& mesh) {
    turned.points.resize(mesh.mesh().vertices_W_m.size());
    turned.question.assign(turned.points.size(), 0);
  };
  make_room(tool_W_, tool);
  make_room(object_T_, object);
}

bool NearPairFinder::small(std::int32_t on_object) const {
  return object_.face(on_object).ball.radius <= tool_.reach_m();
}

double NearPairFinder::above_of(const Bounds& bounds, std::int32_t on_object) const {
  return small(on_object) ? std::max(bounds.above_object, bounds.above_tool) : bounds.above_object;
}

std::size_t NearPairFinder::memory_bytes() const noexcept {
  return (now_.pairs.capacity() + next_.pairs.capacity()) * sizeof(TrianglePair) +
         (tool_W_.points.capacity() + object_T_.points.capacity()) * (sizeof(Vec3) + sizeof(std::uint64_t));
}

void NearPairFinder::begin(List& list, const Pose& pose, double reach_m) noexcept {
  list.pairs.clear();
  list.at = pose;
  list.rotation = pose.q_WT.toRotationMatrix();
  list.reach_m = reach_m;
  list.lever_m = tool_.reach_m();
  list.translated_m = list.turned_rad = 0.0;
  stack_[0] = {0, 0};
  open_ = 1;
  visited_ = 0;
}

void NearPairFinder::visit(List& list, std::size_t most_nodes) noexcept {
  Asked there(*this, list.at, list.rotation);
  for (std::size_t n = 0; n < most_nodes && open_ > 0 && list.pairs.size() < list.pairs.capacity(); ++n) {
    ++visited_;
    const Open open = stack_[--open_];
    const SphereTree::Node& a = tool_.tree().node(open.a);
    const SphereTree::Node& b = object_.tree().node(open.b);
    if (!can_touch(a.tags, b.tags)) continue;
    if (apart(list.at.p_W_m + turned(list.rotation, a.ball.center), a.ball.radius, b.ball.center, b.ball.radius,
              list.reach_m))
      continue;
    if (a.child < 0 && b.child < 0) {
      const Bounds bounds = there.bounds(a.item, b.item);
      if (bounds.apart > list.reach_m) continue;
      const Ball& ball = object_.face(b.item).ball;
      if (small(b.item))
        list.lever_m = std::max(list.lever_m, (ball.center - list.at.p_W_m).norm() + ball.radius + list.reach_m);
      list.pairs.push_back({a.item, b.item, rounded_down(bounds.apart), rounded_down(above_of(bounds, b.item))});
    } else if (b.child < 0 || (a.child >= 0 && a.ball.radius >= b.ball.radius)) {
      stack_[open_++] = {a.child + 1, open.b};
      stack_[open_++] = {a.child, open.b};
    } else {
      stack_[open_++] = {open.a, b.child + 1};
      stack_[open_++] = {open.a, b.child};
    }
  }
}

std::size_t NearPairFinder::find(const Pose& pose, double margin_m, double overlap_m,
                                 std::span<NearPair> pairs) noexcept {
  // How far the tool may move before the trees are visited again. More of it lengthens the list.
  constexpr double kSpare_m = 0.3e-3;
  const double spare = kSpare_m / unit_m_;
  Collector collector(margin_m, overlap_m, unit_m_, pairs);
  const Mat3 rotation = pose.q_WT.toRotationMatrix();
  const double reach = std::max(margin_m, overlap_m);
  // Gaps above blunt faces; a little more, for rounding.
  constexpr double kRounding = 1e-6;
  const double above_blunt = margin_m + kRounding * (margin_m + overlap_m);
  const Displacement step = displacement(asked_at_, pose);
  asked_at_ = pose;
  for (List* const list : {&now_, &next_}) {
    list->translated_m += step.translation_m.norm();
    list->turned_rad += step.rotation_rad.norm();
  }
  // No point of the tool has moved farther: a turn moves a point by no more than its angle times the point's distance.
  const auto moved_since = [&](const List& list) {
    const Displacement since = displacement(list.at, pose);
    return since.translation_m.norm() + tool_.reach_m() * since.rotation_rad.norm();
  };
  const auto holds = [&](const List& list) { return reach + moved_since(list) <= list.reach_m; };
  constexpr std::size_t kAll = std::numeric_limits<std::size_t>::max();
  // The next list becomes the present one, if it holds all.
  const auto finish = [&] {
    visit(next_, kAll);
    too_many_ = open_ > 0;
    visited_last_ = visited_;
    if (!too_many_) std::swap(now_, next_);
  };
  if (!holds(now_) && open_ > 0) finish();
  if (!holds(now_)) {
    begin(next_, pose, too_many_ ? reach : reach + spare);
    finish();
  } else {
    if (open_ == 0 && moved_since(now_) > 0.75 * spare) begin(next_, pose, reach + spare);
    if (open_ > 0) {
      // In time for what is left of the spare way, at the speed of this step.
      const double step_m = step.translation_m.norm() + tool_.reach_m() * step.rotation_rad.norm();
      constexpr std::size_t kFewest = 64;
      visit(next_, kFewest + static_cast<std::size_t>(double(visited_last_) * std::min(1.0, step_m / (0.2 * spare))));
      if (open_ == 0) {
        visited_last_ = visited_;
        std::swap(now_, next_);
      }
    }
  }

  Asked asked(*this, pose, rotation);
  const auto ask = [&](std::int32_t s, std::int32_t t, const Bounds& bounds) {
    if (bounds.apart <= reach && std::max(bounds.above_object, bounds.above_tool) <= above_blunt)
      asked.pairs(s, t, reach, collector);
  };
  if (too_many_) {  // asked part by part
    while (!next_.pairs.empty()) {
      for (const TrianglePair& pair : next_.pairs)
        ask(pair.on_tool, pair.on_object, asked.bounds(pair.on_tool, pair.on_object));
      next_.pairs.clear();
      visit(next_, kAll);
    }
    return collector.count();
  }
  const double travelled_m = now_.travelled_m();
  const float apart_now_m = rounded_up(travelled_m + reach);
  const float above_now_m = rounded_up(travelled_m + above_blunt);
  for (TrianglePair& pair : now_.pairs) {
    if (pair.apart_until_m > apart_now_m || pair.above_until_m > above_now_m) continue;
    const Bounds bounds = asked.bounds(pair.on_tool, pair.on_object);
    pair.apart_until_m = rounded_down(travelled_m + bounds.apart);
    pair.above_until_m = rounded_down(travelled_m + above_of(bounds, pair.on_object));
    ask(pair.on_tool, pair.on_object, bounds);
  }
  return collector.count();
}

}  // namespace touchstone::renderers
