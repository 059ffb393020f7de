#include "harness/renderer_faults/other_engines.h"

#include <algorithm>
#include <bit>
#include <memory>
#include <utility>

#include "harness/base/random.h"
#include "harness/surface/embree_surface.h"
#include "harness/surface/moved_mesh.h"
#include "harness/surface/triangle_mesh.h"

namespace touchstone::renderer_faults {
using rendering::Renderer;

namespace {

// Asks again where there is no force, and where it falls from one sample to the next to less than half.
class AskedAgain final : public Renderer {
 public:
  AskedAgain(std::unique_ptr<Renderer> inner, double tick_s) : inner_(std::move(inner)), half_tick_s_(0.5 * tick_s) {}

 private:
  void do_reset() override {
    inner_->reset();
    last_N_ = 0.0;
  }
  rendering::StepResult do_step(const rendering::TipState& tip) noexcept override {
    rendering::StepResult result = inner_->step(tip);
    // Enough for what is lost in a row, or held.
    const int most = last_N_ > 0.0 ? 40 : 2;
    for (int again = 0; again < most && result.f_W_N.norm() <= 0.5 * last_N_; ++again) {
      rendering::TipState later = tip;
      later.t_s += half_tick_s_ * (again + 1) / (most + 1);
      result = inner_->step(later);
    }
    last_N_ = result.f_W_N.norm();
    return result;
  }
  [[nodiscard]] std::string do_failure() const override { return inner_->failure(); }
  std::unique_ptr<Renderer> inner_;
  double half_tick_s_;
  double last_N_ = 0.0;
};

// A force that swings by so much in all while there is contact.
class Noisy final : public Renderer {
 public:
  Noisy(std::unique_ptr<Renderer> inner, double swing_N) : inner_(std::move(inner)), swing_N_(swing_N) {}

 private:
  void do_reset() override { inner_->reset(); }
  rendering::StepResult do_step(const rendering::TipState& tip) noexcept override {
    rendering::StepResult result = inner_->step(tip);
    // Another one at every time, whatever the loop.
    if (result.contact) result.f_W_N += 0.5 * swing_N_ * Random(std::bit_cast<std::uint64_t>(tip.t_s)).direction();
    return result;
  }
  [[nodiscard]] std::string do_failure() const override { return inner_->failure(); }
  std::unique_ptr<Renderer> inner_;
  double swing_N_;
};

// The engine's whole world leaning over: what is level to the probe has a force along every axis of the engine.
class Leaning final : public Renderer {
 public:
  Leaning(const Engine& engine, const surface::Surface& level, double unit) {
    inner_ = engine.make(make_embree_surface(moved(*level.mesh(), turn_, Vec3::Zero())), unit);
  }

 private:
  void do_reset() override { inner_->reset(); }
  rendering::StepResult do_step(const rendering::TipState& tip) noexcept override {
    rendering::StepResult result = inner_->step({tip.t_s, turn_ * tip.p_W_m, tip.q_WS});
    for (Vec3* const v : {&result.f_W_N, &result.contact_W_m, &result.n_W}) *v = turn_.conjugate() * *v;
    return result;
  }
  [[nodiscard]] std::string do_failure() const override { return inner_->failure(); }
  Quat turn_ = Quat::FromTwoVectors(Vec3::UnitZ(), Vec3(0.7, 0.6, 0.5).normalized());
  std::unique_ptr<Renderer> inner_;
};

}  // namespace

Engine asked_again(const Engine& engine) {
  Engine other = engine;
  other.make = [make = engine.make, tick_s = 1.0 / engine.rate_Hz](std::shared_ptr<const surface::Surface> surface,
                                                                   double unit) {
    return std::unique_ptr<Renderer>(std::make_unique<AskedAgain>(make(std::move(surface), unit), tick_s));
  };
  return other;
}

// The same body, its triangles counted from another one: a face that is bad by its index is elsewhere.
Engine counted_from(const Engine& engine, double share) {
  Engine other = engine;
  other.make = [make = engine.make, share](const std::shared_ptr<const surface::Surface>& surface, double unit) {
    surface::TriangleMesh mesh = *surface->mesh();
    const auto first = static_cast<std::ptrdiff_t>(share * static_cast<double>(mesh.triangles.size()));
    std::rotate(mesh.triangles.begin(), mesh.triangles.begin() + first, mesh.triangles.end());
    return make(make_embree_surface(mesh), unit);
  };
  return other;
}

Engine with_noise(const Engine& engine, double swing_N) {
  Engine other = engine;
  other.make = [make = engine.make, swing_N](std::shared_ptr<const surface::Surface> surface, double unit) {
    return std::unique_ptr<Renderer>(std::make_unique<Noisy>(make(std::move(surface), unit), swing_N));
  };
  return other;
}

Engine leaning(const Engine& engine) {
  Engine other = engine;
  other.make = [engine](const std::shared_ptr<const surface::Surface>& surface, double unit) {
    return std::unique_ptr<Renderer>(std::make_unique<Leaning>(engine, *surface, unit));
  };
  return other;
}

}  // namespace touchstone::renderer_faults
