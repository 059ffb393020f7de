// Every analytic surface by name. A new one is a maker in surface_catalogue.cc and a line in its table.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "synthetic/parameters.h"
#include "synthetic/surfaces/analytic_surface.h"

namespace touchstone::synthetic {

struct SurfaceEntry {
  std::string name;
  std::string summary;  // the shape in a line, with its source where it has one
  std::vector<Parameter> parameters;
  std::unique_ptr<AnalyticSurface> (*make)(const ParameterValues& values);
};

std::span<const SurfaceEntry> surface_catalogue();

// Throws UsageError listing what is known for a name or parameter that is not, and for values that make no shape.
std::unique_ptr<AnalyticSurface> make_surface(std::string_view name, const ParameterOverrides& overrides = {});

// The mesh, its source naming generator and parameters. Refuses 0 triangles and more than 20 million.
Tessellation make_mesh(std::string_view name, const ParameterOverrides& overrides, std::size_t triangles);

}  // namespace touchstone::synthetic
