#include "renderers/ball_constraints.h"

#include <Eigen/LU>
#include <cmath>
#include <limits>
#include <type_traits>

namespace touchstone {
namespace {

constexpr int kNewtonSteps = 16;
constexpr int kFeatureChanges = 6;

// On one triangle: by its face, edge or corner in closed form, until the answer's own closest feature is the one used.
// Both this and newton() answer false where the contact ends up on the triangle's other side.
bool rest_on_one(const ContactMesh& mesh, std::int32_t triangle, double r, const Vec3& p, Vec3& x) noexcept {
  const Facet& facet = mesh.facet(triangle);
  Touch now = touch(mesh, triangle, x);
  const Vec3 before = now.n;
  for (int change = 0; change < kFeatureChanges; ++change) {
    Vec3 next;
    double pull = 0.0;
    if (now.feature == Feature::face) {
      const Vec3& n = now.n;
      pull = r - n.dot(p - facet.origin);
      next = p + pull * n;
    } else {
      Vec3 foot = mesh.vertex(facet.corner[now.index]);
      if (now.feature == Feature::edge) {
        const Vec3 along = mesh.vertex(facet.corner[(now.index + 1U) % 3U]) - foot;
        foot += along.dot(p - foot) / along.squaredNorm() * along;
      }
      const Vec3 out = p - foot;
      const double distance = out.norm();
      // Beyond the edge or corner the nearest place is on its other side: the ball must find its way round it first.
      if (!(out.dot(now.n) > 0.0)) return false;
      pull = r - distance;
      next = foot + (r / distance) * out;
    }
    if (pull < 0.0) return false;
    const Touch then = touch(mesh, triangle, next);
    x = next;
    if (then.feature == now.feature && then.index == now.index) return then.n.dot(before) > 0.0;
    now = then;
  }
  return false;
}

// The second derivative of the distance from an edge or corner.
Mat3 curvature(const ContactMesh& mesh, std::int32_t triangle, const Touch& t) noexcept {
  Mat3 bend = Mat3::Identity() - t.n * t.n.transpose();
  if (t.feature == Feature::edge) {
    const auto& corner = mesh.facet(triangle).corner;
    const Vec3 e = (mesh.vertex(corner[(t.index + 1U) % 3U]) - mesh.vertex(corner[t.index])).normalized();
    bend -= e * e.transpose();
  }
  return bend / t.d;
}

template <int M>
bool newton(const ContactMesh& mesh, const Holding& holding, double r, const Vec3& p, double rounding,
            Vec3& x) noexcept {
  using Multipliers = Eigen::Matrix<double, M, 1>;
  Multipliers l = Multipliers::Zero();
  Eigen::Matrix<double, 3, M> before;  // the normals at the start
  for (int step = 0; step < kNewtonSteps; ++step) {
    Eigen::Matrix<double, 3, M> n;
    Multipliers gap;
    Mat3 k = Mat3::Identity();
    bool bent = false;
    for (int i = 0; i < M; ++i) {
      const std::int32_t triangle = holding.triangle[static_cast<std::size_t>(i)];
      const Touch t = touch(mesh, triangle, x);
      n.col(i) = t.n;
      gap[i] = r - t.d;
      if (step > 0 && t.feature != Feature::face && t.d > 0.0) {
        k -= l[i] * curvature(mesh, triangle, t);
        bent = true;
      }
    }
    if (step == 0) before = n;
    // K dx - N l = p - x, N' dx = gap: eliminate dx. Of planes K is the identity.
    bool solvable = true;
    Mat3 inverse;
    if (bent) k.computeInverseWithCheck(inverse, solvable, 1e-12);
    if (!solvable) return false;
    const auto released = [&](const auto& v) {
      using Released = Eigen::Matrix<double, 3, std::decay_t<decltype(v)>::ColsAtCompileTime>;
      return bent ? Released(inverse * v) : Released(v);
    };
    const Eigen::Matrix<double, M, M> gram = n.transpose() * released(n);
    Eigen::Matrix<double, M, M> gram_inverse;
    gram.computeInverseWithCheck(gram_inverse, solvable, 1e-24);
    if (!solvable) return false;
    const Vec3 pull = p - x;
    l = gram_inverse * (gap - n.transpose() * released(pull));
    const Vec3 dx = released(Vec3(pull + n * l));
    if (!dx.allFinite()) return false;
    // Far steps leave the neighbourhood in which the closest features are what they are.
    const double length = dx.norm();
    const bool far = length > 0.5 * r;
    x += far ? Vec3(0.5 * r / length * dx) : dx;
    // The last normals are those at x but for a step of rounding.
    if (!far && length <= rounding && gap.cwiseAbs().maxCoeff() <= rounding)
      return (l.array() >= 0.0).all() && (n.cwiseProduct(before).colwise().sum().array() > 0.0).all();
  }
  return false;
}

}  // namespace

Touch touch(const ContactMesh& mesh, std::int32_t triangle, const Vec3& x) noexcept {
  const Facet& facet = mesh.facet(triangle);
  const double h = facet.height(x);
  const std::array<double, 3> s{facet.inside(0, x), facet.inside(1, x), facet.inside(2, x)};
  if (s[0] >= 0.0 && s[1] >= 0.0 && s[2] >= 0.0)
    return {h >= 0.0 ? facet.n : Vec3(-facet.n), std::abs(h), Feature::face, 0};
  // The closest point is on an edge that x is outside of, or at one of its ends.
  Touch best{facet.n, 0.0, Feature::vertex, 0};
  Vec3 from = Vec3::Zero();
  double least = std::numeric_limits<double>::infinity();
  for (std::uint8_t e = 0; e < 3; ++e) {
    if (s[e] >= 0.0) continue;
    const auto next = static_cast<std::uint8_t>(e == 2 ? 0 : e + 1);
    const Vec3& start = mesh.vertex(facet.corner[e]);
    const Vec3 along = mesh.vertex(facet.corner[next]) - start;
    const Vec3 out = x - start;
    const double reach = out.dot(along);
    Vec3 here;
    Feature feature = Feature::vertex;
    std::uint8_t index = e;
    if (reach <= 0.0) {
      here = out;
    } else if (reach >= along.squaredNorm()) {
      here = out - along;
      index = next;
    } else {
      here = h * facet.n + s[e] * facet.inward[e];
      feature = Feature::edge;
    }
    if (const double squared = here.squaredNorm(); squared < least) {
      least = squared;
      from = here;
      best.feature = feature;
      best.index = index;
    }
  }
  best.d = std::sqrt(least);
  if (best.d > 0.0) best.n = from / best.d;
  return best;
}

bool rest_on(const ContactMesh& mesh, const Holding& holding, double r, const Vec3& p, double rounding,
             Vec3& x) noexcept {
  if (holding.size == 0) {
    x = p;
    return true;
  }
  if (holding.size == 1) return rest_on_one(mesh, holding.triangle[0], r, p, x);
  return holding.size == 2 ? newton<2>(mesh, holding, r, p, rounding, x) : newton<3>(mesh, holding, r, p, rounding, x);
}

}  // namespace touchstone
