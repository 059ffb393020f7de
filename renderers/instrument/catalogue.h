// The catalogue of instrument entries. Adding one is a function that makes it and a line in catalogue.cc; every command
// that reads models, `touchstone fit` and the search for missing effects then know it.
#pragma once

#include <memory>
#include <span>
#include <string_view>
#include <vector>

#include "harness/rendering/effect_traits.h"
#include "harness/rendering/instrument_effect.h"
#include "harness/rendering/parameters.h"

namespace touchstone::renderers {

struct InstrumentEntry {
  std::string_view name;
  std::string_view summary;
  std::string_view source;
  rendering::InstrumentStage stage;
  std::vector<rendering::ParameterDeclaration> parameters;
  std::unique_ptr<rendering::InstrumentEffect> (*make)(std::span<const double> values);
  rendering::EffectTraits traits = {};
};

const std::vector<InstrumentEntry>& instrument_catalogue();
// nullptr when there is none of that name.
const InstrumentEntry* find_instrument_effect(std::string_view name);

}  // namespace touchstone::renderers
