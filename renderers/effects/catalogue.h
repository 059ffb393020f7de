// The catalogue of effects. Adding one is a pair of files and a line in catalogue.cc; every command that reads models,
// `touchstone fit` and the search for missing effects then know it.
#pragma once

#include <map>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "harness/rendering/effect.h"
#include "harness/rendering/effect_traits.h"
#include "harness/rendering/renderer.h"

namespace touchstone::renderers {

struct EffectEntry {
  std::string_view name;
  std::string_view summary;
  std::string_view source;     // where the law is published
  std::string_view passivity;  // why it gives no energy to the hand, or that it may
  rendering::EffectPhase phase;
  bool needs_gap;
  std::vector<rendering::ParameterDeclaration> parameters;
  // Values in the order of `parameters`, already checked. Null for an effect that the base renderer itself runs by one
  // of its own parameters (tip-radius).
  std::unique_ptr<rendering::Effect> (*make)(std::span<const double> values);
  std::string_view base_parameter;  // that parameter; empty otherwise
  bool hypothesis = true;           // NamedDeclaration::hypothesis
  bool takes_image = false;         // a picture (NamedParameters::image) and values: made by height_image.h
  rendering::EffectTraits traits = {};
};

const std::vector<EffectEntry>& contact_effects();
// nullptr when there is none of that name.
const EffectEntry* find_contact_effect(std::string_view name);

}  // namespace touchstone::renderers
