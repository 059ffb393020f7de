#include "renderers/proxy/ball_vicinity.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "renderers/friction/fixed_order.h"
#include "renderers/proxy/ball_constraints.h"

namespace touchstone::renderers {
namespace {

constexpr std::size_t most_around = 2048;
// As many triangles as a hand comes to in some seconds on a mesh of a million: 1.7 MB.
constexpr std::size_t most_kept = 8192;
// A ball turns about an edge sharper than that by asking the tree: its list would be long. Of the radius.
constexpr double most_spread = 0.25;
// What coplanar neighbours and positions solved for are off by, rounding included. Of the radius.
constexpr double least_spread = 1e-9;
// Of distances on the mesh. Less than what a ball takes as touching (32 roundings, ball_proxy.cc) by more than what the
// place of a ball on a face is rounded by.
constexpr double rounded = 8.0 * std::numeric_limits<double>::epsilon();
// For what is farther for sure, rounding aside.
constexpr double reach_factor = 1.0 + 64.0 * std::numeric_limits<double>::epsilon();

// A lower bound of the least distance of the triangle from the places whose corners are `x`: the greatest of those by
// the tangents at the middle and the corners, or the first of them that is `enough`.
double distance_bound(const ContactMesh& mesh, std::int32_t triangle, const std::array<Vec3, 3>& x, const Vec3& middle,
                      double enough) {
  double bound = 0.0;
  for (std::size_t i = 0; i < 4 && bound < enough; ++i) {
    const Vec3& at = i == 0 ? middle : x[i - 1];
    const TouchOf<double> t = touch(mesh, triangle, at);
    double least = std::numeric_limits<double>::infinity();
    for (const Vec3& corner : x) least = std::min(least, dot(t.n, corner - at));
    bound = std::max(bound, t.d + least);
  }
  return bound;
}

// Whether a plane across the way from the middle of `x` to a corner of the triangle keeps the triangle farther than
// `enough` from all of `x`: a bound that is cheap, and enough for nearly all that are proposed.
bool plainly_beyond(const ContactMesh& mesh, const Facet& facet, const std::array<Vec3, 3>& x, const Vec3& middle,
                    double enough) {
  const Vec3 way = mesh.vertex(facet.corner[0]) - middle;
  const double squared = squared_norm(way);
  double nearest = squared;
  for (std::size_t i = 1; i < 3; ++i) nearest = std::min(nearest, dot(way, mesh.vertex(facet.corner[i]) - middle));
  double farthest = 0.0;
  for (const Vec3& place : x) farthest = std::max(farthest, dot(way, place - middle));
  const double apart = nearest - farthest;
  return apart > 0.0 && apart * apart >= enough * enough * squared;
}

// One that shares a corner with another touches all that does.
bool shares_corner(const Facet& a, const Facet& b) {
  return std::ranges::any_of(
      a.corner, [&](std::int32_t corner) { return std::ranges::find(b.corner, corner) != b.corner.end(); });
}

}  // namespace

BallVicinity::BallVicinity(const ContactMesh& mesh, double radius_m)
    : mesh_(&mesh),
      radius_m_(radius_m),
      entries_(std::min(mesh.triangle_count(), most_kept)),
      places_(mesh.triangle_count(), 0) {
  proposed_.reserve(most_around);
}

void BallVicinity::list(std::int32_t triangle, Entry& entry) noexcept {
  entry.triangle = triangle;
  entry.on_face = entry.all = 0;
  const double spread = list_within_reach(triangle, entry);
  if (spread >= 0.0) {
    entry.spread_m = std::nextafter(static_cast<float>(spread), 0.0F);  // never rounded up
  } else {
    entry.spread_m = -1.0F;
    entry.on_face = entry.all = 0;
  }
}

bool BallVicinity::propose(std::int32_t triangle, const std::array<Vec3, 3>& x, const Vec3& middle, double reach,
                           double most) noexcept {
  proposed_.clear();
  // Those with a corner closer than `most` to a corner of P are listed whatever the bounds say: where they are too many
  // already, and on a fine mesh they are on most triangles, no bound need be known.
  const double surely = most * most * (2.0 - reach_factor);
  std::size_t listed = 0;
  bool complete = true;
  mesh_->tree().within(middle, reach, [&](std::int32_t t) {
    if (!complete || t == triangle) return complete ? reach : 0.0;
    const Facet& other = mesh_->facet(t);
    if (is_zero(other.n)) return reach;
    complete = proposed_.size() < most_around;
    if (complete) proposed_.push_back(t);
    const Vec3& corner_of_t = mesh_->vertex(other.corner[0]);
    const bool near = std::ranges::any_of(x, [&](const Vec3& at) { return squared_norm(at - corner_of_t) < surely; });
    if (near) complete = complete && ++listed <= most_listed;
    return complete ? reach : 0.0;
  });
  return complete;
}

double BallVicinity::list_within_reach(std::int32_t triangle, Entry& entry) noexcept {
  const ContactMesh& mesh = *mesh_;
  const Facet& facet = mesh.facet(triangle);
  if (is_zero(facet.n)) return -1.0;
  // How far about its edges and corners the ball turns.
  double turn = 0.0;
  for (const std::int32_t corner : facet.corner) {
    for (const std::int32_t t : mesh.fan(corner)) turn = std::max(turn, (mesh.facet(t).n - facet.n).norm());
  }
  const double spread = std::max(least_spread, turn > most_spread ? 0.0 : 1.01 * turn) * radius_m_;
  const double least = radius_m_ - rounded * mesh.magnitude();
  const double most = radius_m_ + spread;

  const std::array<Vec3, 3> corner = mesh.corners(triangle);
  std::array<Vec3, 3> x;
  for (std::size_t i = 0; i < 3; ++i) x[i] = corner[i] + radius_m_ * facet.n;
  const Vec3 middle = (x[0] + x[1] + x[2]) / 3.0;
  double extent = 0.0;
  for (const Vec3& place : x) extent = std::max(extent, (place - middle).norm());
  if (!propose(triangle, x, middle, (most + extent) * reach_factor, most)) return -1.0;
  std::array<std::int32_t, most_listed> beside;
  std::size_t beside_count = 0;
  for (const std::int32_t t : proposed_) {
    const Facet& other = mesh.facet(t);
    // All of it is below a plane that is as far from P as the ball's radius, for most.
    double height = -std::numeric_limits<double>::infinity();
    for (const std::int32_t v : other.corner) height = std::max(height, facet.height(mesh.vertex(v)));
    if (height < -spread || plainly_beyond(mesh, other, x, middle, most)) continue;
    // What lies that low cannot be met on the face, and what has a corner of the triangle can beside it.
    double bound = radius_m_ - height;
    if (bound < least || !shares_corner(facet, other))
      bound = std::max(bound, distance_bound(mesh, t, x, middle, most));
    if (bound >= most) continue;
    if (entry.on_face + beside_count == most_listed) return -1.0;
    if (bound < least) {
      entry.listed[entry.on_face++] = t;
    } else {
      beside[beside_count++] = t;
    }
  }
  std::copy_n(beside.begin(), beside_count, entry.listed.begin() + entry.on_face);
  entry.all = static_cast<std::uint16_t>(entry.on_face + beside_count);
  std::sort(entry.listed.begin(), entry.listed.begin() + entry.on_face);
  std::sort(entry.listed.begin() + entry.on_face, entry.listed.begin() + entry.all);
  return spread;
}

}  // namespace touchstone::renderers
