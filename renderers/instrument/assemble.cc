#include "renderers/instrument/assemble.h"

#include "harness/rendering/named_declaration.h"
#include "renderers/catalogue.h"
#include "renderers/effects/assemble.h"
#include "renderers/instrument/catalogue.h"
#include "renderers/instrument/formula_instrument.h"

namespace touchstone::renderers {
using rendering::InstrumentStage;

std::vector<rendering::StagedInstrument> make_instrument(const rendering::Model& model) {
  std::vector<rendering::StagedInstrument> instrument;
  for (const rendering::NamedParameters& entry : model.instrument) {
    check_entry(entry, instrument_declarations(), "instrument entry", model.source);
    if (entry.law != nullptr) {
      instrument.push_back(make_formula_instrument(
          *entry.law, checked_values(entry, entry.law->parameters, "instrument entry", model.source)));
      continue;
    }
    const InstrumentEntry& known = *find_instrument_effect(entry.name);
    instrument.emplace_back(known.stage,
                            known.make(checked_values(entry, known.parameters, "instrument entry", model.source)));
  }
  return instrument;
}

InstrumentStage stage_of(const rendering::NamedParameters& entry) {
  if (entry.law != nullptr)
    return entry.law->acts_on == rendering::ActsOn::tool ? InstrumentStage::object_frame
                                                         : InstrumentStage::sensor_offset;
  return find_instrument_effect(entry.name)->stage;
}

}  // namespace touchstone::renderers
