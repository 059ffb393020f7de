// A path that is come to from outside: straight down onto its first position. Renderers that find contact by the tip's
// way through the surface touch nothing in a run that starts inside.
#pragma once

#include <memory>
#include <utility>

#include "synthetic/trajectories/path.h"

namespace touchstone::synthetic {

class ApproachPath final : public Path {
 public:
  // From `height_m` above z = 0, which must not lie below the first position of `then`.
  ApproachPath(std::unique_ptr<Path> then, double height_m, double speed_m_per_s)
      : then_(std::move(then)),
        first_W_m_(then_->position_W_m(0.0)),
        speed_m_per_s_(speed_m_per_s),
        lead_s_((height_m - first_W_m_.z()) / speed_m_per_s) {}
  [[nodiscard]] Vec3 position_W_m(double t_s) const override {
    if (t_s >= lead_s_) return then_->position_W_m(t_s - lead_s_);
    const double left_s = t_s > 0.0 ? lead_s_ - t_s : lead_s_;
    return {first_W_m_.x(), first_W_m_.y(), first_W_m_.z() + speed_m_per_s_ * left_s};
  }
  [[nodiscard]] double duration_s() const override { return lead_s_ + then_->duration_s(); }

 private:
  std::unique_ptr<Path> then_;
  Vec3 first_W_m_;
  double speed_m_per_s_;
  double lead_s_;
};

}  // namespace touchstone::synthetic
