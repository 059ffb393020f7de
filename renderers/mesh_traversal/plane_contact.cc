#include "renderers/mesh_traversal/plane_contact.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>

#include "harness/surface/triangle_queries.h"
#include "renderers/friction/fixed_order.h"
#include "renderers/mesh_traversal/exposed_place.h"
#include "renderers/mesh_traversal/flush.h"
#include "renderers/mesh_traversal/front_crossing.h"
#include "renderers/mesh_traversal/posed_bodies.h"

namespace touchstone::renderers {
namespace {

constexpr int most_moves = 256;
// Moves without coming closer to the tip before it rests where it is: at most four planes change places at one point.
constexpr int idle_moves = 8;
// The free point's distance: above rims that stand out as far as counts as flush, with as much to spare.
constexpr double lift_factor = 2.0;
// Outlines end wider by half of what counts as flush when they stop a way, by all of it when they are left: a way that
// has left one does not meet it again, and finds the neighbour across any gap that counts as none.
constexpr double stops_within = 0.5;
// Directions that floors about one place may have: the faces about a corner of boxes, of both orientations.
constexpr std::size_t most_floors = 6;
// Cosine from which two floors have one direction: both hold a tip at what counts as flush, whichever is taken.
constexpr double same_floor = 0.999;

const Vec3& no_place() {
  static const Vec3 place = Vec3::Constant(std::numeric_limits<double>::quiet_NaN());
  return place;
}

// How far the triangle's corners reach over another one's plane.
template <class Mesh>
double reach_over(const Mesh& mesh, const Facet& plane, std::int32_t triangle) noexcept {
  double most = -std::numeric_limits<double>::infinity();
  for (const Vec3& corner : mesh.corners(triangle)) most = std::max(most, plane.height(corner));
  return most;
}

// Whether the triangle's corners lie that close to another one's plane.
template <class Mesh>
bool within_plane(const Mesh& mesh, const Facet& plane, std::int32_t triangle, double width) noexcept {
  const auto corners = mesh.corners(triangle);
  return std::all_of(corners.begin(), corners.end(), [&](const Vec3& x) { return std::abs(plane.height(x)) <= width; });
}

// Whether the way lies on the far side of one of the triangle's borders all along. (A way within the triangle's plane,
// exactly, crosses its borders nowhere, and passes for one that goes through it.)
bool beside(const Facet& facet, const Vec3& from, const Vec3& to, double width) noexcept {
  for (std::size_t e = 0; e < 3; ++e) {
    if (facet.inside(e, from) < -width && facet.inside(e, to) < -width) return true;
  }
  return false;
}

}  // namespace

template <class Mesh>
bool PlaneContactOf<Mesh>::Active::has(std::int32_t t) const noexcept {
  return std::find(triangle.begin(), triangle.begin() + size, t) != triangle.begin() + size;
}

template <class Mesh>
void PlaneContactOf<Mesh>::Active::remove(int index) noexcept {
  std::copy(triangle.begin() + index + 1, triangle.begin() + size, triangle.begin() + index);
  --size;
}

template <class Mesh>
PlaneContactOf<Mesh>::PlaneContactOf(const Mesh& mesh)
    : mesh_(&mesh), flush_(mesh.flush()), lift_(lift_factor * flush_), pulled_to_(no_place()) {}

template <class Mesh>
void PlaneContactOf<Mesh>::start_on(std::int32_t triangle, const Vec3& g) noexcept {
  start_free(g);
  const Facet& facet = mesh_->facet(triangle);
  // A triangle without area has no normal of its own, and holds nothing.
  const bool flat = !is_zero(facet.n);
  if (flat) active_.add(triangle);
  free_ = g + lift_ * (flat ? facet.n : mesh_->vertex_normal(facet.corner[0]));
  lifted_ = true;
}

template <class Mesh>
void PlaneContactOf<Mesh>::start_free(const Vec3& g) noexcept {
  g_ = free_ = g;
  active_ = {};
  lifted_ = false;
  pulled_to_ = no_place();
}

template <class Mesh>
void PlaneContactOf<Mesh>::start_lifted(const Vec3& free) noexcept {
  start_free(free);
  lifted_ = true;
}

template <class Mesh>
void PlaneContactOf<Mesh>::carry(const Vec3& g, const Vec3& free) noexcept {
  g_ = g;
  free_ = free;
  pulled_to_ = no_place();
}

template <class Mesh>
bool PlaneContactOf<Mesh>::nearest_in_front(const Vec3& to, double lift, Vec3& place) noexcept {
  std::array<HalfSpace, 4> planes;  // as seen from there
  const auto count = static_cast<std::size_t>(active_.size);
  for (std::size_t i = 0; i < count; ++i) {
    const Facet& facet = mesh_->facet(active_.triangle[i]);
    planes[i] = {facet.n, lift - facet.height(to)};
  }
  const auto nearest = nearest_in_polyhedron(std::span(planes.data(), count), Vec3::Zero(), resting_error(*mesh_, to));
  if (!nearest.found) return false;
  Active pressing;
  for (int i = 0; i < nearest.basis_size; ++i)
    pressing.add(active_.triangle[static_cast<std::size_t>(nearest.basis[static_cast<std::size_t>(i)])]);
  active_ = pressing;
  place = to + nearest.x;
  return true;
}

template <class Mesh>
void PlaneContactOf<Mesh>::pull(const Vec3& p) noexcept {
  if (p == pulled_to_) return;
  pulled_to_ = p;
  descend(p);
  // What holds it from several sides must do so for a way from in front of all of them, too.
  if (active_.size > 1) descend(p);
}

template <class Mesh>
void PlaneContactOf<Mesh>::descend(const Vec3& p) noexcept {
  // On its only triangle it is already, if the tip is still behind it.
  if (active_.size != 1 || !(mesh_->facet(active_.triangle[0]).height(p) < 0.0)) active_.size = 0;
  left_ = -1;
  double least = std::numeric_limits<double>::infinity();
  int idle = 0;
  bool arrived = false;
  for (int move = 0; move < most_moves && idle < idle_moves; ++move) {
    Vec3 goal = p;
    if (active_.size > 0 && !nearest_in_front(p, lift_, goal)) break;
    const FrontCrossing hit = first_front_crossing(
        *mesh_, free_, goal,
        [&](std::int32_t t) { return active_.has(t) || beside(mesh_->facet(t), free_, goal, flush_); },
        stops_within * flush_);
    if (!over_border(p, goal, hit.fraction)) {
      if (hit.triangle < 0) {
        free_ = goal;
        arrived = true;
        break;
      }
      meet(hit.triangle, goal, p);
    }
    const double away = squared_distance<double>(p, free_);
    idle = away < least ? 0 : idle + 1;
    least = std::min(least, away);
  }
  rest(p, arrived);
}

template <class Mesh>
void PlaneContactOf<Mesh>::meet(std::int32_t triangle, const Vec3& goal, const Vec3& p) noexcept {
  const Facet& facet = mesh_->facet(triangle);
  const double from = facet.height(free_);
  const double to = facet.height(goal);
  const double fraction = std::max(0.0, (from - lift_) / (from - to));
  const bool flying = active_.size == 0;
  if (flying && !lifted_) {
    const Vec3 place = free_ + std::max(0.0, from / (from - to)) * (goal - free_);
    if (const std::int32_t floor = floor_over(triangle, place, p); floor >= 0) {
      rise_over(floor);
      active_.add(floor);
      return;
    }
  }
  free_ += fraction * (goal - free_);
  if (flying && !lifted_) rise_over(triangle);
  // A valley between the triangle that was left and this one holds it by both.
  if (flying && left_ >= 0 && left_ != triangle && mesh_->facet(left_).height(p) < 0.0 && !behind(triangle, left_) &&
      !behind(left_, triangle))
    active_.add(left_);
  active_.size = std::min(active_.size, 3);
  active_.add(triangle);
  left_ = -1;
}

template <class Mesh>
void PlaneContactOf<Mesh>::rise_over(std::int32_t triangle) noexcept {
  const Facet& facet = mesh_->facet(triangle);
  const double missing = lift_ - facet.height(free_);
  if (missing > 0.0) {
    const Vec3 up = missing * facet.n;
    const Vec3 above = free_ + up;
    const double rounding = resting_error(*mesh_, free_);
    const FrontCrossing ceiling = first_front_crossing(*mesh_, free_, above, [&](std::int32_t t) {
      // Walls that it lies in to rounding do not hang over it, and neither does the other side of a sheet.
      return mesh_->facet(t).height(above) >= -rounding ||
             (within_plane(*mesh_, facet, t, flush_) && winding_about(*mesh_, above) <= 0);
    });
    if (ceiling.triangle < 0) free_ = above;
  }
  lifted_ = true;
}

// Whether the triangle lies behind the other one's plane, or in it.
template <class Mesh>
bool PlaneContactOf<Mesh>::behind(std::int32_t triangle, std::int32_t other) const noexcept {
  return reach_over(*mesh_, mesh_->facet(other), triangle) <= flush_;
}

template <class Mesh>
std::int32_t PlaneContactOf<Mesh>::floor_over(std::int32_t side, const Vec3& place, const Vec3& p) const noexcept {
  // One triangle for each direction that a floor may have there: the smallest index, in whichever order they come.
  struct Floor {
    std::int32_t triangle;
    Vec3 n;
  };
  std::array<Floor, most_floors> floors;
  std::size_t count = 0;
  mesh_->tree().within(place, flush_, [&](std::int32_t t) {
    const Facet& facet = mesh_->facet(t);
    if (t == side || is_zero(facet.n) || !(std::abs(facet.height(p)) <= flush_)) return flush_;
    // Not another piece of the side itself.
    if (within_plane(*mesh_, mesh_->facet(side), t, flush_) || !behind(side, t)) return flush_;
    if (surface::closest_on_triangle(mesh_->corners(t), facet.n, place).squared_distance > flush_ * flush_)
      return flush_;
    const auto end = floors.begin() + static_cast<std::ptrdiff_t>(count);
    const auto same = std::find_if(floors.begin(), end, [&](const Floor& f) { return dot(f.n, facet.n) > same_floor; });
    if (same != end) {
      if (t < same->triangle) *same = {t, facet.n};
    } else if (count < most_floors) {
      floors[count++] = {t, facet.n};
    }
    return flush_;
  });
  if (count == 0) return -1;
  // Of several directions some may be sides that another body covers, where bodies meet in a corner: the floor is the
  // one that has free space in front of it, behind the side and the others. Looked for clear of all that counts as
  // flush.
  Vec3 others = mesh_->facet(side).n;
  for (std::size_t i = 0; i < count; ++i) others += floors[i].n;
  std::int32_t found = -1;
  for (std::size_t i = 0; i < count; ++i) {
    const auto& [t, n] = floors[i];
    const bool free = count == 1 || winding_about(*mesh_, place + lift_ * (2.0 * n - others)) <= 0;
    if (free && (found < 0 || t < found)) found = t;
  }
  // A tip in both, to what counts as flush, stays on the side unless another body covers that below the floor.
  if (found >= 0 && std::abs(mesh_->facet(side).height(p)) <= flush_ &&
      winding_about(*mesh_, place + lift_ * (mesh_->facet(side).n - mesh_->facet(found).n)) <= 0)
    return -1;
  return found;
}

template <class Mesh>
bool PlaneContactOf<Mesh>::over_border(const Vec3& p, const Vec3& goal, double hit_fraction) noexcept {
  double first = hit_fraction;
  int which = -1;
  std::size_t edge = 0;
  for (int i = 0; i < active_.size; ++i) {
    const Facet& facet = mesh_->facet(active_.triangle[static_cast<std::size_t>(i)]);
    for (std::size_t e = 0; e < 3; ++e) {
      const double there = facet.inside(e, goal) + flush_;
      if (there >= 0.0) continue;
      const double here = std::max(0.0, facet.inside(e, free_) + flush_);
      if (const double fraction = here / (here - there); fraction < first) {
        first = fraction;
        which = i;
        edge = e;
      }
    }
  }
  if (which < 0) return false;
  free_ += first * (goal - free_);
  const std::int32_t triangle = active_.triangle[static_cast<std::size_t>(which)];
  const Facet& facet = mesh_->facet(triangle);
  const std::int32_t neighbour = facet.neighbour[edge];
  left_ = triangle;
  if (neighbour < 0 || active_.has(neighbour) || !(mesh_->facet(neighbour).height(p) < 0.0)) {
    active_.remove(which);
  } else if (facet.valley[edge] && active_.size < 4 &&
             mesh_->facet(neighbour).height(goal) < lift_ - resting_error(*mesh_, goal)) {
    // Into a valley: the neighbour stands in the way. (One whose two sides are flat to rounding does not hold.)
    active_.add(neighbour);
  } else {
    active_.triangle[static_cast<std::size_t>(which)] = neighbour;
  }
  return true;
}

template <class Mesh>
void PlaneContactOf<Mesh>::rest(const Vec3& p, bool arrived) noexcept {
  if (arrived) {
    // The free point is in its place in front of the planes, the god-object on them. None presses where the tip is
    // nearer in front of them than that.
    if (active_.size == 0 || !nearest_in_front(p, 0.0, g_) || active_.size == 0) {
      g_ = free_ = p;
      active_.size = 0;
    }
    lifted_ = active_.size > 0;
    return;
  }
  // Held up on the way: on the planes, below where the free point is.
  if (active_.size == 0 && left_ >= 0) active_.add(left_);
  active_.size = std::min(active_.size, 3);
  const Active held = active_;
  Vec3 down = Vec3::Zero();
  for (int i = 0; i < active_.size; ++i) down -= mesh_->facet(active_.triangle[static_cast<std::size_t>(i)]).n;
  if (nearest_in_front(free_ + 4.0 * lift_ * down, 0.0, g_) && active_.size > 0) return;
  active_ = held;
  g_ = free_;
}

template <class Mesh>
Vec3 PlaneContactOf<Mesh>::normal(const Vec3& p) const noexcept {
  if (!touching()) return Vec3::Zero();
  const Vec3 push = g_ - p;
  if (active_.size > 1 && push.squaredNorm() > 0.0) return push.normalized();
  return mesh_->facet(active_.triangle[0]).n;
}

template <class Mesh>
ContactNormals PlaneContactOf<Mesh>::contact_normals() const noexcept {
  ContactNormals contact;
  for (int i = 0; i < active_.size && i < 3; ++i) {
    const auto k = static_cast<std::size_t>(i);
    contact.n[k] = mesh_->facet(active_.triangle[k]).n;
  }
  contact.size = std::min(active_.size, 3);
  return contact;
}

template <class Mesh>
ContactPlaces PlaneContactOf<Mesh>::contact_places() const noexcept {
  const ContactNormals normals = contact_normals();
  ContactPlaces contact;
  contact.size = normals.size;
  for (std::size_t k = 0; k < static_cast<std::size_t>(normals.size); ++k)
    contact.place[k] = {active_.triangle[k], surface::Feature::face, 0, g_, normals.n[k]};
  return contact;
}

template class PlaneContactOf<ContactMesh>;
template class PlaneContactOf<PosedBodies>;

}  // namespace touchstone::renderers
