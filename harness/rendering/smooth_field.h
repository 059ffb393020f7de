// A smooth function of x and y, as the effects of a model carry it, over the object's xy plane or that of a frame of
// its own (surface_frame.h): uniform cubic B-splines on a
// regular grid (de Boor, A Practical Guide to Splines, 1978), twice continuously differentiable. Outside of its range
// it keeps the value of the border. The coefficients are ordinary parameters of the model file, c_COLUMN_ROW with two
// digits each; those that a file does not give are 0.
#pragma once

#include <array>
#include <cstddef>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "harness/rendering/renderer.h"

namespace touchstone::rendering {

class SmoothField {
 public:
  static constexpr std::size_t least_side = 4;  // coefficients: a cubic needs four
  static constexpr std::size_t most_side = 20;  // declared along a side

  // Values in the order of field_parameters().
  explicit SmoothField(std::span<const double> values);

  struct Value {
    double value = 0.0;
    double along_x = 0.0;  // derivatives, per metre
    double along_y = 0.0;
  };
  [[nodiscard]] double at(double x_m, double y_m) const noexcept;
  [[nodiscard]] Value with_slope(double x_m, double y_m) const noexcept;

 private:
  struct Axis {
    double low = 0.0;
    double per_m = 1.0;  // knot intervals
    std::size_t count = least_side;
    // The first of the four splines that are not zero at the place, their values and their derivatives per metre.
    std::size_t weights(double place_m, std::array<double, 4>& value, std::array<double, 4>* slope) const noexcept;
  };

  Axis x_;
  Axis y_;
  std::vector<double> c_;  // row by row
};

// What an effect with a field declares: the range (x_low_m, y_low_m, x_high_m, y_high_m), the numbers of coefficients
// (columns along x, rows along y), `bend`, the coefficients, each from -bound to bound, and the frame. `bend` is what
// the coefficients' second differences are expected to be, in their unit: fits hold them to it, the effect does not
// read it.
std::vector<ParameterDeclaration> field_parameters(const std::string& unit, double bound, const std::string& meaning);

std::string field_coefficient(std::size_t column, std::size_t row);
bool is_field_coefficient(std::string_view name);
bool is_field(const std::map<std::string, double>& parameters);
bool is_field(const std::vector<ParameterDeclaration>& declared);

// The field that an effect's parameters describe. Throws BadData, with `place`, if its range is empty or its numbers of
// coefficients are not whole.
SmoothField field_of(const std::map<std::string, double>& parameters, std::string_view place);
void check_field(const std::map<std::string, double>& parameters, std::string_view place);

}  // namespace touchstone::rendering
