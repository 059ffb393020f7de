// A smooth closed body that is star-shaped about the origin: |p| = rho(p / |p|). The closest point is found by Newton's
// method on its two parameters, safeguarded, from every patch of the body that could hold it: patches are cells of a
// cube projected on the sphere, in a tree with bounding balls. Distance: to rounding where the closest point is simple.
#pragma once

#include <memory>
#include <vector>

#include "synthetic/surfaces/analytic_surface.h"

namespace touchstone::synthetic {

// rho and its derivatives in the three coordinates of u, as an ordinary function of space at a unit vector u.
struct RadialJet {
  double value;
  Vec3 gradient;
  Mat3 hessian;
};

class RadialFunction {
 public:
  virtual ~RadialFunction() = default;
  [[nodiscard]] virtual RadialJet jet(const Vec3& u) const = 0;
  [[nodiscard]] virtual double value(const Vec3& u) const { return jet(u).value; }
};

class RadialBody final : public AnalyticSurface {
 public:
  explicit RadialBody(std::unique_ptr<const RadialFunction> rho_m);

  [[nodiscard]] surface::SurfacePoint closest(const Vec3& p_W_m) const override;
  [[nodiscard]] std::optional<surface::Crossing> first_crossing(const Vec3& a_W_m, const Vec3& b_W_m) const override;
  [[nodiscard]] Box3 bounds() const override { return bounds_; }
  [[nodiscard]] Tessellation tessellate(std::size_t triangles) const override;
  [[nodiscard]] bool closed() const noexcept override { return true; }

  // The point in direction u and the outward normal there.
  [[nodiscard]] Vec3 point_W_m(const Vec3& u) const { return rho_m_->value(u) * u; }
  [[nodiscard]] Vec3 normal_W(const Vec3& u) const;
  // The largest principal curvature towards the outside (concave, 1/m, >= 0) and towards the inside (convex), over a
  // fine sample of directions: a ball of a radius below 1/concave touches everywhere in one point only.
  struct Curvature {
    double concave_per_m;
    double convex_per_m;
  };
  [[nodiscard]] Curvature largest_curvature() const;

 private:
  static constexpr int levels = 5;  // 6 x 4^5 leaves
  struct Ball {
    Vec3 centre_W_m;
    double radius_m;
  };
  struct Best;
  void search(const Vec3& p, int level, std::size_t node, Best& best) const;
  void refine(const Vec3& p, Vec3 u, Best& best) const;

  std::unique_ptr<const RadialFunction> rho_m_;
  std::vector<std::vector<Ball>> tree_;  // by level, children of node i at 4 i
  std::vector<Vec3> leaf_directions_;
  double least_radius_m_ = 0.0;
  double second_bound_per_m_ = 0.0;  // of |p| - rho(p/|p|) where |p| >= least_radius_m_ / 2
  Box3 bounds_;
};

}  // namespace touchstone::synthetic
