// The wall of the theory: everything below z = 0 (or another height), F = K d along z.
#pragma once

#include "harness/rendering/renderer.h"

namespace touchstone::servo {

class FlatWall final : public rendering::Renderer {
 public:
  explicit FlatWall(double stiffness_N_per_m, double top_m = 0.0)
      : stiffness_N_per_m_(stiffness_N_per_m), top_m_(top_m) {}

 protected:
  void do_reset() override {}
  rendering::StepResult do_step(const rendering::TipState& tip) noexcept override {
    rendering::StepResult out;
    out.contact_W_m = tip.p_W_m;
    out.contact = tip.p_W_m.z() < top_m_;
    if (!out.contact) return out;
    out.contact_W_m.z() = top_m_;
    out.n_W = Vec3::UnitZ();
    out.depth_m = top_m_ - tip.p_W_m.z();
    out.f_W_N = stiffness_N_per_m_ * out.depth_m * out.n_W;
    return out;
  }

 private:
  double stiffness_N_per_m_, top_m_;
};

}  // namespace touchstone::servo
