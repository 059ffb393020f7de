#include "harness/pipeline/fitting/parameter.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <cmath>

#include "harness/base/error.h"
#include "harness/rendering/declared_effect.h"
#include "harness/rendering/named_declaration.h"

namespace touchstone::pipeline {
using rendering::Catalogue;
using rendering::Model;
using rendering::NamedParameters;
using rendering::ParameterDeclaration;

namespace {

// Bounds further apart than this are no search range but "anything that makes sense".
constexpr double widest_ratio = 1e4;

struct Declared {
  std::string entry;
  ParameterDeclaration declaration;
  double value;
};

void add_entries(const std::vector<NamedParameters>& entries, const std::vector<rendering::NamedDeclaration>& known,
                 std::vector<Declared>& out) {
  for (const NamedParameters& entry : entries) {
    const auto found = std::ranges::find(known, entry.name, &rendering::NamedDeclaration::name);
    if (found == known.end() && entry.law == nullptr) continue;
    for (const ParameterDeclaration& declaration : entry.law ? entry.law->parameters : found->parameters) {
      const auto set = entry.parameters.find(declaration.name);
      out.push_back({entry.name, declaration, set == entry.parameters.end() ? declaration.initial : set->second});
    }
  }
}

std::vector<Declared> declared_in(const Catalogue& catalogue, const Model& model) {
  std::vector<Declared> out;
  for (const ParameterDeclaration& declaration : catalogue.find(model).parameters) {
    const auto set = model.parameters.find(declaration.name);
    out.push_back({"", declaration, set == model.parameters.end() ? declaration.initial : set->second});
  }
  add_entries(model.effects, catalogue.effects(), out);
  add_entries(model.instrument, catalogue.instrument_entries(), out);
  return out;
}

// NAME stands for ENTRY.NAME where the renderer has no NAME and just one entry does.
std::string full_name(const Catalogue& catalogue, std::string_view name, const Model& model) {
  std::vector<std::string> candidates;
  for (const Declared& one : declared_in(catalogue, model)) {
    if (one.declaration.name != name) continue;
    if (one.entry.empty()) return std::string(name);
    candidates.push_back(one.entry + "." + one.declaration.name);
  }
  return candidates.size() == 1 ? candidates.front() : std::string(name);
}

void keep_friction_dry(std::map<std::string, double>& parameters) {
  const auto at_rest = parameters.find("mu_static");
  const auto sliding = parameters.find("mu_dynamic");
  if (at_rest == parameters.end() || sliding == parameters.end()) return;
  at_rest->second = std::max(at_rest->second, sliding->second);
}

void set_parameter(Model& model, const FitParameter& parameter, double value) {
  if (parameter.entry.empty()) {
    model.parameters[parameter.key] = value;
    return;
  }
  for (auto* const entries : {&model.effects, &model.instrument}) {
    const auto found = std::ranges::find(*entries, parameter.entry, &NamedParameters::name);
    if (found != entries->end()) {
      found->parameters[parameter.key] = value;
      return;
    }
  }
}

double bound(std::string_view text, std::string_view whole) {
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size() || !std::isfinite(value)) {
    throw UsageError(
        fmt::format("--parameter {}: \"{}\" is not a number; expected NAME or NAME=low:high", whole, text));
  }
  return value;
}

void set_default_bounds(const ParameterDeclaration& declaration, double value, FitParameter& out) {
  out.low = declaration.minimum;
  out.high = declaration.maximum;
  const bool wide =
      !std::isfinite(out.low) || !std::isfinite(out.high) || out.high - out.low > widest_ratio * std::abs(value);
  if (!wide) return;
  if (value == 0.0) {
    throw UsageError(
        fmt::format("--parameter {}: its range {} to {} is too wide to search from 0; give bounds, {}=low:high",
                    out.name, declaration.minimum, declaration.maximum, out.name));
  }
  const auto [low, high] = std::minmax(0.01 * value, 100.0 * value);
  out.low = std::max(out.low, low);
  out.high = std::min(out.high, high);
}

}  // namespace

double FitParameter::to_unit(double value) const {
  return logarithmic ? std::log(value / low) / std::log(high / low) : (value - low) / (high - low);
}

double FitParameter::from_unit(double u) const {
  const double value = logarithmic ? low * std::pow(high / low, u) : low + u * (high - low);
  return std::clamp(value, low, high);
}

FitParameter parse_fit_parameter(const Catalogue& catalogue, std::string_view text, const Model& model) {
  const std::size_t equals = text.find('=');
  FitParameter out;
  out.name = full_name(catalogue, text.substr(0, equals), model);
  const std::size_t dot = out.name.find('.');
  out.key = dot == std::string::npos ? out.name : out.name.substr(dot + 1);
  out.entry = dot == std::string::npos ? "" : out.name.substr(0, dot);
  std::vector<std::string> known;
  for (const Declared& one : declared_in(catalogue, model)) {
    known.push_back(one.entry.empty() ? one.declaration.name : one.entry + "." + one.declaration.name);
    if (known.back() != out.name) continue;
    const ParameterDeclaration& declaration = one.declaration;
    out.unit = declaration.unit;
    out.initial = one.value;
    if (equals == std::string_view::npos) {
      set_default_bounds(declaration, one.value, out);
    } else {
      const std::string_view bounds = text.substr(equals + 1);
      const std::size_t colon = bounds.find(':');
      if (colon == std::string_view::npos)
        throw UsageError(fmt::format("--parameter {}: expected NAME=low:high", text));
      out.low = bound(bounds.substr(0, colon), text);
      out.high = bound(bounds.substr(colon + 1), text);
      if (out.low < declaration.minimum || out.high > declaration.maximum) {
        throw UsageError(fmt::format("--parameter {}: {} may be {} to {}", text, out.name, declaration.minimum,
                                     declaration.maximum));
      }
    }
    if (!(out.low < out.high))
      throw UsageError(
          fmt::format("--parameter {}: the bounds {} and {} leave nothing to search", text, out.low, out.high));
    out.logarithmic = out.low > 0.0 && out.high / out.low > 20.0;
    out.initial = std::clamp(out.initial, out.low, out.high);
    return out;
  }
  throw UsageError(fmt::format("--parameter {}: the model {} has no such parameter; it has {}", out.name, model.source,
                               fmt::join(known, ", ")));
}

Model with_values(const Model& model, const std::vector<FitParameter>& parameters, const std::vector<double>& values) {
  Model out = model;
  for (std::size_t i = 0; i < parameters.size(); ++i) set_parameter(out, parameters[i], values[i]);
  keep_friction_dry(out.parameters);
  for (NamedParameters& effect : out.effects) keep_friction_dry(effect.parameters);
  return out;
}

}  // namespace touchstone::pipeline
