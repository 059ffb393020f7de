#include "renderers/plane_contact.h"

#include <algorithm>

#include "renderers/front_crossing.h"
#include "renderers/nearest_in_polyhedron.h"

namespace touchstone {
namespace {

constexpr int kMoves = 64;

}  // namespace

void PlaneContact::start(const Vec3& g, std::int32_t triangle) noexcept {
  g_ = g;
  active_[0] = triangle;
  size_ = 1;
}

bool PlaneContact::active(std::int32_t triangle) const noexcept {
  return std::find(active_.begin(), active_.begin() + size_, triangle) != active_.begin() + size_;
}

void PlaneContact::remove(int index) noexcept {
  for (int i = index; i + 1 < size_; ++i)
    active_[static_cast<std::size_t>(i)] = active_[static_cast<std::size_t>(i) + 1];
  --size_;
}

void PlaneContact::pull(const Vec3& p) noexcept {
  std::int32_t left = -1;  // the triangle whose border was just crossed
  for (int move = 0; move < kMoves; ++move) {
    const double rounding = resting_error(*mesh_, g_);
    std::array<HalfSpace, 4> planes;
    for (int i = 0; i < size_; ++i) {
      const Facet& facet = mesh_->facet(active_[static_cast<std::size_t>(i)]);
      planes[static_cast<std::size_t>(i)] = {facet.n, -facet.height(g_)};  // from g
    }
    const auto nearest =
        nearest_in_polyhedron(std::span(planes.data(), static_cast<std::size_t>(size_)), p - g_, rounding);
    if (!nearest.found) {
      size_ = std::min(size_, 3);
      return;
    }
    std::array<std::int32_t, 4> pressing{};
    for (int i = 0; i < nearest.basis_size; ++i) {
      pressing[static_cast<std::size_t>(i)] =
          active_[static_cast<std::size_t>(nearest.basis[static_cast<std::size_t>(i)])];
    }
    active_ = pressing;
    size_ = nearest.basis_size;
    const Vec3 goal = size_ == 0 ? p : Vec3(g_ + nearest.x);
    // Triangles that the goal lies on to rounding are touched, not crossed.
    const FrontCrossing hit = first_front_crossing(
        *mesh_, g_, goal,
        [&](std::int32_t t) { return t == left || active(t) || mesh_->facet(t).height(goal) >= -rounding; }, rounding);
    if (over_border(p, goal, hit.fraction, left)) continue;
    if (hit.triangle < 0) {
      g_ = goal;
      return;
    }
    g_ += hit.fraction * (goal - g_);
    active_[static_cast<std::size_t>(size_++)] = hit.triangle;
    left = -1;
  }
  size_ = std::min(size_, 3);
}

// Up to the border of an active triangle, if that comes first: then its neighbour takes over, or its plane ends there.
bool PlaneContact::over_border(const Vec3& p, const Vec3& goal, double hit_fraction, std::int32_t& left) noexcept {
  double first = hit_fraction;
  int which = -1;
  std::size_t edge = 0;
  for (int i = 0; i < size_; ++i) {
    const Facet& facet = mesh_->facet(active_[static_cast<std::size_t>(i)]);
    for (std::size_t e = 0; e < 3; ++e) {
      const double there = facet.inside(e, goal);
      if (there >= 0.0) continue;
      const double here = std::max(0.0, facet.inside(e, g_));
      if (const double fraction = here / (here - there); fraction < first) {
        first = fraction;
        which = i;
        edge = e;
      }
    }
  }
  if (which < 0) return false;
  g_ += first * (goal - g_);
  const std::int32_t triangle = active_[static_cast<std::size_t>(which)];
  const std::int32_t neighbour = mesh_->facet(triangle).neighbour[edge];
  left = triangle;
  if (neighbour >= 0 && !active(neighbour) && mesh_->facet(neighbour).height(p) < 0.0) {
    active_[static_cast<std::size_t>(which)] = neighbour;
  } else {
    remove(which);
  }
  return true;
}

Vec3 PlaneContact::normal(const Vec3& p) const noexcept {
  if (!touching()) return Vec3::Zero();
  const Vec3 push = g_ - p;
  if (size_ > 1 && push.squaredNorm() > 0.0) return push.normalized();
  return mesh_->facet(active_[0]).n;
}

ContactNormals PlaneContact::contact_normals() const noexcept {
  ContactNormals contact;
  for (int i = 0; i < std::min(size_, 3); ++i) {
    const auto k = static_cast<std::size_t>(i);
    contact.n[k] = mesh_->facet(active_[k]).n;
  }
  contact.size = std::min(size_, 3);
  return contact;
}

ContactPlaces PlaneContact::contact_places() const noexcept {
  const ContactNormals normals = contact_normals();
  ContactPlaces contact;
  contact.size = normals.size;
  for (std::size_t k = 0; k < static_cast<std::size_t>(normals.size); ++k)
    contact.place[k] = {active_[k], Feature::face, 0, g_, normals.n[k]};
  return contact;
}

}  // namespace touchstone
