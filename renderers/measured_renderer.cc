#include "renderers/measured_renderer.h"

#include <algorithm>

#include "harness/rendering/effect_stack.h"
#include "harness/rendering/parameters.h"
#include "renderers/catalogue.h"
#include "renderers/effects/assemble.h"

namespace touchstone::renderers {

MeasuredRenderer::MeasuredRenderer(const Model& model, const std::shared_ptr<const Surface>& surface) {
  // Checks the model and the surface; without geometry entries it is already the renderer to run.
  renderer_ = make_renderer(model, surface);
  const RendererEntry& entry = find_renderer(model);
  Model base = model;
  base.parameters = base_parameters(model, entry.parameters);
  base.instrument.clear();
  base.effects.clear();
  const Parameters parameters(entry.parameters, base.parameters, "renderer " + entry.name, model.source, "");
  const auto value = [&](std::string_view name) {
    const auto found = parameters.values().find(name);
    return found == parameters.values().end() ? 0.0 : found->second;
  };
  std::vector<StackedEffect> inside;
  for (const NamedParameters& part : model.instrument) {
    const InstrumentEntry* const known = find_instrument_effect(part.name);
    auto effect = known->make(checked_values(part, known->parameters, "instrument entry", model.source));
    if (auto contact = effect->contact_effect()) inside.push_back({std::move(contact), EffectPhase::depth, true});
    instrument_.emplace_back(known->stage, std::move(effect));
  }
  std::ranges::stable_sort(instrument_, {}, [](const auto& one) { return one.first; });
  if (!inside.empty()) {
    std::vector<StackedEffect> effects = make_effects(model);
    for (StackedEffect& effect : inside) effects.push_back(std::move(effect));
    renderer_ = std::make_unique<EffectStack>(make_renderer(base, surface), std::move(effects), surface,
                                              value("tip_radius_m"), value("stiffness_N_per_m"));
  }
}

Vec3 MeasuredRenderer::true_position(const Vec3& measured_W_m) const {
  Vec3 p = measured_W_m;
  for (const auto& [stage, effect] : instrument_) p = effect->true_position(p);
  return p;
}

void MeasuredRenderer::apply(const MotionView& motion, std::span<Vec3> f_W_N) const {
  for (const auto& [stage, effect] : instrument_) effect->apply(motion, f_W_N);
}

double MeasuredRenderer::halo_s() const {
  double sum = 0.0;
  for (const auto& [stage, effect] : instrument_) sum += effect->halo_s();
  return sum;
}

}  // namespace touchstone::renderers
