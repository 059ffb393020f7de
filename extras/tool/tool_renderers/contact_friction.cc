#include "tool_renderers/contact_friction.h"

#include <Eigen/LU>
#include <algorithm>

namespace touchstone::tool_renderers {
namespace {

// A spring that may pull `longest` at most, in lengths.
struct Returned {
  Vec3 stretch;
  double share;  // of what it was
  bool slips;
};
Returned radial_return(const Vec3& stretch, double longest) {
  const double length = stretch.norm();
  if (!(length > longest)) return {stretch, 1.0, false};
  const double share = longest / length;
  return {share * stretch, share, true};
}

Vec3 tangential(const Vec3& v, const Vec3& n) { return v - n.dot(v) * n; }

}  // namespace

ContactFriction::ContactFriction(std::size_t points, double mu, double stiffness_N_per_m)
    : mu_(mu), stiffness_N_per_m_(stiffness_N_per_m), anchors_(points) {
  touching_.reserve(points);
}

void ContactFriction::reset() noexcept {
  std::ranges::fill(anchors_, Anchor{});
  touching_.clear();
}

void ContactFriction::begin_step() noexcept {
  ++step_;
  touching_.clear();
}

Vec3 ContactFriction::touch(std::int32_t i, const Vec3& p_W_m, const Vec3& r_W_m, const Vec3& n_W,
                            double depth_m) noexcept {
  Anchor& anchor = anchors_[static_cast<std::size_t>(i)];
  if (anchor.step == 0 || anchor.step + 1 != step_) anchor.at_W_m = p_W_m;  // it begins to touch
  anchor.step = step_;
  const Vec3 stretch = radial_return(tangential(p_W_m - anchor.at_W_m, n_W), mu_ * depth_m).stretch;
  anchor.at_W_m = p_W_m - stretch;
  touching_.push_back({r_W_m, n_W, stretch, depth_m});
  return stiffness_N_per_m_ * (depth_m * n_W - stretch);
}

Vec6 ContactFriction::residual(const Mat6& a, const Vec6& b, const Vec6& y, Mat6* slope) const noexcept {
  Vec6 left = a * y - b;
  if (slope != nullptr) *slope = a;
  for (const Touching& point : touching_) {
    const Vec3 way = y.head<3>() + Vec3(y.tail<3>()).cross(point.r);
    const double depth = point.depth - point.n.dot(way);
    if (!(depth > 0.0)) continue;
    const Returned spring = radial_return(point.stretch + tangential(way, point.n), mu_ * depth);
    const Vec3 f = stiffness_N_per_m_ * (depth * point.n - spring.stretch);
    left.head<3>() -= f;
    left.tail<3>() -= point.r.cross(f);
    if (slope == nullptr) continue;
    // -df / d way.
    Mat3 stiff = point.n * point.n.transpose() + spring.share * (Mat3::Identity() - point.n * point.n.transpose());
    if (spring.slips && spring.stretch.squaredNorm() > 0.0) {
      const Vec3 along = spring.stretch.normalized();
      stiff -= spring.share * along * along.transpose() + mu_ * along * point.n.transpose();
    }
    stiff *= stiffness_N_per_m_;
    // J = (1, -[r]x).
    Mat3 arm;
    arm << 0.0, -point.r.z(), point.r.y(), point.r.z(), 0.0, -point.r.x(), -point.r.y(), point.r.x(), 0.0;
    const Mat3 turned = stiff * arm;
    slope->topLeftCorner<3, 3>() += stiff;
    slope->topRightCorner<3, 3>() -= turned;
    slope->bottomLeftCorner<3, 3>().noalias() += arm * stiff;
    slope->bottomRightCorner<3, 3>().noalias() -= arm * turned;
  }
  return left;
}

Vec6 ContactFriction::displacement(const Mat6& a, const Vec6& b) const noexcept {
  constexpr int most_rounds = 20;
  constexpr int most_halvings = 6;
  constexpr double still = 1e-12;  // of the longest way so far
  Vec6 y = Vec6::Zero();
  Mat6 slope;
  Vec6 left = residual(a, b, y, &slope);
  // In which residuals are measured: of a step of A alone, so that newtons and newton metres compare.
  const Vec6 weight = a.diagonal().cwiseInverse().cwiseSqrt();
  const auto size_of = [&](const Vec6& r) { return r.cwiseProduct(weight).squaredNorm(); };
  // What the sum of the terms is off by: below it no step makes the residual smaller.
  constexpr double rounding_share = 1e-13;
  const double scale = size_of(b);
  for (int round = 0; round < most_rounds && size_of(left) > rounding_share * rounding_share * scale; ++round) {
    const Vec6 by = Eigen::PartialPivLU<Mat6>(slope).solve(-left);
    // The whole step, or the longest share of it that makes the residual smaller; the whole one where none does: sets
    // of points that slip change, and the residual may have to grow first.
    double share = 1.0;
    const double here = size_of(left);
    int halvings = 0;
    while (halvings < most_halvings && !(size_of(residual(a, b, y + share * by, nullptr)) < here)) {
      share *= 0.5;
      ++halvings;
    }
    if (halvings == most_halvings) share = 1.0;
    y += share * by;
    if (share == 1.0 && by.norm() <= still * y.norm()) break;
    left = residual(a, b, y, &slope);
  }
  return y;
}

std::size_t ContactFriction::memory_bytes() const noexcept {
  return anchors_.capacity() * sizeof(Anchor) + touching_.capacity() * sizeof(Touching);
}

}  // namespace touchstone::tool_renderers
