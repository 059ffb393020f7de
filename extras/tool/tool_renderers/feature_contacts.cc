#include "tool_renderers/feature_contacts.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "tool_renderers/near_features.h"

namespace touchstone::tool_renderers {
using tool::Displacement;
using tool::Pose;

namespace {

std::vector<Ball> triangle_balls(const surface::TriangleMesh& mesh) {
  std::vector<Ball> balls;
  balls.reserve(mesh.triangle_count());
  for (const auto& t : mesh.triangles) {
    Box3 box;
    for (const std::int32_t v : t) box.extend(mesh.vertices_W_m[surface::at(v)]);
    // The circle about the middle of the longest edge, or the box's centre: whichever is smaller.
    Ball best;
    for (int k = 0; k < 4; ++k) {
      const auto corner = [&](int i) -> const Vec3& {
        return mesh.vertices_W_m[surface::at(t[static_cast<std::size_t>(i % 3)])];
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
constexpr std::uint8_t has_vertex = 1;
constexpr std::uint8_t has_edge = 2;

// Nothing can touch where both sides are only faces, or a face and edges.
bool can_touch(std::uint8_t tool_tags, std::uint8_t object_tags) {
  return ((tool_tags | object_tags) & has_vertex) != 0 || (tool_tags & object_tags & has_edge) != 0;
}

}  // namespace

FeatureMesh::FeatureMesh(surface::TriangleMesh mesh) : mesh_(std::move(mesh)), tree_(triangle_balls(mesh_)) {
  const surface::MeshTopology topology = make_topology(mesh_);
  std::vector<unsigned char> sticks_out(mesh_.vertices_W_m.size(), 0);
  for (std::size_t t = 0; t < mesh_.triangle_count(); ++t) {
    for (std::size_t e = 0; e < 3; ++e) {
      if (topology.convexity[t][e] != surface::Convexity::ridge) continue;
      sticks_out[surface::at(mesh_.triangles[t][e])] = sticks_out[surface::at(mesh_.triangles[t][(e + 1) % 3])] = 1;
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
      if (sticks_out[surface::at(v)] != 0 && owned[surface::at(v)] == 0) {
        owned[surface::at(v)] = 1;
        face.vertices[e] = v;
      }
      const std::int32_t beside = topology.neighbours[t][e];
      if (topology.convexity[t][e] != surface::Convexity::ridge || beside < static_cast<std::int32_t>(t)) continue;
      Edge edge;
      edge.ends = {v, mesh_.triangles[t][(e + 1) % 3]};
      const Vec3 along = (vertex(edge.ends[1]) - vertex(edge.ends[0])).normalized();
      const Vec3& other = topology.face_normals[surface::at(beside)];
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
        static_cast<std::uint8_t>((any(faces_[t].vertices) ? has_vertex : 0) | (any(faces_[t].edges) ? has_edge : 0));
  }
  tree_.tag(tags);
  for (const Vec3& v : mesh_.vertices_W_m) reach_m_ = std::max(reach_m_, v.norm());
}

std::size_t FeatureMesh::memory_bytes() const noexcept {
  return mesh_.vertices_W_m.capacity() * sizeof(Vec3) + mesh_.triangles.capacity() * sizeof(mesh_.triangles[0]) +
         faces_.capacity() * sizeof(Face) + edges_.capacity() * sizeof(Edge) + tree_.memory_bytes();
}

namespace {

// A number of single precision that is not above, or not below, the value.
constexpr double single = 1e-6;
float rounded_down(double value) { return static_cast<float>(value - single * std::abs(value)); }
float rounded_up(double value) { return static_cast<float>(value + single * std::abs(value)); }

}  // namespace

NearPairFinder::NearPairFinder(const FeatureMesh& tool, const FeatureMesh& object, double unit_m)
    : tool_(tool), object_(object), unit_m_(unit_m) {
  // More are not kept: the trees are then visited for each question.
  constexpr std::size_t most_pairs = 16384;
  now_.pairs.reserve(most_pairs);
  next_.pairs.reserve(most_pairs);
  awake_.pairs.reserve(most_pairs);
  next_awake_.pairs.reserve(most_pairs);
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
         (awake_.pairs.capacity() + next_awake_.pairs.capacity()) * sizeof(AwakePair) +
         (tool_W_.points.capacity() + object_T_.points.capacity()) * (sizeof(Vec3) + sizeof(std::uint64_t));
}

double NearPairFinder::moved_since(const List& list, const Pose& pose) const noexcept {
  const Displacement since = displacement(list.at, pose);
  return since.translation_m.norm() + tool_.reach_m() * since.rotation_rad.norm();
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

void NearPairFinder::take_over() noexcept {
  std::swap(now_, next_);
  gathering_ = false;
}

namespace {

// How far the tool may travel while features stay awake, and by how much the margin may grow. More of it keeps more of
// them awake; less has the list gone through more often.
constexpr double awake_m = 30e-6;
constexpr double more_margin_m = 10e-6;
// Gaps above blunt faces; a little more, for rounding.
double above_blunt_of(double margin_m, double overlap_m) {
  constexpr double rounding = 1e-6;
  return margin_m + rounding * (margin_m + overlap_m);
}

}  // namespace

void NearPairFinder::wake(Asked& asked, double step_m, double margin_m, double overlap_m) noexcept {
  const double way_m = awake_m / unit_m_;
  Awake& next = next_awake_;
  if (!gathering_) {
    next.pairs.clear();
    next.whole = false;
    next.looked_at = next.asked = 0;
    next.margin_m = margin_m + more_margin_m / unit_m_;
    next.overlap_m = overlap_m;
    next.lever_m = now_.lever_m;
    next.translated_m = next.turned_rad = 0.0;
    gathering_ = true;
  }
  constexpr double rounding = 1e-6;
  const Loose loose{(1.0 + rounding) * way_m, next.lever_m, next.margin_m, next.overlap_m};
  const double apart_m = std::max(next.margin_m, next.overlap_m) + loose.way_m;
  const double above_m = above_blunt_of(next.margin_m, next.overlap_m) + loose.way_m;
  const double travelled_m = now_.travelled_m();
  const float apart_now_m = rounded_up(travelled_m + apart_m);
  const float above_now_m = rounded_up(travelled_m + above_m);
  // In time, at the speed of this step: a third of the way that features stay awake.
  constexpr std::size_t fewest = 32;
  const double share = std::min(1.0, 3.0 * step_m / way_m);
  const std::size_t most = next.asked + fewest + static_cast<std::size_t>(share * double(asked_last_));
  for (; next.looked_at < now_.pairs.size() && next.asked < most; ++next.looked_at) {
    TrianglePair& pair = now_.pairs[next.looked_at];
    if (pair.apart_until_m > apart_now_m || pair.above_until_m > above_now_m) continue;
    ++next.asked;
    const Bounds bounds = asked.bounds(pair.on_tool, pair.on_object);
    const double above = above_of(bounds, pair.on_object);
    pair.apart_until_m = rounded_down(travelled_m + bounds.apart);
    pair.above_until_m = rounded_down(travelled_m + above);
    if (bounds.apart > apart_m || above > above_m) continue;
    const Features features = asked.may_be_near(pair.on_tool, pair.on_object, loose);
    if (features != 0) next.pairs.push_back({pair.on_tool, pair.on_object, features});
  }
  if (next.looked_at < now_.pairs.size()) return;
  next.whole = true;
  gathering_ = false;
  asked_last_ = next.asked;
  std::swap(awake_, next_awake_);
}

bool NearPairFinder::keep_awake(Asked& asked, const Displacement& step, double margin_m, double overlap_m) noexcept {
  // Features stay awake for so many questions at least, at the mean speed of the last ones: else gathering costs more.
  constexpr double fewest_uses = 10.0;
  constexpr double mean = 0.1;  // share of a step in the mean
  const double way_m = awake_m / unit_m_;
  const double step_m = step.translation_m.norm() + now_.lever_m * step.rotation_rad.norm();
  mean_step_m_ += mean * (step_m - mean_step_m_);
  const auto awake = [&] {
    return awake_.whole && awake_.travelled_m() <= way_m && margin_m <= awake_.margin_m &&
           overlap_m <= awake_.overlap_m;
  };
  const bool was_awake = awake();
  if (gathering_ && !(next_awake_.travelled_m() < way_m)) {  // too late: faster the next time
    gathering_ = false;
    asked_last_ = std::max(asked_last_, 2 * next_awake_.asked);
  }
  // The list must hold all that can be near until then.
  const double farthest_m =
      std::max(margin_m + more_margin_m / unit_m_, overlap_m) + way_m + moved_since(now_, asked_at_);
  const bool worth = fewest_uses * mean_step_m_ <= way_m && farthest_m <= now_.reach_m;
  constexpr double search_from = 0.4;  // of the way that features stay awake
  if (gathering_ || (worth && (!was_awake || awake_.travelled_m() > search_from * way_m)))
    wake(asked, step_m, margin_m, overlap_m);
  return awake();
}

std::size_t NearPairFinder::find(const Pose& pose, double margin_m, double overlap_m,
                                 std::span<NearPair> pairs) noexcept {
  // How far the tool may move before the trees are visited again. More of it lengthens the list.
  constexpr double spare_m = 0.3e-3;
  const double spare = spare_m / unit_m_;
  Collector collector(margin_m, overlap_m, unit_m_, pairs);
  const Mat3 rotation = pose.q_WT.toRotationMatrix();
  const double reach = std::max(margin_m, overlap_m);
  const double above_blunt = above_blunt_of(margin_m, overlap_m);
  const Displacement step = displacement(asked_at_, pose);
  asked_at_ = pose;
  for (List* const list : {&now_, &next_}) {
    list->translated_m += step.translation_m.norm();
    list->turned_rad += step.rotation_rad.norm();
  }
  for (Awake* const awake : {&awake_, &next_awake_}) {
    awake->translated_m += step.translation_m.norm();
    awake->turned_rad += step.rotation_rad.norm();
  }
  const auto holds = [&](const List& list) { return reach + moved_since(list, pose) <= list.reach_m; };
  constexpr std::size_t all = std::numeric_limits<std::size_t>::max();
  // The next list becomes the present one, if it holds all.
  const auto finish = [&] {
    visit(next_, all);
    too_many_ = open_ > 0;
    visited_last_ = visited_;
    if (!too_many_) take_over();
  };
  if (!holds(now_) && open_ > 0) finish();
  if (!holds(now_)) {
    begin(next_, pose, too_many_ ? reach : reach + spare);
    finish();
  } else {
    if (open_ == 0 && moved_since(now_, pose) > 0.75 * spare) begin(next_, pose, reach + spare);
    if (open_ > 0) {
      // In time for what is left of the spare way, at the speed of this step.
      const double step_m = step.translation_m.norm() + tool_.reach_m() * step.rotation_rad.norm();
      constexpr std::size_t fewest = 64;
      visit(next_, fewest + static_cast<std::size_t>(double(visited_last_) * std::min(1.0, step_m / (0.2 * spare))));
      if (open_ == 0) {
        visited_last_ = visited_;
        take_over();
      }
    }
  }

  Asked asked(*this, pose, rotation);
  const auto ask = [&](std::int32_t s, std::int32_t t, Features features, const Bounds& bounds) {
    if (bounds.apart <= reach && std::max(bounds.above_object, bounds.above_tool) <= above_blunt)
      asked.pairs(s, t, features, reach, collector);
  };
  if (too_many_) {  // asked part by part
    while (!next_.pairs.empty()) {
      for (const TrianglePair& pair : next_.pairs)
        ask(pair.on_tool, pair.on_object, Asked::all_features, asked.bounds(pair.on_tool, pair.on_object));
      next_.pairs.clear();
      visit(next_, all);
    }
    return collector.count();
  }
  const double travelled_m = now_.travelled_m();
  if (keep_awake(asked, step, margin_m, overlap_m)) {
    for (const AwakePair& pair : awake_.pairs)
      ask(pair.on_tool, pair.on_object, pair.features, asked.bounds(pair.on_tool, pair.on_object));
    return collector.count();
  }
  const float apart_now_m = rounded_up(travelled_m + reach);
  const float above_now_m = rounded_up(travelled_m + above_blunt);
  for (TrianglePair& pair : now_.pairs) {
    if (pair.apart_until_m > apart_now_m || pair.above_until_m > above_now_m) continue;
    const Bounds bounds = asked.bounds(pair.on_tool, pair.on_object);
    pair.apart_until_m = rounded_down(travelled_m + bounds.apart);
    pair.above_until_m = rounded_down(travelled_m + above_of(bounds, pair.on_object));
    ask(pair.on_tool, pair.on_object, Asked::all_features, bounds);
  }
  return collector.count();
}

}  // namespace touchstone::tool_renderers
