#include "harness/rendering/smooth_field.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "harness/base/error.h"
#include "harness/rendering/surface_frame.h"

namespace touchstone::rendering {
namespace {

// Before the coefficients, in the order in which values are given.
constexpr std::array range_names{"x_low_m", "y_low_m", "x_high_m", "y_high_m", "columns", "rows", "bend"};
constexpr std::size_t first_coefficient = range_names.size();

std::size_t side(double given) {
  return std::clamp(static_cast<std::size_t>(std::lround(given)), SmoothField::least_side, SmoothField::most_side);
}

bool has(const std::vector<ParameterDeclaration>& declared, std::string_view name) {
  return std::any_of(declared.begin(), declared.end(), [&](const auto& one) { return one.name == name; });
}

double value_in(const std::map<std::string, double>& parameters, const ParameterDeclaration& declared) {
  const auto given = parameters.find(declared.name);
  return given == parameters.end() ? declared.initial : given->second;
}

}  // namespace

std::size_t SmoothField::Axis::weights(double place_m, std::array<double, 4>& value,
                                       std::array<double, 4>* slope) const noexcept {
  // `count` cubic pieces of B-splines overlap on count - 3 knot intervals; in each, four are not zero.
  const auto intervals = static_cast<double>(count - 3);
  const double s = (place_m - low) * per_m;
  const double inside = std::clamp(s, 0.0, intervals);
  const auto first = std::min(static_cast<std::size_t>(inside), count - 4);
  const double u = inside - static_cast<double>(first);
  const double v = 1.0 - u;
  // The uniform cubic B-spline in its four pieces (de Boor 1978, chapter X), u the place within the interval: they are
  // never negative and add up to 1, so that equal coefficients make a constant.
  value = {v * v * v / 6.0, (3.0 * u * u * u - 6.0 * u * u + 4.0) / 6.0,
           (-3.0 * u * u * u + 3.0 * u * u + 3.0 * u + 1.0) / 6.0, u * u * u / 6.0};
  if (slope == nullptr) return first;
  // Beyond the border the field is constant.
  const double scale = s == inside ? per_m : 0.0;
  // Their derivatives by u, times du/dx; they add up to 0.
  *slope = {-0.5 * scale * v * v, scale * (1.5 * u * u - 2.0 * u), scale * (-1.5 * u * u + u + 0.5),
            0.5 * scale * u * u};
  return first;
}

SmoothField::SmoothField(std::span<const double> values) {
  const std::size_t columns = side(values[4]);
  const std::size_t rows = side(values[5]);
  x_ = {values[0], static_cast<double>(columns - 3) / (values[2] - values[0]), columns};
  y_ = {values[1], static_cast<double>(rows - 3) / (values[3] - values[1]), rows};
  c_.reserve(columns * rows);
  for (std::size_t row = 0; row < rows; ++row) {
    for (std::size_t column = 0; column < columns; ++column) {
      c_.push_back(values[first_coefficient + row * most_side + column]);
    }
  }
}

double SmoothField::at(double x_m, double y_m) const noexcept {
  std::array<double, 4> across{};
  std::array<double, 4> along{};
  const std::size_t column = x_.weights(x_m, across, nullptr);
  const std::size_t row = y_.weights(y_m, along, nullptr);
  // f(x, y) = sum over r, k of B_r(y) B_k(x) c_rk: a row at a time.
  double sum = 0.0;
  for (std::size_t r = 0; r < 4; ++r) {
    const double* const c = &c_[(row + r) * x_.count + column];
    sum += along[r] * (across[0] * c[0] + across[1] * c[1] + across[2] * c[2] + across[3] * c[3]);
  }
  return sum;
}

SmoothField::Value SmoothField::with_slope(double x_m, double y_m) const noexcept {
  std::array<double, 4> across{};
  std::array<double, 4> along{};
  std::array<double, 4> across_slope{};
  std::array<double, 4> along_slope{};
  const std::size_t column = x_.weights(x_m, across, &across_slope);
  const std::size_t row = y_.weights(y_m, along, &along_slope);
  // By the product rule df/dx takes the slopes across and the values along, df/dy the other way round.
  Value value;
  for (std::size_t r = 0; r < 4; ++r) {
    const double* const c = &c_[(row + r) * x_.count + column];
    double level = 0.0;
    double rise = 0.0;
    for (std::size_t k = 0; k < 4; ++k) {
      level += across[k] * c[k];
      rise += across_slope[k] * c[k];
    }
    value.value += along[r] * level;
    value.along_x += along[r] * rise;
    value.along_y += along_slope[r] * level;
  }
  return value;
}

std::vector<ParameterDeclaration> field_parameters(const std::string& unit, double bound, const std::string& meaning) {
  std::vector<ParameterDeclaration> declared;
  for (const char* const name : {"x_low_m", "y_low_m"}) {
    declared.push_back({name, "m", -1e3, 1e3, 0.0, "where the range begins"});
  }
  for (const char* const name : {"x_high_m", "y_high_m"}) {
    declared.push_back({name, "m", -1e3, 1e3, 1.0, "where it ends"});
  }
  const auto least = static_cast<double>(SmoothField::least_side);
  const auto most = static_cast<double>(SmoothField::most_side);
  declared.push_back({"columns", "1", least, most, least, "coefficients along x"});
  declared.push_back({"rows", "1", least, most, least, "coefficients along y"});
  declared.push_back(
      {"bend", unit, 1e-12, 1e3, 1.0, "expected second difference of the coefficients; only fits read it"});
  for (std::size_t row = 0; row < SmoothField::most_side; ++row) {
    for (std::size_t column = 0; column < SmoothField::most_side; ++column) {
      declared.push_back({field_coefficient(column, row), unit, -bound, bound, 0.0, meaning});
    }
  }
  return with_frame(std::move(declared));
}

std::string field_coefficient(std::size_t column, std::size_t row) { return fmt::format("c_{:02}_{:02}", column, row); }

bool is_field_coefficient(std::string_view name) {
  const auto digit = [&](std::size_t i) { return name[i] >= '0' && name[i] <= '9'; };
  return name.size() == 7 && name.starts_with("c_") && name[4] == '_' && digit(2) && digit(3) && digit(5) && digit(6);
}

bool is_field(const std::map<std::string, double>& parameters) {
  return parameters.contains("columns") && parameters.contains("rows");
}

bool is_field(const std::vector<ParameterDeclaration>& declared) {
  return has(declared, "columns") && has(declared, "rows");
}

void check_field(const std::map<std::string, double>& parameters, std::string_view place) {
  const auto number = [&](const char* name, double otherwise) {
    const auto given = parameters.find(name);
    return given == parameters.end() ? otherwise : given->second;
  };
  for (const char* const axis : {"x", "y"}) {
    const double low = number(fmt::format("{}_low_m", axis).c_str(), 0.0);
    const double high = number(fmt::format("{}_high_m", axis).c_str(), 1.0);
    if (!(high > low)) {
      throw BadData(fmt::format("{}: {}_high_m {} is not above {}_low_m {}: give the range over which the field lies",
                                place, axis, high, axis, low));
    }
  }
  for (const char* const name : {"columns", "rows"}) {
    const double given = number(name, static_cast<double>(SmoothField::least_side));
    if (given != std::floor(given)) {
      throw BadData(fmt::format("{}: {} {} is not a whole number of coefficients", place, name, given));
    }
  }
  const double columns = number("columns", static_cast<double>(SmoothField::least_side));
  const double rows = number("rows", static_cast<double>(SmoothField::least_side));
  for (const auto& [name, value] : parameters) {
    if (!is_field_coefficient(name) || value == 0.0) continue;
    if (std::stoi(name.substr(2, 2)) >= columns || std::stoi(name.substr(5, 2)) >= rows) {
      throw BadData(fmt::format("{}: {}: nothing reads it: the field has {} columns and {} rows, counted from 00",
                                place, name, columns, rows));
    }
  }
}

SmoothField field_of(const std::map<std::string, double>& parameters, std::string_view place) {
  check_field(parameters, place);
  static const std::vector<ParameterDeclaration> declared = field_parameters("1", 1e3, "");
  std::vector<double> values;
  values.reserve(declared.size());
  for (const ParameterDeclaration& one : declared) values.push_back(value_in(parameters, one));
  return SmoothField(values);
}

}  // namespace touchstone::rendering
