#include "synthetic/surfaces/radial_body.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "synthetic/surfaces/icosphere.h"
#include "synthetic/surfaces/roots.h"

namespace touchstone::synthetic {
using surface::Crossing;

namespace {

// Node `index` of `level` as a square on a face of the cube: Morton order, so that children are 4 i .. 4 i + 3.
struct Cell {
  std::size_t face;
  double x, y, side;  // in [-1, 1]
};

Cell cell_of(int level, std::size_t index) {
  const std::size_t per_face = std::size_t{1} << (2 * level);
  std::size_t code = index % per_face;
  Cell cell{index / per_face, -1.0, -1.0, 2.0 / static_cast<double>(1 << level)};
  for (double step = cell.side; code != 0; code >>= 2, step *= 2.0) {
    if (code & 1) cell.x += step;
    if (code & 2) cell.y += step;
  }
  return cell;
}

Vec3 direction_at(std::size_t face, double x, double y) {
  // Equal angles, so that cells near the cube's corners are not much smaller.
  const double a = std::tan(0.25 * std::numbers::pi * x);
  const double b = std::tan(0.25 * std::numbers::pi * y);
  const double s = face % 2 == 0 ? 1.0 : -1.0;
  const std::size_t axis = face / 2;
  Vec3 d;
  d[static_cast<Eigen::Index>(axis)] = s;
  d[static_cast<Eigen::Index>((axis + 1) % 3)] = a;
  d[static_cast<Eigen::Index>((axis + 2) % 3)] = b;
  return d.normalized();
}

// The body near direction u in tangent coordinates (a, b): q(a, b) = rho(w) w, w = (u + a e1 + b e2) / |...|.
struct Patch {
  Vec3 e1, e2;
  Vec3 q, q_a, q_b, q_aa, q_ab, q_bb;
};

Patch patch_at(const Vec3& u, const RadialJet& rho) {
  Patch s;
  s.e1 = u.unitOrthogonal();
  s.e2 = u.cross(s.e1);
  const double r_a = rho.gradient.dot(s.e1);
  const double r_b = rho.gradient.dot(s.e2);
  const double radial = rho.gradient.dot(u);
  const Vec3 h1 = rho.hessian * s.e1;
  const double r_aa = s.e1.dot(h1) - radial;
  const double r_ab = s.e2.dot(h1);
  const double r_bb = s.e2.dot(rho.hessian * s.e2) - radial;
  s.q = rho.value * u;
  s.q_a = r_a * u + rho.value * s.e1;
  s.q_b = r_b * u + rho.value * s.e2;
  s.q_aa = (r_aa - rho.value) * u + 2.0 * r_a * s.e1;
  s.q_ab = r_ab * u + r_a * s.e2 + r_b * s.e1;
  s.q_bb = (r_bb - rho.value) * u + 2.0 * r_b * s.e2;
  return s;
}

// The size of the second derivatives of rho(p/|p|) at |p| = 1 (Frobenius norm).
double angular_bend(const Vec3& u, const RadialJet& rho) {
  const double radial = rho.gradient.dot(u);
  const Vec3 tangential = rho.gradient - radial * u;
  const Mat3 flat = Mat3::Identity() - u * u.transpose();
  return (flat * rho.hessian * flat - radial * flat - u * tangential.transpose() - tangential * u.transpose()).norm();
}

// Bounds the second derivatives of |p| - rho(p/|p|) where |p| >= radius: those of rho fall off with 1/|p|^2, those of
// |p| with 1/|p|. The margin covers what lies between the sampled directions.
double second_bound(double bend, double radius_m) {
  constexpr double margin = 1.5;
  return margin * bend / (radius_m * radius_m) + 1.0 / radius_m;
}

// The principal curvatures, the smaller one first: the eigenvalues of the second fundamental form S relative to the
// first one F (do Carmo, Differential Geometry of Curves and Surfaces, section 3.3), which are those of the symmetric
// L^-1 S L^-T with F = L L^T. Of a symmetric 2 x 2 matrix they are its mean diagonal -+ a length, which keeps its
// digits where both are nearly alike, as on a sphere.
std::array<double, 2> principal_curvatures(const Eigen::Matrix2d& first, const Eigen::Matrix2d& second) {
  const double l00 = std::sqrt(first(0, 0));
  const double l10 = first(1, 0) / l00;
  const double l11 = std::sqrt(first(1, 1) - l10 * l10);
  const double a = second(0, 0) / (l00 * l00);
  const double b = (second(1, 0) / l00 - l10 * a) / l11;
  const double c = (second(1, 1) - l10 * (2.0 * second(1, 0) / l00 - l10 * a)) / (l11 * l11);
  const double away = std::hypot(0.5 * (a - c), b);
  return {0.5 * (a + c) - away, 0.5 * (a + c) + away};
}

}  // namespace

struct RadialBody::Best {
  Vec3 u;
  Vec3 q;
  double distance;
};

RadialBody::RadialBody(std::unique_ptr<const RadialFunction> rho_m) : rho_m_(std::move(rho_m)) {
  constexpr int grid = 4;  // samples along a leaf's side, ends included: grid + 1
  tree_.resize(levels + 1);
  const std::size_t leaves = std::size_t{6} << (2 * levels);
  double greatest = 0.0;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < leaves; ++i) {
    const Cell cell = cell_of(levels, i);
    const Vec3 middle = direction_at(cell.face, cell.x + 0.5 * cell.side, cell.y + 0.5 * cell.side);
    const Vec3 centre = point_W_m(middle);
    double radius = 0.0;
    for (int k = 0; k < (grid + 1) * (grid + 1); ++k) {
      const int row = k / (grid + 1);
      const int column = k % (grid + 1);
      const Vec3 u = direction_at(cell.face, cell.x + cell.side * column / grid, cell.y + cell.side * row / grid);
      const Vec3 q = point_W_m(u);
      radius = std::max(radius, (q - centre).norm());
      least = std::min(least, q.norm());
      greatest = std::max(greatest, q.norm());
      bounds_.extend(q);
    }
    tree_[levels].push_back({centre, radius * (1.0 + 0.25 / grid)});
    leaf_directions_.push_back(middle);
  }
  for (int level = levels - 1; level >= 0; --level) {
    const auto& children = tree_[static_cast<std::size_t>(level) + 1];
    for (std::size_t i = 0; i < children.size(); i += 4) {
      Ball ball{Vec3::Zero(), 0.0};
      for (std::size_t k = i; k < i + 4; ++k) ball.centre_W_m += 0.25 * children[k].centre_W_m;
      for (std::size_t k = i; k < i + 4; ++k) {
        ball.radius_m =
            std::max(ball.radius_m, (children[k].centre_W_m - ball.centre_W_m).norm() + children[k].radius_m);
      }
      tree_[static_cast<std::size_t>(level)].push_back(ball);
    }
  }
  least_radius_m_ = least;
  double second = 0.0;
  for (const Vec3& u : leaf_directions_) second = std::max(second, angular_bend(u, rho_m_->jet(u)));
  second_bound_per_m_ = second_bound(second, 0.5 * least_radius_m_);
  const Vec3 pad = Vec3::Constant(0.01 * greatest);
  bounds_ = Box3(bounds_.min() - pad, bounds_.max() + pad);
}

Vec3 RadialBody::normal_W(const Vec3& u) const {
  const RadialJet rho = rho_m_->jet(u);
  // The gradient of |p| - rho(p/|p|) times |p|.
  return (rho.value * u - (rho.gradient - rho.gradient.dot(u) * u)).normalized();
}

void RadialBody::refine(const Vec3& p, Vec3 u, Best& best) const {
  Patch s = patch_at(u, rho_m_->jet(u));
  double squared = (s.q - p).squaredNorm();
  int polishing = 0;
  for (int i = 0; i < 60 && polishing < 3; ++i) {
    const Vec3 d = s.q - p;
    const Eigen::Vector2d gradient(d.dot(s.q_a), d.dot(s.q_b));
    Eigen::Matrix2d first;
    first << s.q_a.squaredNorm(), s.q_a.dot(s.q_b), s.q_a.dot(s.q_b), s.q_b.squaredNorm();
    Eigen::Matrix2d hessian;
    hessian << d.dot(s.q_aa), d.dot(s.q_ab), d.dot(s.q_ab), d.dot(s.q_bb);
    hessian += first;
    // Where the distance is not convex, Gauss-Newton still descends.
    const bool convex = hessian.determinant() > 0.0 && hessian(0, 0) > 0.0;
    Eigen::Vector2d step = -(convex ? hessian : first).inverse() * gradient;
    const double length = step.norm();
    if (!(length <= 0.3)) step *= 0.3 / length;
    // The distance is flat at its minimum: within the square root of rounding it no longer tells better from worse, but
    // the gradient does. The last Newton steps go unchecked.
    const bool last = convex && length < 1e-6;
    polishing += last ? 1 : 0;
    bool moved = false;
    for (int halvings = 0; halvings < 30 && !moved; ++halvings, step *= 0.5) {
      const Vec3 next = (u + step.x() * s.e1 + step.y() * s.e2).normalized();
      const Patch there = patch_at(next, rho_m_->jet(next));
      const double there_squared = (there.q - p).squaredNorm();
      if (last || there_squared < squared) {
        u = next;
        s = there;
        squared = there_squared;
        moved = true;
      }
    }
    if (!moved) break;
  }
  const double distance = std::sqrt(squared);
  if (distance < best.distance) best = {u, s.q, distance};
}

void RadialBody::search(const Vec3& p, int level, std::size_t node, Best& best) const {
  const auto lower = [&](int l, std::size_t i) {
    const Ball& ball = tree_[static_cast<std::size_t>(l)][i];
    return (p - ball.centre_W_m).norm() - ball.radius_m;
  };
  if (lower(level, node) >= best.distance) return;
  if (level == levels) {
    refine(p, leaf_directions_[node], best);
    return;
  }
  std::array<std::pair<double, std::size_t>, 4> order;
  for (std::size_t k = 0; k < 4; ++k) order[k] = {lower(level + 1, 4 * node + k), 4 * node + k};
  std::sort(order.begin(), order.end());
  for (const auto& [bound, child] : order) {
    if (bound < best.distance) search(p, level + 1, child, best);
  }
}

surface::SurfacePoint RadialBody::closest(const Vec3& p) const {
  const double r = p.norm();
  const Vec3 u = r > 0.0 ? Vec3(p / r) : Vec3(Vec3::UnitZ());
  Best best{u, Vec3::Zero(), std::numeric_limits<double>::infinity()};
  refine(p, u, best);
  for (std::size_t face = 0; face < tree_[0].size(); ++face) search(p, 0, face, best);
  const bool inside = r < rho_m_->value(u);
  const double distance = inside ? -best.distance : best.distance;
  return analytic_point(best.q, searched_normal(p, best.q, normal_W(best.u), distance, second_bound_per_m_), distance);
}

std::optional<Crossing> RadialBody::first_crossing(const Vec3& a, const Vec3& b) const {
  const Vec3 d = b - a;
  // Inside half of the least radius there is no surface, only directions that turn ever faster: the segment is cut
  // there.
  const double inner = 0.5 * least_radius_m_;
  const double mid = d.squaredNorm() > 0.0 ? -a.dot(d) / d.squaredNorm() : 0.0;
  const double off2 = (a + mid * d).squaredNorm();
  std::array<std::pair<double, double>, 2> pieces{{{0.0, 1.0}, {1.0, 1.0}}};
  if (off2 < inner * inner) {
    const double half = std::sqrt((inner * inner - off2) / d.squaredNorm());
    pieces = {{{0.0, std::min(1.0, mid - half)}, {std::max(0.0, mid + half), 1.0}}};
  }
  const auto f = [&](double t) {
    const Vec3 p = a + t * d;
    const double r = p.norm();
    const Vec3 u = p / r;
    const RadialJet rho = rho_m_->jet(u);
    const Vec3 turning = (d - d.dot(u) * u) / r;
    return Jet1{r - rho.value, d.dot(u) - rho.gradient.dot(turning)};
  };
  const double noise = 8.0 * std::numeric_limits<double>::epsilon() * std::max(a.norm(), b.norm());
  std::optional<Crossing> crossing;
  for (const auto& [from, to] : pieces) {
    if (crossing || !(to > from)) continue;
    visit_sign_changes(f, from, to, second_bound_per_m_ * d.squaredNorm(), noise, [&](double t, bool downward) {
      const Vec3 p = a + t * d;
      const Vec3 u = p.normalized();
      crossing = Crossing{t, point_W_m(u), normal_W(u), downward, -1};
      return true;
    });
  }
  return crossing;
}

Tessellation RadialBody::tessellate(std::size_t triangles) const {
  Tessellation result{icosphere(triangles, [this](const Vec3& u) { return rho_m_->value(u); }), 0.0};
  // f = |p| - rho(p/|p|) vanishes at the corners, so inside a triangle |f| <= |f''| R^2 / 2 with R^2 <= L^2 / 3, and
  // the surface is at most |f| away along the ray.
  for (const auto& t : result.mesh.triangles) {
    const std::array<Vec3, 3> v{result.mesh.vertices_W_m[static_cast<std::size_t>(t[0])],
                                result.mesh.vertices_W_m[static_cast<std::size_t>(t[1])],
                                result.mesh.vertices_W_m[static_cast<std::size_t>(t[2])]};
    const double edge2 =
        std::max({(v[1] - v[0]).squaredNorm(), (v[2] - v[1]).squaredNorm(), (v[0] - v[2]).squaredNorm()});
    const double nearest = std::min({v[0].norm(), v[1].norm(), v[2].norm()});
    const Vec3 u = (v[0] + v[1] + v[2]).normalized();
    const double bound = second_bound(angular_bend(u, rho_m_->jet(u)), nearest) * edge2 / 6.0;
    result.deviation_bound_m = std::max(result.deviation_bound_m, bound);
  }
  return result;
}

RadialBody::Curvature RadialBody::largest_curvature() const {
  Curvature largest{0.0, 0.0};
  for (const Vec3& u : leaf_directions_) {
    const Patch s = patch_at(u, rho_m_->jet(u));
    const Vec3 n = s.q_a.cross(s.q_b).normalized();
    const Vec3 outward = n.dot(u) < 0.0 ? Vec3(-n) : n;
    Eigen::Matrix2d first;
    first << s.q_a.squaredNorm(), s.q_a.dot(s.q_b), s.q_a.dot(s.q_b), s.q_b.squaredNorm();
    Eigen::Matrix2d second;
    second << s.q_aa.dot(outward), s.q_ab.dot(outward), s.q_ab.dot(outward), s.q_bb.dot(outward);
    const auto [smaller, larger] = principal_curvatures(first, second);
    largest.concave_per_m = std::max(largest.concave_per_m, larger);
    largest.convex_per_m = std::max(largest.convex_per_m, -smaller);
  }
  return largest;
}

}  // namespace touchstone::synthetic
