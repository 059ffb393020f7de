#include "harness/discrepancy/free_parameter.h"

#include <cmath>

namespace touchstone::discrepancy {
using rendering::Model;
using rendering::NamedParameters;

const NamedParameters* find_entry(const Model& model, const std::string& name) {
  for (const auto* entries : {&model.effects, &model.instrument}) {
    for (const NamedParameters& entry : *entries) {
      if (entry.name == name) return &entry;
    }
  }
  return nullptr;
}

NamedParameters* find_entry(Model& model, const std::string& name) {
  return const_cast<NamedParameters*>(find_entry(static_cast<const Model&>(model), name));
}

std::vector<FreeParameter> without_coefficients(std::vector<FreeParameter> parameters) {
  std::erase_if(parameters, [](const FreeParameter& parameter) { return parameter.coefficient; });
  return parameters;
}

FreeParameter linear_parameter(const std::string& owner, const std::string& name, double scale, double lower,
                               double upper) {
  return {owner,
          name,
          lower / scale,
          upper / scale,
          [=](Model& model, double u) { find_entry(model, owner)->parameters[name] = u * scale; },
          [=](const Model& model) { return find_entry(model, owner)->parameters.at(name) / scale; }};
}

FreeParameter log_parameter(const std::string& owner, const std::string& name, double lower, double upper) {
  return {owner,
          name,
          std::log(lower),
          std::log(upper),
          [=](Model& model, double u) { find_entry(model, owner)->parameters[name] = std::exp(u); },
          [=](const Model& model) { return std::log(find_entry(model, owner)->parameters.at(name)); },
          true};
}

FreeParameter log_base_parameter(const std::string& name, double lower, double upper) {
  return {"renderer",
          name,
          std::log(lower),
          std::log(upper),
          [=](Model& model, double u) { model.parameters[name] = std::exp(u); },
          [=](const Model& model) { return std::log(model.parameters.at(name)); },
          true};
}

}  // namespace touchstone::discrepancy
