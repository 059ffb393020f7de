#include "harness/discrepancy/field_prior.h"

#include <vector>

#include "harness/rendering/smooth_field.h"

namespace touchstone::discrepancy {
using rendering::Model;
using rendering::NamedParameters;

namespace {

// A value that so many bends away from zero is one standard deviation off: a plane or a level costs next to nothing.
constexpr double bends_of_level = 20.0;

struct Grid {
  std::size_t columns;
  std::size_t rows;
  double bend;
  std::vector<double> c;  // row by row
};

Grid grid_of(const NamedParameters& entry) {
  Grid grid{static_cast<std::size_t>(entry.parameters.at("columns")),
            static_cast<std::size_t>(entry.parameters.at("rows")),
            entry.parameters.at("bend"),
            {}};
  for (std::size_t row = 0; row < grid.rows; ++row) {
    for (std::size_t column = 0; column < grid.columns; ++column) {
      const auto given = entry.parameters.find(rendering::field_coefficient(column, row));
      grid.c.push_back(given == entry.parameters.end() ? 0.0 : given->second);
    }
  }
  return grid;
}

template <class Visit>
void each_field(const Model& model, const Visit& visit) {
  for (const auto* entries : {&model.effects, &model.instrument}) {
    for (const NamedParameters& entry : *entries) {
      // A field that a user's model describes without a bend is not fitted.
      if (rendering::is_field(entry.parameters) && entry.parameters.contains("bend")) visit(entry);
    }
  }
}

}  // namespace

std::size_t prior_rows(const Model& model) {
  std::size_t rows = 0;
  each_field(model, [&](const NamedParameters& entry) {
    const auto columns = static_cast<std::size_t>(entry.parameters.at("columns"));
    const auto count = static_cast<std::size_t>(entry.parameters.at("rows"));
    rows += (columns - 2) * count + columns * (count - 2) + columns * count;
  });
  return rows;
}

void field_prior(const Model& model, double* out) {
  each_field(model, [&](const NamedParameters& entry) {
    const Grid grid = grid_of(entry);
    const auto at = [&](std::size_t column, std::size_t row) { return grid.c[row * grid.columns + column]; };
    for (std::size_t row = 0; row < grid.rows; ++row) {
      for (std::size_t column = 0; column < grid.columns; ++column) {
        const double here = at(column, row);
        if (column > 0 && column + 1 < grid.columns)
          *out++ = (at(column - 1, row) - 2.0 * here + at(column + 1, row)) / grid.bend;
        if (row > 0 && row + 1 < grid.rows)
          *out++ = (at(column, row - 1) - 2.0 * here + at(column, row + 1)) / grid.bend;
        *out++ = here / (bends_of_level * grid.bend);
      }
    }
  });
}

}  // namespace touchstone::discrepancy
