#include "renderers/proxy/ball_vicinity.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "harness/base/in_parallel.h"
#include "renderers/friction/fixed_order.h"
#include "renderers/proxy/ball_constraints.h"

namespace touchstone::renderers {
namespace {

// More than a smooth surface has; where there are more, the tree is asked for the ball's neighbourhood.
constexpr std::size_t kMostListed = 48;
constexpr std::size_t kMostAround = 2048;
constexpr std::size_t kAtATime = 512;  // triangles for which one core makes the lists at a time
// A ball turns about an edge sharper than that by asking the tree: its list would be long. Of the radius.
constexpr double kMostSpread = 0.25;
// What coplanar neighbours and positions solved for are off by, rounding included. Of the radius.
constexpr double kLeastSpread = 1e-9;
// Of distances on the mesh. Less than what a ball takes as touching (32 roundings, ball_proxy.cc) by more than what the
// place of a ball on a face is rounded by.
constexpr double kRounded = 8.0 * std::numeric_limits<double>::epsilon();
// For what is farther for sure, rounding aside.
constexpr double kReach = 1.0 + 64.0 * std::numeric_limits<double>::epsilon();

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

struct Lists {
  std::vector<std::int32_t> on_face;
  std::vector<std::int32_t> beside;
};

// The spread for which the lists are complete, < 0 where they are not.
double list_vicinity(const ContactMesh& mesh, std::int32_t triangle, double radius_m,
                     std::vector<std::int32_t>& proposed, Lists& lists) {
  lists.on_face.clear();
  lists.beside.clear();
  const Facet& facet = mesh.facet(triangle);
  if (is_zero(facet.n)) return -1.0;
  // How far about its edges and corners the ball turns.
  double turn = 0.0;
  for (const std::int32_t corner : facet.corner) {
    for (const std::int32_t t : mesh.fan(corner)) turn = std::max(turn, (mesh.facet(t).n - facet.n).norm());
  }
  const double spread = std::max(kLeastSpread, turn > kMostSpread ? 0.0 : 1.01 * turn) * radius_m;
  const double least = radius_m - kRounded * mesh.magnitude();
  const double most = radius_m + spread;

  const std::array<Vec3, 3> corner = mesh.corners(triangle);
  std::array<Vec3, 3> x;
  for (std::size_t i = 0; i < 3; ++i) x[i] = corner[i] + radius_m * facet.n;
  const Vec3 middle = (x[0] + x[1] + x[2]) / 3.0;
  double extent = 0.0;
  for (const Vec3& place : x) extent = std::max(extent, (place - middle).norm());
  const double reach = (most + extent) * kReach;
  proposed.clear();
  // Those with a corner closer than `most` to a corner of P are listed whatever the bounds say: where they are too many
  // already, and on a fine mesh they are on most triangles, no bound need be known.
  const double surely = most * most * (2.0 - kReach);
  std::size_t listed = 0;
  bool complete = true;
  mesh.tree().within(middle, reach, [&](std::int32_t t) {
    if (!complete || t == triangle) return complete ? reach : 0.0;
    complete = proposed.size() < kMostAround;
    proposed.push_back(t);
    const Facet& other = mesh.facet(t);
    const Vec3& corner_of_t = mesh.vertex(other.corner[0]);
    const bool near = std::ranges::any_of(x, [&](const Vec3& at) { return squared_norm(at - corner_of_t) < surely; });
    if (near && !is_zero(other.n)) complete = complete && ++listed <= kMostListed;
    return complete ? reach : 0.0;
  });
  if (!complete) return -1.0;
  for (const std::int32_t t : proposed) {
    const Facet& other = mesh.facet(t);
    if (is_zero(other.n)) continue;
    // All of it is below a plane that is as far from P as the ball's radius, for most.
    double height = -std::numeric_limits<double>::infinity();
    for (const std::int32_t v : other.corner) height = std::max(height, facet.height(mesh.vertex(v)));
    if (height < -spread || plainly_beyond(mesh, other, x, middle, most)) continue;
    const double bound = std::max(radius_m - height, distance_bound(mesh, t, x, middle, most));
    if (bound >= most) continue;
    (bound < least ? lists.on_face : lists.beside).push_back(t);
    if (lists.on_face.size() + lists.beside.size() > kMostListed) return -1.0;
  }
  std::sort(lists.on_face.begin(), lists.on_face.end());
  std::sort(lists.beside.begin(), lists.beside.end());
  return spread;
}

}  // namespace

thread_local bool BallVicinity::OnDemand::wanted_ = false;

BallVicinity::BallVicinity(const ContactMesh& mesh, double radius_m)
    : entries_(mesh.triangle_count()), radius_m_(radius_m) {
  if (OnDemand::wanted_) {
    on_demand_ = &mesh;
    listed_already_.assign(entries_.size(), 0);
  } else {
    list_all(mesh, radius_m);
  }
}

void BallVicinity::list_now(std::int32_t triangle) const noexcept {
  std::vector<std::int32_t> proposed;
  Lists lists;
  listed_already_[static_cast<std::size_t>(triangle)] = 1;
  const double spread = list_vicinity(*on_demand_, triangle, radius_m_, proposed, lists);
  if (!(spread >= 0.0)) return;
  Entry& entry = entries_[static_cast<std::size_t>(triangle)];
  entry.spread_m = std::nextafter(static_cast<float>(spread), 0.0F);  // never rounded up
  entry.first = static_cast<std::uint32_t>(listed_.size());
  entry.on_face = static_cast<std::uint16_t>(lists.on_face.size());
  entry.all = static_cast<std::uint16_t>(lists.on_face.size() + lists.beside.size());
  listed_.insert(listed_.end(), lists.on_face.begin(), lists.on_face.end());
  listed_.insert(listed_.end(), lists.beside.begin(), lists.beside.end());
}

void BallVicinity::list_all(const ContactMesh& mesh, double radius_m) {
  const std::size_t pieces = (entries_.size() + kAtATime - 1) / kAtATime;
  std::vector<std::vector<std::int32_t>> listed(pieces);
  in_parallel(
      pieces,
      [&](std::size_t piece) {
        std::vector<std::int32_t> proposed;
        Lists lists;
        const std::size_t end = std::min(entries_.size(), (piece + 1) * kAtATime);
        for (std::size_t t = piece * kAtATime; t < end; ++t) {
          Entry& entry = entries_[t];
          const double spread = list_vicinity(mesh, static_cast<std::int32_t>(t), radius_m, proposed, lists);
          if (!(spread >= 0.0)) continue;
          // Never rounded up.
          entry.spread_m = std::nextafter(static_cast<float>(spread), 0.0F);
          entry.first = static_cast<std::uint32_t>(listed[piece].size());
          entry.on_face = static_cast<std::uint16_t>(lists.on_face.size());
          entry.all = static_cast<std::uint16_t>(lists.on_face.size() + lists.beside.size());
          listed[piece].insert(listed[piece].end(), lists.on_face.begin(), lists.on_face.end());
          listed[piece].insert(listed[piece].end(), lists.beside.begin(), lists.beside.end());
        }
      },
      1);
  std::size_t count = 0;
  for (const auto& part : listed) count += part.size();
  // Places in the list have 32 bits.
  if (count > std::numeric_limits<std::uint32_t>::max()) {
    entries_.assign(entries_.size(), Entry{});
    return;
  }
  listed_.reserve(count);
  for (std::size_t piece = 0; piece < pieces; ++piece) {
    const auto before = static_cast<std::uint32_t>(listed_.size());
    const std::size_t end = std::min(entries_.size(), (piece + 1) * kAtATime);
    for (std::size_t t = piece * kAtATime; t < end; ++t) entries_[t].first += before;
    listed_.insert(listed_.end(), listed[piece].begin(), listed[piece].end());
    listed[piece] = {};
  }
}

}  // namespace touchstone::renderers
