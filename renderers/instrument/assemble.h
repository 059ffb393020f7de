// The instrument entries of a model, ready to run: those of the catalogue and those that the model declares itself.
#pragma once

#include <vector>

#include "harness/rendering/instrument_effect.h"
#include "harness/rendering/measured_renderer.h"
#include "harness/rendering/model.h"

namespace touchstone::renderers {

// In the model file's order. Throws BadData with the place in it for an unknown entry and for parameters that nothing
// reads or that are out of range.
std::vector<rendering::StagedInstrument> make_instrument(const rendering::Model& model);

// Of an entry that make_instrument() takes.
rendering::InstrumentStage stage_of(const rendering::NamedParameters& entry);

}  // namespace touchstone::renderers
