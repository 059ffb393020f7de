// A number that a fit may change in a model, in a scaled coordinate u that is of order one: logarithms for scales and
// time constants, multiples of a typical size otherwise.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "harness/rendering/model.h"

namespace touchstone::discrepancy {

struct FreeParameter {
  std::string owner;   // "stiffness" of the base, or the effect's name
  std::string name;    // as in model files
  double lower = 0.0;  // of u
  double upper = 0.0;
  std::function<void(rendering::Model&, double u)> set;
  std::function<double(const rendering::Model&)> get;
  bool logarithmic = false;  // u is the logarithm of the value
  // Derivatives span this much of u, to both sides. 0: over a small step to one side, well above the kinks that
  // contact and friction make. What moves the tip along a mesh needs a facet's length: within one facet the normal
  // never turns, and samples that change their facet jump.
  double step = 0.0;
  // One of the hundreds of a field over the surface (harness/rendering/smooth_field.h): free where a model is refitted
  // as a whole, held where effects are compared.
  bool coefficient = false;
  bool moves_contact = false;          // EffectTraits of its owner
  std::vector<std::string> also = {};  // other parameters of the owner that it changes in no small part
};

std::vector<FreeParameter> without_coefficients(std::vector<FreeParameter> parameters);

// The entry of that name among contact effects and instrument entries; nullptr when the model has none.
rendering::NamedParameters* find_entry(rendering::Model& model, const std::string& name);
const rendering::NamedParameters* find_entry(const rendering::Model& model, const std::string& name);

// u = value / scale.
FreeParameter linear_parameter(const std::string& owner, const std::string& name, double scale, double lower,
                               double upper);
// u = ln(value).
FreeParameter log_parameter(const std::string& owner, const std::string& name, double lower, double upper);
// The base renderer's own parameter, u = ln(value).
FreeParameter log_base_parameter(const std::string& name, double lower, double upper);

}  // namespace touchstone::discrepancy
