#include "experiments/spring_conditions.h"

#include <fmt/format.h>

#include <cmath>
#include <memory>

#include "harness/base/random.h"
#include "harness/perception/published_tables.h"
#include "harness/rendering/renderer.h"
#include "renderers/catalogue.h"
#include "synthetic/surfaces/height_fields.h"

namespace touchstone::experiments {
namespace {

namespace published = perception::published;

// Not in table 1: the controllers' periods, and a first-order lag that makes the better device the quicker one. Ours.
struct Dynamics {
  double servo_period_s;
  double time_constant_s;
};
Dynamics dynamics_of(std::string_view device) {
  if (device == "Omega.7") return {0.00025, 0.0015};
  if (device == "Touch X") return {0.001, 0.004};
  return {0.001, 0.008};
}

rendering::Model model_of(const SpringSetup& setup, const published::Device& device, bool linear) {
  rendering::Model model;
  model.source = fmt::format("{} with a {} spring", device.name, linear ? "linear" : "quadratic");
  if (linear) {
    model.renderer = "spring-linear";
    model.parameters = {{"stiffness_N_per_m", setup.stiffness_N_per_m}};
  } else {
    model.renderer = "spring-quadratic";
    // The same number in N/mm^2 as the linear one has in N/mm is a thousand times it in N/m^2.
    const double coefficient = setup.rule == QuadraticRule::equal_at_full_stroke
                                   ? setup.stiffness_N_per_m / setup.motion.stroke_m
                                   : 1e3 * setup.stiffness_N_per_m;
    model.parameters = {{"coefficient_N_per_m2", coefficient}};
  }
  const Dynamics dynamics = dynamics_of(device.name);
  rendering::NamedParameters effect;
  effect.name = "haptic-device";
  effect.place = "/effects/0";
  effect.parameters = {{"servo_period_s", dynamics.servo_period_s},
                       {"resolution_m", 1e-3 * device.resolution_mm},
                       {"stiffness_limit_N_per_m", 1e3 * device.stiffness_N_per_mm},
                       {"force_limit_N", device.maximum_force_N},
                       {"time_constant_s", dynamics.time_constant_s}};
  model.effects.push_back(std::move(effect));
  return model;
}

// What the finger's force sensor says.
double sensed_N(const SpringSetup& setup, double force_N, Random& random) {
  const double noisy = force_N + setup.force_noise_N * random.normal();
  return setup.force_step_N > 0.0 ? std::round(noisy / setup.force_step_N) * setup.force_step_N : noisy;
}

}  // namespace

std::vector<SpringCondition> spring_conditions(const SpringSetup& setup) {
  std::vector<SpringCondition> conditions;
  for (const auto& printed : published::published_conditions) {
    for (const auto& device : published::devices) {
      if (device.name != printed.device) continue;
      conditions.push_back({fmt::format("{}, F = k dx{}", device.name, printed.linear ? "" : "^2"),
                            std::string(device.name), printed.linear, model_of(setup, device, printed.linear)});
    }
  }
  return conditions;
}

perception::PressSignal press_real_spring(const SpringSetup& setup, std::uint64_t seed) {
  const Random streams(seed);
  perception::PressSignal signal;
  signal.name = "real spring";
  const auto depths = press_depths_m(setup.motion, setup.rate_Hz, streams.stream(0).next_u64());
  Random random = streams.stream(1);
  for (std::size_t n = 0; n < depths.size(); ++n) {
    signal.t_s.push_back(static_cast<double>(n) / setup.rate_Hz);
    signal.force_N.push_back(sensed_N(setup, setup.stiffness_N_per_m * depths[n], random));
    signal.displacement_m.push_back(depths[n] + setup.distance_noise_m * random.normal());
  }
  return signal;
}

perception::PressSignal press_condition(const SpringSetup& setup, const SpringCondition& condition, std::uint64_t seed,
                                        std::size_t stream) {
  const Random streams(seed);
  perception::PressSignal signal;
  signal.name = condition.name;
  const auto depths = press_depths_m(setup.motion, setup.simulation_rate_Hz, streams.stream(2 * stream + 2).next_u64());
  Random random = streams.stream(2 * stream + 3);
  const auto renderer = renderers::make_renderer(condition.model, std::make_shared<synthetic::Plane>(1.0));
  const double resolution_m = condition.model.effects.front().parameters.at("resolution_m");
  const auto every = static_cast<std::size_t>(std::round(setup.simulation_rate_Hz / setup.rate_Hz));
  for (std::size_t n = 0; n < depths.size(); ++n) {
    rendering::TipState tip;
    tip.t_s = static_cast<double>(n) / setup.simulation_rate_Hz;
    tip.p_W_m = {0.0, 0.0, -depths[n]};
    const rendering::StepResult step = renderer->step(tip);
    if (n % every != 0) continue;
    signal.t_s.push_back(tip.t_s);
    signal.force_N.push_back(sensed_N(setup, step.f_W_N.z(), random));
    signal.displacement_m.push_back(std::round(depths[n] / resolution_m) * resolution_m);
  }
  return signal;
}

}  // namespace touchstone::experiments
