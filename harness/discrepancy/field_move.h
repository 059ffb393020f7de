// Fields over the surface (harness/rendering/smooth_field.h) as candidates of a search: tried where no effect with a
// few parameters passes though something is clearly missing. A field takes the place of the bump that it contains, its
// smoothness is chosen on the validation blocks, and the other fields are held meanwhile.
#pragma once

#include <vector>

#include "harness/discrepancy/trial.h"

namespace touchstone::discrepancy {

bool has_field(const rendering::Model& model);
// Whether the model has a field, or a bump that a field contains.
bool differs_over_surface(const rendering::Model& model, const EffectLibrary& library);

// Every field that the model does not have yet, judged; the least deviance first, an empty verdict for the first that
// passes. Empty if the candidates have no field.
std::vector<Trial> try_fields(const SearchState& state, const BaselineScore& baseline);

// Whether a field that passed has less deviance than every effect with a few parameters that may yet pass.
bool field_is_better(const std::vector<Trial>& fields, const std::vector<Trial>& trials);

}  // namespace touchstone::discrepancy
