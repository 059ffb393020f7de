// An analytic surface turned and moved: awkward poses for tests, so that nothing passes because it is aligned with the
// axes.
#pragma once

#include <memory>

#include "synthetic/surfaces/analytic_surface.h"

namespace touchstone::synthetic {

class PosedSurface final : public AnalyticSurface {
 public:
  // A point b of the body is at rotation * b + shift_m.
  PosedSurface(std::shared_ptr<const AnalyticSurface> body, const Quat& rotation, const Vec3& shift_m)
      : body_(std::move(body)), rotation_(rotation.normalized().toRotationMatrix()), shift_m_(shift_m) {}

  [[nodiscard]] surface::SurfacePoint closest(const Vec3& p_W_m) const override;
  [[nodiscard]] std::optional<surface::Crossing> first_crossing(const Vec3& a_W_m, const Vec3& b_W_m) const override;
  [[nodiscard]] Box3 bounds() const override;
  [[nodiscard]] Tessellation tessellate(std::size_t triangles) const override;
  [[nodiscard]] bool closed() const noexcept override { return body_->closed(); }

 private:
  [[nodiscard]] Vec3 to_body(const Vec3& p_W_m) const { return rotation_.transpose() * (p_W_m - shift_m_); }
  [[nodiscard]] Vec3 to_world(const Vec3& p_B_m) const { return rotation_ * p_B_m + shift_m_; }

  std::shared_ptr<const AnalyticSurface> body_;
  Mat3 rotation_;
  Vec3 shift_m_;
};

}  // namespace touchstone::synthetic
