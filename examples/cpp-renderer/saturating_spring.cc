#include "saturating_spring.h"

#include <algorithm>

namespace example {
namespace {

using namespace touchstone;
using namespace touchstone::rendering;
using namespace touchstone::surface;

class SaturatingSpring final : public Renderer {
 public:
  SaturatingSpring(double stiffness_N_per_m, double largest_force_N, std::shared_ptr<const Surface> surface)
      : stiffness_N_per_m_(stiffness_N_per_m), largest_force_N_(largest_force_N), surface_(std::move(surface)) {}

 private:
  // It remembers nothing that could be forgotten.
  void do_reset() override {}

  StepResult do_step(const TipState& tip) noexcept override {
    StepResult result;
    const SurfacePoint closest = surface_->closest(tip.p_W_m);
    result.contact_W_m = tip.p_W_m;
    if (closest.signed_distance_m >= 0.0) return result;
    result.contact = true;
    result.contact_W_m = closest.p_W_m;
    result.depth_m = closest.distance_m;
    result.n_W = (closest.p_W_m - tip.p_W_m).normalized();
    result.f_W_N = std::min(stiffness_N_per_m_ * result.depth_m, largest_force_N_) * result.n_W;
    return result;
  }

  double stiffness_N_per_m_;
  double largest_force_N_;
  std::shared_ptr<const Surface> surface_;
};

}  // namespace

RendererEntry saturating_spring_entry() {
  return {"saturating-spring",
          "F = k dx from the closest surface point, up to the device's largest force",
          "Hooke's law",
          {{"stiffness_N_per_m", "N/m", 1e-9, 1e9, 500.0, "k of F = k dx"},
           {"largest_force_N", "N", 1e-9, 1e9, 10.0, "what the device can give"}},
          {{Ability::thin_shells, "it remembers no side: past the middle of a thin body it pushes on"},
           {Ability::large_jumps, "it remembers no side: a tip that jumps through is on the other side"},
           {Ability::continuous_force, "the closest surface point jumps where two are equally close"},
           {Ability::ball_tip, "it renders a point"}},
          [](const Parameters& parameters, std::shared_ptr<const Surface> surface) -> std::unique_ptr<Renderer> {
            return std::make_unique<SaturatingSpring>(parameters.at("stiffness_N_per_m"),
                                                      parameters.at("largest_force_N"), std::move(surface));
          }};
}

}  // namespace example
