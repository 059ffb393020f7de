#include "renderers/mesh_traversal/posed_bodies.h"

#include <fmt/format.h>

#include <algorithm>

#include "harness/base/error.h"

namespace touchstone::renderers {
namespace {

// A ball that holds more than the body: queries ask a little beyond what they look for.
constexpr double spare = 1.0 + 1e-6;

}  // namespace

PosedBody::PosedBody(const rendering::SceneBody& body, std::int32_t first_triangle, std::int32_t first_vertex)
    : surface_(body.surface_B),
      mesh_(contact_mesh(surface_)),
      track_(body.pose),
      first_triangle_(first_triangle),
      first_vertex_(first_vertex) {
  const Box3 box = surface_->bounds();
  center_B_ = box.center();
  radius_ = spare * 0.5 * box.diagonal().norm() + flush_m(mesh_->magnitude());
  const rendering::BodyPose pose = track_.first();
  p_ = p_before_ = pose.p_W_m;
  turn_ = turn_before_ = pose.q_WB.toRotationMatrix();
}

bool PosedBody::move_to(double t_s, bool first) noexcept {
  if (!track_.moves()) return true;
  if (!track_.covers(t_s)) return false;
  const rendering::BodyPose pose = track_.at(t_s, segment_);
  p_before_ = p_;
  turn_before_ = turn_;
  p_ = pose.p_W_m;
  turn_ = pose.q_WB.toRotationMatrix();
  if (first) {
    p_before_ = p_;
    turn_before_ = turn_;
  }
  moved_ = p_ != p_before_ || turn_ != turn_before_;
  return true;
}

PosedBodies::PosedBodies(const rendering::BodyScene& scene) {
  std::int32_t triangles = 0;
  std::int32_t vertices = 0;
  for (const rendering::SceneBody& body : scene.bodies) {
    if (body.surface_B->mesh() == nullptr) {
      throw BadData(
          fmt::format("{}: the body {} has no triangles, by which this renderer constrains", scene.source, body.name));
    }
    bodies_.emplace_back(body, triangles, vertices);
    const ContactMesh& mesh = bodies_.back().mesh();
    triangles += static_cast<std::int32_t>(mesh.triangle_count());
    vertices += static_cast<std::int32_t>(mesh.vertex_count());
    flush_ = std::max(flush_, mesh.flush());
  }
}

bool PosedBodies::move_to(double t_s, bool first) noexcept {
  moved_ = false;
  Box3 around;
  magnitude_ = 0.0;
  for (PosedBody& body : bodies_) {
    if (!body.move_to(t_s, first)) return false;
    moved_ = moved_ || body.moved();
    const Vec3 center = body.center();
    const Vec3 reach = Vec3::Constant(body.radius());
    around.extend(center - reach);
    around.extend(center + reach);
    magnitude_ = std::max(magnitude_, body.mesh().magnitude());
  }
  magnitude_ = std::max({magnitude_, around.min().cwiseAbs().maxCoeff(), around.max().cwiseAbs().maxCoeff()});
  extent_ = around.diagonal().norm();
  return true;
}

std::string PosedBodies::out_of_reach(double t_s) const {
  for (const PosedBody& body : bodies_) {
    if (!body.track().covers(t_s)) return body.track().out_of_reach(t_s);
  }
  return {};
}

std::size_t PosedBodies::body_of(std::int32_t triangle) const noexcept {
  std::size_t i = bodies_.size() - 1;
  while (triangle < bodies_[i].first_triangle()) --i;
  return i;
}

Facet PosedBodies::facet(std::int32_t triangle) const noexcept {
  const PosedBody& body = bodies_[body_of(triangle)];
  Facet facet = body.mesh().facet(triangle - body.first_triangle());
  facet.origin = body.to_W(facet.origin);
  facet.n = body.direction_to_W(facet.n);
  for (Vec3& inward : facet.inward) inward = body.direction_to_W(inward);
  for (std::int32_t& corner : facet.corner) corner += body.first_vertex();
  for (std::int32_t& neighbour : facet.neighbour) {
    if (neighbour >= 0) neighbour += body.first_triangle();
  }
  return facet;
}

Vec3 PosedBodies::vertex(std::int32_t index) const noexcept {
  std::size_t i = bodies_.size() - 1;
  while (index < bodies_[i].first_vertex()) --i;
  return bodies_[i].to_W(bodies_[i].mesh().vertex(index - bodies_[i].first_vertex()));
}

Vec3 PosedBodies::vertex_normal(std::int32_t index) const noexcept {
  std::size_t i = bodies_.size() - 1;
  while (index < bodies_[i].first_vertex()) --i;
  return bodies_[i].direction_to_W(bodies_[i].mesh().vertex_normal(index - bodies_[i].first_vertex()));
}

std::array<Vec3, 3> PosedBodies::corners(std::int32_t triangle) const noexcept {
  const PosedBody& body = bodies_[body_of(triangle)];
  const auto local = body.mesh().corners(triangle - body.first_triangle());
  return {body.to_W(local[0]), body.to_W(local[1]), body.to_W(local[2])};
}

bool PosedBodies::open() const noexcept {
  return std::any_of(bodies_.begin(), bodies_.end(), [](const PosedBody& body) { return body.mesh().open(); });
}

std::size_t PosedBodies::memory_bytes() const noexcept {
  std::size_t bytes = bodies_.capacity() * sizeof(PosedBody);
  for (auto body = bodies_.begin(); body != bodies_.end(); ++body) {
    // Bodies of one shape share its mesh.
    const bool first =
        std::none_of(bodies_.begin(), body, [&](const PosedBody& other) { return &other.mesh() == &body->mesh(); });
    if (first) bytes += body->mesh().memory_bytes();
  }
  return bytes;
}

}  // namespace touchstone::renderers
