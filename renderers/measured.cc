#include "renderers/measured.h"

#include "harness/rendering/effect_stack.h"
#include "harness/rendering/measured_renderer.h"
#include "harness/rendering/parameters.h"
#include "renderers/catalogue.h"
#include "renderers/effects/assemble.h"
#include "renderers/instrument/assemble.h"

namespace touchstone::renderers {
using rendering::StackedEffect;

rendering::MeasuredRenderer make_measured_renderer(const rendering::Model& model,
                                                   const std::shared_ptr<const surface::Surface>& surface) {
  // Checks the model and the surface; without geometry entries it is already the renderer to run.
  auto renderer = make_renderer(model, surface);
  const rendering::RendererEntry& entry = find_renderer(model);
  rendering::Model base = model;
  base.parameters = base_parameters(model, entry.parameters);
  base.instrument.clear();
  base.effects.clear();
  const rendering::Parameters parameters(entry.parameters, base.parameters, "renderer " + entry.name, model.source, "");
  const auto value = [&](std::string_view name) {
    const auto found = parameters.values().find(name);
    return found == parameters.values().end() ? 0.0 : found->second;
  };
  std::vector<rendering::StagedInstrument> instrument = make_instrument(model);
  std::vector<StackedEffect> inside;
  for (const auto& [stage, effect] : instrument) {
    if (auto contact = effect->contact_effect())
      inside.push_back({std::move(contact), rendering::EffectPhase::depth, true});
  }
  if (!inside.empty()) {
    std::vector<StackedEffect> effects = make_effects(model);
    for (StackedEffect& effect : inside) effects.push_back(std::move(effect));
    renderer = std::make_unique<rendering::EffectStack>(make_renderer(base, surface), std::move(effects), surface,
                                                        value("tip_radius_m"), value("stiffness_N_per_m"));
  }
  return {std::move(renderer), std::move(instrument)};
}

}  // namespace touchstone::renderers
