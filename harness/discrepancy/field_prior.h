// What a fit expects of a field's coefficients beside the data: small second differences (P-splines: Eilers and Marx
// 1996), in units of the field's `bend`, and, far more weakly, small values. As residuals of unit variance, they keep
// hundreds of coefficients determined where nothing was touched, and the smoothness is chosen by the blocks that the
// fit does not see.
#pragma once

#include <cstddef>

#include "harness/rendering/model.h"

namespace touchstone::discrepancy {

// How many residuals the model's fields have; 0 without fields.
std::size_t prior_rows(const rendering::Model& model);
// Writes them.
void field_prior(const rendering::Model& model, double* out);

}  // namespace touchstone::discrepancy
