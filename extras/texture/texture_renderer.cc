#include "texture_renderer.h"

#include <cmath>
#include <cstdint>
#include <utility>

#include "harness/base/error.h"
#include "harness/rendering/model.h"
#include "renderers/catalogue.h"
#include "texture_signal.h"

namespace touchstone::texture {
using rendering::Ability;
using rendering::Parameters;
using rendering::Renderer;
using rendering::StepResult;
using rendering::StepStatus;
using rendering::TipState;

namespace {

constexpr double cutoff_rad_per_s = 125.0;
constexpr double silent_m_per_s = 5e-5;
constexpr double rest_m_per_s = 0.001;  // as in perceive (harness/perception/judge/felt_series.h)

// The tip's velocity through two equal low-pass filters of first order, each discretised by the backward difference:
// v[n] = w^2 u[n] + 2 (1 - w) v[n-1] - (1 - w)^2 v[n-2], w = T lambda / (1 + T lambda).
class TipVelocity {
 public:
  void reset() {
    known_ = false;
    before_ = before_that_ = Vec3::Zero();
  }
  Vec3 at(double t_s, const Vec3& p_W_m) noexcept {
    if (known_) {
      const double step = (t_s - t_s_) * cutoff_rad_per_s;
      const double stays = 1.0 / (1.0 + step);
      const double enters = step * stays;
      const Vec3 raw = (p_W_m - p_W_m_) / (t_s - t_s_);
      const Vec3 now = enters * enters * raw + 2.0 * stays * before_ - stays * stays * before_that_;
      before_that_ = before_;
      before_ = now;
    }
    known_ = true;
    t_s_ = t_s;
    p_W_m_ = p_W_m;
    return before_;
  }

 private:
  bool known_ = false;
  double t_s_ = 0.0;
  Vec3 p_W_m_ = Vec3::Zero();
  Vec3 before_ = Vec3::Zero();
  Vec3 before_that_ = Vec3::Zero();
};

class TextureRenderer final : public Renderer {
 public:
  TextureRenderer(std::unique_ptr<Renderer> smooth, std::shared_ptr<const TextureModel> model, double mass_kg,
                  std::uint64_t seed)
      : smooth_(std::move(smooth)), player_(std::move(model), seed), mass_kg_(mass_kg) {}

 private:
  void do_reset() override {
    smooth_->reset();
    velocity_.reset();
    player_.reset();
  }

  StepResult do_step(const TipState& tip) noexcept override {
    StepResult result = smooth_->step(tip);
    if (result.status != StepStatus::ok) return result;
    Vec3 sliding = velocity_.at(tip.t_s, tip.p_W_m);
    double force_N = 0.0;
    if (result.contact) {
      force_N = result.f_W_N.dot(result.n_W);
      sliding -= sliding.dot(result.n_W) * result.n_W;
    }
    const double speed_m_per_s = sliding.norm();
    // At rest and in the air without noise, so that what rang before dies away.
    const bool sounds = result.contact && speed_m_per_s >= silent_m_per_s;
    const double acceleration = player_.at(tip.t_s, sounds ? speed_m_per_s : 0.0, force_N);
    // At rest there is no direction, and what still rings has none either.
    if (result.contact)
      result.f_W_N += mass_kg_ * acceleration * sliding.cross(result.n_W) / std::hypot(speed_m_per_s, rest_m_per_s);
    return result;
  }

  std::unique_ptr<Renderer> smooth_;
  TipVelocity velocity_;
  TexturePlayer player_;
  double mass_kg_;
};

}  // namespace

rendering::RendererEntry texture_renderer_entry(std::shared_ptr<const TextureModel> model, const std::string& why) {
  rendering::RendererEntry entry;
  entry.name = "texture";
  entry.summary = model ? "the texture of " + model->material + ": god-object, friction, and noise by speed and force"
                        : "a texture without its model";
  entry.source = "Culbertson, Lopez Delgado and Kuchenbecker 2014, Haptics Symposium";
  entry.parameters = {{"stiffness_N_per_m", "N/m", 1e-9, 1e9, 500.0, "of the surface"},
                      {"presliding_m", "m", 1e-12, 1e3, 5e-5, "of the friction: tangential path from stuck to sliding"},
                      {"effective_mass_kg", "kg", 0.0, 10.0, default_effective_mass_kg,
                       "of handle and hand: force over the acceleration"},
                      {"seed", "1", 0.0, 4294967295.0, 1.0, "of the noise; a whole number"}};
  entry.cannot = {{Ability::continuous_force, "a texture is noise"},
                  {Ability::passive, "a texture gives energy to the hand"},
                  {Ability::unit_scale, "the model's speeds are in its own unit"},
                  {Ability::ball_tip, "it renders a point"},
                  {Ability::analytic_surface, "its god-object slides on triangles"}};
  entry.make = [model = std::move(model), why](const Parameters& parameters,
                                               std::shared_ptr<const surface::Surface> surface) {
    if (!model) throw BadData(why);
    rendering::Model smooth;
    smooth.renderer = "god-object";
    smooth.parameters = {{"stiffness_N_per_m", parameters.at("stiffness_N_per_m")}};
    smooth.effects = {
        {"coulomb-friction",
         {{"mu_static", model->mu}, {"mu_dynamic", model->mu}, {"presliding_m", parameters.at("presliding_m")}},
         "/effects/0"}};
    return std::make_unique<TextureRenderer>(renderers::make_renderer(smooth, std::move(surface)), model,
                                             parameters.at("effective_mass_kg"),
                                             static_cast<std::uint64_t>(parameters.at("seed")));
  };
  return entry;
}

}  // namespace touchstone::texture
