#include "renderers/spring.h"

#include <limits>

namespace touchstone {
namespace {

template <int kPower>
class Spring final : public Renderer {
 public:
  Spring(double k, std::shared_ptr<const Surface> surface) : k_(k), surface_(std::move(surface)) {}

 private:
  void do_reset() override {}

  StepResult do_step(const TipState& tip) noexcept override {
    StepResult result;
    const SurfacePoint closest = surface_->closest(tip.p_W_m);
    if (!(closest.signed_distance_m < 0.0)) {
      result.contact_W_m = tip.p_W_m;
      return result;
    }
    result.contact = true;
    result.contact_W_m = closest.p_W_m;
    result.depth_m = closest.distance_m;
    // On a mesh's edge the way out is towards the edge; the pseudo-normal only tells the side.
    result.n_W = (closest.p_W_m - tip.p_W_m).normalized();
    double force_N = k_ * result.depth_m;
    if constexpr (kPower == 2) force_N *= result.depth_m;
    result.f_W_N = force_N * result.n_W;
    return result;
  }

  double k_;
  std::shared_ptr<const Surface> surface_;
};

std::vector<Limitation> limitations() {
  return {{Ability::thin_shells, "it remembers no side: past the middle of a thin body it pushes on"},
          {Ability::large_jumps, "it remembers no side: a tip that jumps through is on the other side"},
          {Ability::continuous_force, "the closest surface point jumps where two are equally close"},
          {Ability::ball_tip, "it renders a point"}};
}

}  // namespace

RendererEntry spring_linear_entry() {
  return {"spring-linear",
          "F = k dx from the closest surface point, without memory",
          "Shao, Wu and Ouyang, section 3; the vector-field method of Zilles and Salisbury 1995",
          {{"stiffness_N_per_m", "N/m", std::numeric_limits<double>::min(), 1e9, 500.0, "k of F = k dx"}},
          limitations(),
          [](const Parameters& parameters, std::shared_ptr<const Surface> surface) -> std::unique_ptr<Renderer> {
            return std::make_unique<Spring<1>>(parameters.at("stiffness_N_per_m"), std::move(surface));
          }};
}

RendererEntry spring_quadratic_entry() {
  return {"spring-quadratic",
          "F = k dx^2 from the closest surface point, without memory: an unnatural spring for contrast",
          "Shao, Wu and Ouyang, section 3",
          {{"coefficient_N_per_m2", "N/m^2", std::numeric_limits<double>::min(), 1e12, 5e4, "k of F = k dx^2"}},
          limitations(),
          [](const Parameters& parameters, std::shared_ptr<const Surface> surface) -> std::unique_ptr<Renderer> {
            return std::make_unique<Spring<2>>(parameters.at("coefficient_N_per_m2"), std::move(surface));
          }};
}

}  // namespace touchstone
