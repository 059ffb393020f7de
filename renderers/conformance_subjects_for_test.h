// Renderers of the catalogue, with effects or without, as subjects of the conformance suite.
#pragma once

#include <utility>

#include "harness/rendering/named_declaration.h"
#include "harness/testing/renderer_subject.h"
#include "renderers/catalogue.h"

namespace touchstone::renderers {

using testing::in_unit;  // of one declaration's parameters
using testing::RendererSubject;

inline rendering::Model in_unit(rendering::Model model, double unit) {
  model.parameters = in_unit(find_renderer(model).parameters, model.parameters, unit);
  for (auto& effect : model.effects) {
    for (const auto& declaration : effect_catalogue()) {
      if (declaration.name == effect.name) effect.parameters = in_unit(declaration.parameters, effect.parameters, unit);
    }
  }
  return model;
}

// `model` in JSON; what the renderer cannot do comes from the catalogue, with `besides` for what its effects cannot.
inline RendererSubject subject_of(std::string name, const std::string& json, double stiffness_N_per_m,
                                  double friction = 0.0, double tip_radius_m = 0.0,
                                  std::vector<rendering::Limitation> besides = {}) {
  const rendering::Model model = rendering::parse_model(json, name);
  RendererSubject subject;
  subject.name = std::move(name);
  subject.make = [model](std::shared_ptr<const surface::Surface> surface, double unit) {
    return make_renderer(in_unit(model, unit), std::move(surface));
  };
  subject.stiffness_N_per_m = stiffness_N_per_m;
  subject.friction = friction;
  subject.tip_radius_m = tip_radius_m;
  subject.cannot = find_renderer(model).cannot;
  subject.cannot.insert(subject.cannot.end(), besides.begin(), besides.end());
  return subject;
}

}  // namespace touchstone::renderers
