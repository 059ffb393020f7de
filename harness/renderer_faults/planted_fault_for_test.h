// Renderers of the catalogue with a fault planted in their input, their answer or their cost.
#pragma once

#include <fmt/format.h>

#include <deque>
#include <functional>
#include <memory>
#include <ostream>
#include <string>
#include <utility>

#include "harness/renderer_faults/engine.h"
#include "harness/testing/allocation_guard.h"
#include "renderers/catalogue.h"

namespace touchstone::renderer_faults {

// What a fault may remember, and what of the world it may look at.
struct Memory {
  std::deque<rendering::StepResult> past;
  std::size_t steps = 0;  // since it was made
  std::size_t since_reset = 0;
  double unit = 1.0;
  std::shared_ptr<const surface::Surface> surface;
  Vec3 last_tip = Vec3::Zero();
  double last_t_s = 0.0;
  rendering::StepResult kept;  // what an earlier answer left, and a figure of the fault's own: both from reset to reset
  double figure = 0.0;
};

struct Fault {
  std::string name;
  std::string caught_by;
  std::function<void(rendering::TipState&, Memory&)> before = {};
  std::function<void(rendering::StepResult&, const rendering::TipState&, Memory&)> after = {};
  std::string renderer = "god-object";
  std::string parameters = {};
};

inline void PrintTo(const Fault& fault, std::ostream* out) { *out << fault.name; }

class Faulty final : public rendering::Renderer {
 public:
  Faulty(const Fault& fault, std::unique_ptr<rendering::Renderer> healthy,
         std::shared_ptr<const surface::Surface> surface, double unit)
      : fault_(fault), healthy_(std::move(healthy)) {
    memory_.surface = std::move(surface);
    memory_.unit = unit;
  }

 private:
  void do_reset() override {
    healthy_->reset();
    memory_.past.clear();
    memory_.since_reset = 0;
    memory_.kept = {};
    memory_.figure = 0.0;
  }
  rendering::StepResult do_step(const rendering::TipState& tip) noexcept override {
    rendering::TipState seen = tip;
    if (fault_.before) fault_.before(seen, memory_);
    rendering::StepResult result = healthy_->step(seen);
    if (fault_.after) fault_.after(result, tip, memory_);
    memory_.last_tip = tip.p_W_m;
    memory_.last_t_s = tip.t_s;
    ++memory_.steps;
    ++memory_.since_reset;
    return result;
  }

  Fault fault_;
  std::unique_ptr<rendering::Renderer> healthy_;
  Memory memory_;
};

// The fault in an engine, which may have others.
inline Engine planted(const Engine& engine, const Fault& fault) {
  Engine faulty = engine;
  faulty.name = fault.name;
  faulty.make = [make = engine.make, fault](const std::shared_ptr<const surface::Surface>& surface, double unit) {
    return std::unique_ptr<rendering::Renderer>(std::make_unique<Faulty>(fault, make(surface, unit), surface, unit));
  };
  return faulty;
}

// In a renderer of the catalogue; its tip is a point.
inline Engine engine_of(const Fault& fault) {
  Engine engine;
  engine.name = fault.name;
  engine.friction = fault.renderer == "friction-cone" ? 0.4 : 0.0;
  engine.make = [fault](std::shared_ptr<const surface::Surface> surface,
                        double unit) -> std::unique_ptr<rendering::Renderer> {
    const rendering::Model model = rendering::parse_model(
        fmt::format(
            R"({{"schema": "touchstone-model/1", "renderer": "{}", "parameters": {{"stiffness_N_per_m": {}{}}}}})",
            fault.renderer, 500.0 / unit, fault.parameters),
        fault.name);
    return renderers::make_renderer(model, std::move(surface));
  };
  engine.allocations = testing::allocations_on_this_thread;
  return planted(engine, fault);
}

inline void nothing_there(rendering::StepResult& result, const rendering::TipState& tip) {
  result = rendering::StepResult{};
  result.contact_W_m = tip.p_W_m;
}

}  // namespace touchstone::renderer_faults
