#include "synthetic/surfaces/extrusion.h"

#include <algorithm>
#include <cmath>

#include "synthetic/surfaces/crossing.h"

namespace touchstone::synthetic {
using surface::Feature;

namespace {

std::vector<Corner> with_floor(std::vector<Corner> top, double floor_z_m) {
  const double right = top.front().p.x();
  const double left = top.back().p.x();
  top.push_back({{left, floor_z_m}});
  top.push_back({{right, floor_z_m}});
  return top;
}

// Joins the strips of a block: rows of vertices along y for every point of an outline.
class BlockMesh {
 public:
  BlockMesh(double half_width_m, std::size_t strips) : half_width_m_(half_width_m), strips_(strips) {}

  // Index of the row of vertices above (s, z).
  std::int32_t add_row(const Vec2& p) {
    const auto row = static_cast<std::int32_t>(mesh.vertices_W_m.size());
    for (std::size_t j = 0; j <= strips_; ++j) {
      const double y = half_width_m_ * (2.0 * static_cast<double>(j) / static_cast<double>(strips_) - 1.0);
      mesh.vertices_W_m.emplace_back(p.x(), y, p.y());
    }
    return row;
  }
  // The strip whose outline runs from a to b, outside on the right.
  void add_strip(std::int32_t a, std::int32_t b) {
    for (std::int32_t j = 0; j < static_cast<std::int32_t>(strips_); ++j) {
      // Alternating diagonals: no direction is preferred.
      if (j % 2 == 0) {
        mesh.triangles.push_back({a + j, b + j + 1, b + j});
        mesh.triangles.push_back({a + j, a + j + 1, b + j + 1});
      } else {
        mesh.triangles.push_back({a + j, a + j + 1, b + j});
        mesh.triangles.push_back({b + j, a + j + 1, b + j + 1});
      }
    }
  }
  // The triangle (a, b, c) of the outline, counter-clockwise in x and z, on both caps.
  void add_cap(std::int32_t a, std::int32_t b, std::int32_t c) {
    const auto far = static_cast<std::int32_t>(strips_);
    mesh.triangles.push_back({a, b, c});
    mesh.triangles.push_back({a + far, c + far, b + far});
  }

  surface::TriangleMesh mesh;

 private:
  double half_width_m_;
  std::size_t strips_;
};

// All rows at one x: one where the top is a graph, several where it is an upright wall.
struct Column {
  std::int32_t floor;
  std::vector<std::int32_t> rows;  // in the order of the outline
  double first_z, last_z;
};

// Top, floor and caps between neighbouring columns. The caps take in the points of a wall only on its open side.
void add_slice(BlockMesh& block, const Column& right, const Column& left) {
  block.add_strip(right.rows.back(), left.rows.front());
  block.add_strip(left.floor, right.floor);
  std::int32_t last = right.rows.back();
  if (right.last_z > right.first_z) {
    last = right.rows.front();
    for (std::size_t i = 1; i < right.rows.size(); ++i) block.add_cap(left.floor, right.rows[i - 1], right.rows[i]);
  }
  block.add_cap(left.floor, right.floor, last);
  const std::int32_t corner = right.rows.back();
  if (left.last_z < left.first_z) {
    for (std::size_t i = 1; i < left.rows.size(); ++i) block.add_cap(corner, left.rows[i - 1], left.rows[i]);
    block.add_cap(corner, left.rows.back(), left.floor);
  } else {
    block.add_cap(corner, left.rows.front(), left.floor);
  }
}

}  // namespace

Extrusion::Extrusion(const std::vector<Corner>& top, double floor_z_m, double half_width_m)
    : top_(Profile::through(top, false)),
      outline_(Profile::through(with_floor(top, floor_z_m), true)),
      floor_z_m_(floor_z_m),
      half_width_m_(half_width_m) {}

surface::SurfacePoint Extrusion::closest(const Vec3& p) const {
  const ProfilePoint side = outline_.closest({p.x(), p.z()});
  const double beyond = std::abs(p.y()) - half_width_m_;
  const double cap_sign = p.y() < 0.0 ? -1.0 : 1.0;
  const Vec3 side_normal(side.n.x(), 0.0, side.n.y());
  const Vec3 cap_normal(0.0, cap_sign, 0.0);
  if (beyond > 0.0 && side.signed_distance > 0.0) {
    const Vec3 q(side.p.x(), cap_sign * half_width_m_, side.p.y());
    return analytic_point(q, (side_normal + cap_normal).normalized(), (p - q).norm(),
                          side.corner ? Feature::vertex : Feature::edge);
  }
  if (side.signed_distance > 0.0 || (beyond <= 0.0 && side.signed_distance >= beyond)) {
    return analytic_point({side.p.x(), p.y(), side.p.y()}, side_normal, side.signed_distance,
                          side.corner ? Feature::edge : Feature::analytic);
  }
  return analytic_point({p.x(), cap_sign * half_width_m_, p.z()}, cap_normal, beyond);
}

std::optional<surface::Crossing> Extrusion::first_crossing(const Vec3& a, const Vec3& b) const {
  CrossingCandidates candidates;
  const Vec2 from(a.x(), a.z());
  const Vec2 along(b.x() - a.x(), b.z() - a.z());
  for (const double cap : {-half_width_m_, half_width_m_}) candidates.offer_quadratic(a.y() - cap, b.y() - a.y(), 0.0);
  for (const ProfileElement& e : outline_.elements()) {
    const Vec2 offset = from - (e.is_arc ? e.centre : e.start);
    if (e.is_arc) {
      candidates.offer_quadratic(offset.squaredNorm() - e.radius * e.radius, 2.0 * offset.dot(along),
                                 along.squaredNorm());
    } else {
      candidates.offer_quadratic(offset.dot(e.normal), along.dot(e.normal), 0.0);
    }
  }
  return candidates.first(*this, a, b);
}

Box3 Extrusion::bounds() const {
  Box3 box;
  for (const ProfileElement& e : outline_.elements()) {
    for (const double y : {-half_width_m_, half_width_m_}) box.extend(Vec3(e.start.x(), y, e.start.y()));
    // A fillet bulges less than its corner, which a box of its ends may still miss: add its extreme points.
    for (const Vec2& axis : {Vec2(0, 1), Vec2(1, 0), Vec2(0, -1), Vec2(-1, 0)}) {
      if (e.is_arc && outline_.closest(e.centre + 2.0 * e.radius * axis).p.isApprox(e.centre + e.radius * axis)) {
        const Vec2 p = e.centre + e.radius * axis;
        box.extend(Vec3(p.x(), 0.0, p.y()));
      }
    }
  }
  return box;
}

Tessellation Extrusion::tessellate(std::size_t triangles) const {
  // Top and bottom carry 2 n m triangles each; squares on the top where the count allows.
  const double quads = static_cast<double>(triangles) / 4.0;
  const double aspect = top_.length() / (2.0 * half_width_m_);
  const auto samples = top_.sample(static_cast<std::size_t>(std::max(1.0, std::round(std::sqrt(quads * aspect)))));
  const std::vector<Vec2>& top = samples.points;
  const double strips = std::round((quads - 1.0) / (static_cast<double>(top.size()) + 1.0));
  BlockMesh block(half_width_m_, static_cast<std::size_t>(std::max(1.0, strips)));
  std::vector<Column> columns;
  double x = top.front().x();
  for (std::size_t i = 0; i < top.size(); ++i) {
    // Rounding on a fillet that ends upright must not make an overhang.
    const Vec2 p(std::min(x, top[i].x()), top[i].y());
    if (i == 0 || p.x() < x) columns.push_back({block.add_row({p.x(), floor_z_m_}), {}, p.y(), p.y()});
    x = p.x();
    columns.back().rows.push_back(block.add_row(p));
    columns.back().last_z = p.y();
  }
  block.add_strip(columns.front().floor, columns.front().rows.front());  // the right wall
  for (std::size_t c = 0; c < columns.size(); ++c) {
    const Column& column = columns[c];
    for (std::size_t i = 1; i < column.rows.size(); ++i) block.add_strip(column.rows[i - 1], column.rows[i]);
    if (c + 1 < columns.size()) add_slice(block, column, columns[c + 1]);
  }
  block.add_strip(columns.back().rows.back(), columns.back().floor);  // the left wall
  return {std::move(block.mesh), samples.sagitta};
}

}  // namespace touchstone::synthetic
