// A spring from the closest surface point to the tip, without memory: the vector-field method that Zilles and Salisbury
// (1995, section 2) describe and argue against. The penalty renderer and the two springs of the second paper are this,
// with different laws. Templates over the scalar, so that their operations can be counted (harness/base/counted.h).
//
// Where several surface points are equally close to rounding (on the medial axis: H. Blum, 1967), the one on the side
// where the last foot was is taken, not the one of the smaller index. That is all that is remembered.
// Beyond the rim of an open mesh there is no inside, and no force: a tip in a sheet's plane is as free on either side.
#pragma once

#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <type_traits>
#include <utility>

#include "harness/base/vec.h"
#include "harness/rendering/renderer.h"
#include "harness/surface/mesh_topology.h"
#include "harness/surface/surface.h"
#include "renderers/friction/fixed_order.h"

namespace touchstone::renderers {

// What a closest-point query answers, see SurfacePoint.
template <class S>
struct Foot {
  Vec3Of<S> p_W_m;
  Vec3Of<S> n_W;
  S signed_distance_m;
  bool smooth;  // not on an edge or at a vertex: the normal is the way out
};

template <class S>
struct SpringPush {
  Vec3Of<S> f_W_N = Vec3Of<S>::Zero();
  Vec3Of<S> contact_W_m;
  Vec3Of<S> n_W = Vec3Of<S>::Zero();
  S depth_m = S(0.0);
  bool contact = false;
};

// F = k d^power along the way out, d how deep the tip (a point, or a ball of that radius) is. The way out is the
// surface's normal where the surface is smooth; at an edge or a vertex it is from the tip to the foot where the tip is
// inside, and from the foot to the tip where only the ball reaches in. The surface contact point is the foot; for a
// ball, where its centre would be free.
template <int power, class S>
SpringPush<S> push_out(const Foot<S>& foot, const Vec3Of<S>& tip_W_m, const S& k, const S& radius_m) noexcept {
  using std::sqrt;
  SpringPush<S> push;
  push.contact_W_m = tip_W_m;
  if (!(foot.signed_distance_m < radius_m)) return push;
  push.contact = true;
  push.depth_m = radius_m - foot.signed_distance_m;
  push.n_W = foot.n_W;
  if (!foot.smooth) {
    const Vec3Of<S> way =
        foot.signed_distance_m < S(0.0) ? Vec3Of<S>(foot.p_W_m - tip_W_m) : Vec3Of<S>(tip_W_m - foot.p_W_m);
    const S square = squared_norm(way);
    if (square > S(0.0)) push.n_W = way / sqrt(square);
  }
  S force_N = k * push.depth_m;
  if constexpr (power == 2) force_N *= push.depth_m;
  push.f_W_N = force_N * push.n_W;
  push.contact_W_m = radius_m > S(0.0) ? Vec3Of<S>(tip_W_m + push.depth_m * push.n_W) : foot.p_W_m;
  return push;
}

// Whether the edge or corner lies on an edge that no other triangle has.
bool on_rim(const surface::MeshTopology& topology, const surface::TriangleMesh& mesh, std::size_t triangle,
            surface::Feature feature, std::size_t index) noexcept;
// `point` is the closest to p_W_m.
bool on_rim(const surface::Surface& surface, const surface::SurfacePoint& point, const Vec3& p_W_m) noexcept;

// Asks a surface.
class SurfaceFeet {
 public:
  using Scalar = double;
  explicit SurfaceFeet(std::shared_ptr<const surface::Surface> surface) : surface_(std::move(surface)) {}
  [[nodiscard]] Foot<double> closest(const Vec3& p_W_m) const {
    const surface::SurfacePoint point = surface_->closest(p_W_m);
    const bool smooth = point.feature == surface::Feature::face || point.feature == surface::Feature::analytic;
    const bool beyond_rim = point.signed_distance_m < 0.0 && !smooth && on_rim(*surface_, point, p_W_m);
    return {point.p_W_m, point.n_W, beyond_rim ? point.distance_m : point.signed_distance_m, smooth};
  }

 private:
  std::shared_ptr<const surface::Surface> surface_;
};

// `Feet` answers closest(Vec3Of<Feet::Scalar>) with a Foot.
template <int power, class Feet>
class ClosestSpring final : public rendering::Renderer {
 public:
  ClosestSpring(Feet feet, double k, double radius_m) : feet_(std::move(feet)), k_(k), radius_m_(radius_m) {}

  [[nodiscard]] std::optional<std::size_t> memory_bytes() const noexcept override { return 0; }

 private:
  using S = typename Feet::Scalar;

  void do_reset() override { touched_ = false; }

  // The foot at p, of equally close ones that on the side of the last.
  [[nodiscard]] Foot<S> foot_at(const Vec3Of<S>& p_W_m) noexcept {
    Foot<S> foot = feet_.closest(p_W_m);
    const Vec3 tip = p_W_m.template cast<double>();
    const Vec3 at = foot.p_W_m.template cast<double>();
    // Asked in plain numbers, since that is no part of the method: did the foot jump though the side where it was is as
    // close? That side is treated as flat; the second query decides.
    const double depth_m = (at - tip).norm();
    if (touched_ && static_cast<double>(foot.signed_distance_m) < static_cast<double>(radius_m_) &&
        (at - last_foot_).norm() > jump * (tip - last_tip_).norm() + near * depth_m &&
        std::abs(std::abs(last_n_.dot(tip - last_foot_)) - depth_m) <= near * depth_m) {
      const Vec3Of<S> aside = p_W_m + S(near) * (last_foot_.template cast<S>() - p_W_m);
      Foot<S> other = feet_.closest(aside);
      const S distance = norm(Vec3Of<S>(other.p_W_m - p_W_m));
      if (static_cast<double>(distance) - depth_m <= rounded * (at.norm() + tip.norm())) {
        other.signed_distance_m = other.signed_distance_m < S(0.0) ? S(-distance) : distance;
        foot = other;
      }
    }
    touched_ = true;
    last_tip_ = tip;
    last_foot_ = foot.p_W_m.template cast<double>();
    last_n_ = foot.n_W.template cast<double>();
    return foot;
  }

  rendering::StepResult do_step(const rendering::TipState& tip) noexcept override {
    const Vec3Of<S> p_W_m = tip.p_W_m.template cast<S>();
    const SpringPush<S> push = push_out<power, S>(foot_at(p_W_m), p_W_m, k_, radius_m_);
    rendering::StepResult result;
    result.contact = push.contact;
    result.f_W_N = push.f_W_N.template cast<double>();
    result.contact_W_m = push.contact_W_m.template cast<double>();
    result.n_W = push.n_W.template cast<double>();
    result.depth_m = static_cast<double>(push.depth_m);
    return result;
  }

  static constexpr double jump = 2.0;   // of the tip's own way; a foot goes as far as the tip over what is flat
  static constexpr double near = 1e-9;  // of the depth: more than rounding, less than anything else
  static constexpr double rounded = 16.0 * std::numeric_limits<double>::epsilon();

  Feet feet_;
  S k_;
  S radius_m_;
  bool touched_ = false;
  Vec3 last_tip_ = Vec3::Zero();
  Vec3 last_foot_ = Vec3::Zero();
  Vec3 last_n_ = Vec3::Zero();
};

template <int power, class Feet>
std::unique_ptr<rendering::Renderer> make_closest_spring(std::shared_ptr<const surface::Surface> surface, double k,
                                                         double radius_m) {
  if constexpr (std::is_constructible_v<Feet, std::shared_ptr<const surface::Surface>>) {
    return std::make_unique<ClosestSpring<power, Feet>>(Feet(std::move(surface)), k, radius_m);
  } else {
    return std::make_unique<ClosestSpring<power, Feet>>(Feet(*surface), k, radius_m);
  }
}

}  // namespace touchstone::renderers
