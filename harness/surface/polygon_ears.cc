#include "harness/surface/polygon_ears.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace touchstone::surface::mesh_readers {
namespace {

using Point = Eigen::Vector2d;

// Newell's.
Vec3 facing(std::span<const Vec3> corners) {
  Vec3 normal = Vec3::Zero();
  Vec3 largest = Vec3::Zero();
  for (std::size_t i = 2; i < corners.size(); ++i) {
    const Vec3 one = (corners[i - 1] - corners[0]).cross(corners[i] - corners[0]);
    normal += one;
    if (one.squaredNorm() > largest.squaredNorm()) largest = one;
  }
  // One that crosses itself may face neither way: then as its largest part does.
  constexpr double nothing = 1e-9;
  return normal.norm() > nothing * largest.norm() ? normal : largest;
}

// Twice the area, positive where a, b, c run counter-clockwise.
double turn(const Point& a, const Point& b, const Point& c) {
  return (b.x() - a.x()) * (c.y() - a.y()) - (b.y() - a.y()) * (c.x() - a.x());
}

// Dropped along the largest component of the normal, so that the polygon runs counter-clockwise.
std::vector<Point> flattened(std::span<const Vec3> corners, const Vec3& normal) {
  Eigen::Index drop = 0;
  normal.cwiseAbs().maxCoeff(&drop);
  const Eigen::Index u = (drop + 1) % 3, v = (drop + 2) % 3;
  std::vector<Point> flat;
  for (const Vec3& p : corners) {
    flat.emplace_back(normal[drop] < 0.0 ? p[v] : p[u], normal[drop] < 0.0 ? p[u] : p[v]);
  }
  return flat;
}

class Clipper {
 public:
  explicit Clipper(std::vector<Point> points) : points_(std::move(points)), left_(points_.size()) {
    std::iota(left_.begin(), left_.end(), std::size_t{0});
    Point low = points_.front(), high = points_.front();
    for (const Point& p : points_) low = low.cwiseMin(p), high = high.cwiseMax(p);
    // What text rounded to six digits may turn a corner by.
    rounding_ = 1e-6 * (high - low).squaredNorm();
  }

  Ears run() {
    Ears ears;
    std::size_t at = 0;
    while (left_.size() > 3) {
      std::size_t tried = 0;
      while (tried < left_.size() && !is_ear(at % left_.size())) ++tried, ++at;
      const bool none = tried == left_.size();
      ears.folded = ears.folded || (none && !is_line());
      const std::size_t ear = none ? 0 : at % left_.size();
      ears.triangles.push_back(triangle(ear));
      left_.erase(left_.begin() + static_cast<std::ptrdiff_t>(ear));
      at = ear == 0 ? left_.size() - 1 : ear - 1;
    }
    ears.triangles.push_back({left_[0], left_[1], left_[2]});
    for (const auto& [a, b, c] : ears.triangles) {
      ears.folded = ears.folded || turn(points_[a], points_[b], points_[c]) < -rounding_;
    }
    return ears;
  }

 private:
  [[nodiscard]] std::array<std::size_t, 3> triangle(std::size_t i) const {
    const std::size_t n = left_.size();
    return {left_[(i + n - 1) % n], left_[i], left_[(i + 1) % n]};
  }

  // What is left of a side with corners along it.
  [[nodiscard]] bool is_line() const {
    for (std::size_t i = 0; i < left_.size(); ++i) {
      const auto [a, b, c] = triangle(i);
      if (std::abs(turn(points_[a], points_[b], points_[c])) > rounding_) return false;
    }
    return true;
  }

  [[nodiscard]] bool is_ear(std::size_t i) const {
    const auto [ia, ib, ic] = triangle(i);
    const Point &a = points_[ia], &b = points_[ib], &c = points_[ic];
    if (!(turn(a, b, c) > 0.0)) return false;
    return std::ranges::none_of(left_, [&, ia = ia, ib = ib, ic = ic](std::size_t k) {
      const Point& p = points_[k];
      // A corner that stands twice, where a hole is joined to the rim, is none of the others.
      if (k == ia || k == ib || k == ic || p == a || p == b || p == c) return false;
      return turn(a, b, p) >= 0.0 && turn(b, c, p) >= 0.0 && turn(c, a, p) >= 0.0;
    });
  }

  std::vector<Point> points_;
  std::vector<std::size_t> left_;
  double rounding_ = 0.0;
};

}  // namespace

Ears cut_ears(std::span<const Vec3> corners) { return Clipper(flattened(corners, facing(corners))).run(); }

}  // namespace touchstone::surface::mesh_readers
