// From the effects of a model file to a renderer that runs them.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "harness/rendering/effect_stack.h"
#include "harness/rendering/model.h"
#include "harness/rendering/parameters.h"

namespace touchstone::renderers {

// The checked values of an entry in the order of its declaration. Throws BadData with the place in the model file.
std::vector<double> checked_values(const rendering::NamedParameters& entry,
                                   const std::vector<rendering::ParameterDeclaration>& declared, std::string_view what,
                                   std::string_view source);

// The model's effects, made and checked; those that the base renderer runs itself are left out. Throws BadData.
std::vector<rendering::StackedEffect> make_effects(const rendering::Model& model);

// The base renderer's parameters with those that effects set in it (tip-radius adds to tip_radius_m).
// `declared`: what the base renderer declares; throws BadData when it has no such parameter.
std::map<std::string, double> base_parameters(const rendering::Model& model,
                                              const std::vector<rendering::ParameterDeclaration>& declared);

}  // namespace touchstone::renderers
