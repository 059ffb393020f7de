#include "harness/recording/ati_calibration.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <map>
#include <numbers>
#include <pugixml.hpp>
#include <sstream>
#include <vector>

#include "harness/base/atomic_file.h"
#include "harness/base/error.h"
#include "harness/base/input_files.h"

namespace touchstone::recording {
namespace {

using Matrix6 = Eigen::Matrix<double, 6, 6>;
constexpr std::array<const char*, 6> axis_names{"Fx", "Fy", "Fz", "Tx", "Ty", "Tz"};
constexpr double pound_N = 4.4482216152605;
constexpr double inch_m = 0.0254;
constexpr double kilogram_force_N = 9.80665;
// UserAxis is printed with six or seven digits.
constexpr double user_axis_tolerance = 1e-4;

const std::map<std::string, double, std::less<>>& force_units() {
  static const std::map<std::string, double, std::less<>> units{{"N", 1.0},
                                                                {"kN", 1e3},
                                                                {"lbf", pound_N},
                                                                {"klbf", 1e3 * pound_N},
                                                                {"kg", kilogram_force_N},
                                                                {"g", 1e-3 * kilogram_force_N}};
  return units;
}
const std::map<std::string, double, std::less<>>& torque_units() {
  static const std::map<std::string, double, std::less<>> units{{"N-m", 1.0},
                                                                {"Nm", 1.0},
                                                                {"N-mm", 1e-3},
                                                                {"Nmm", 1e-3},
                                                                {"kN-m", 1e3},
                                                                {"lbf-in", pound_N * inch_m},
                                                                {"in-lb", pound_N * inch_m},
                                                                {"lbf-ft", pound_N * 12 * inch_m},
                                                                {"ft-lb", pound_N * 12 * inch_m},
                                                                {"kg-cm", kilogram_force_N * 1e-2}};
  return units;
}
const std::map<std::string, double, std::less<>>& length_units() {
  static const std::map<std::string, double, std::less<>> units{
      {"m", 1.0}, {"cm", 1e-2}, {"mm", 1e-3}, {"in", inch_m}, {"ft", 12 * inch_m}};
  return units;
}

// One reader with the file's name at hand for messages.
class Reader {
 public:
  explicit Reader(std::string source) : source_(std::move(source)) {}

  [[noreturn]] void fail(const std::string& message) const { throw BadData(fmt::format("{}: {}", source_, message)); }

  std::string text(const pugi::xml_node& node, const char* attribute) const {
    const auto found = node.attribute(attribute);
    if (!found) fail(fmt::format("<{}> has no attribute {}", node.name(), attribute));
    return found.value();
  }
  double number(const pugi::xml_node& node, const char* attribute) const {
    return parse(text(node, attribute), fmt::format("<{}> {}", node.name(), attribute));
  }
  double unit(const pugi::xml_node& node, const char* attribute,
              const std::map<std::string, double, std::less<>>& known) const {
    const auto name = text(node, attribute);
    const auto found = known.find(name);
    if (found == known.end()) {
      std::string list;
      for (const auto& [unit_name, factor] : known) list += (list.empty() ? "" : ", ") + unit_name;
      fail(fmt::format("{} \"{}\" is not a unit that is known here; known: {}", attribute, name, list));
    }
    return found->second;
  }
  std::vector<double> numbers(const pugi::xml_node& node, const char* attribute) const {
    std::istringstream words(text(node, attribute));
    std::vector<double> values;
    for (std::string word; words >> word;)
      values.push_back(parse(word, fmt::format("<{}> {}", node.name(), attribute)));
    return values;
  }
  // The six rows of <Axis> or <UserAxis>, each with exactly six values.
  Matrix6 rows(const pugi::xml_node& calibration, const char* element, Eigen::Matrix<double, 6, 1>* max,
               bool divide_by_scale) const {
    Matrix6 matrix;
    for (std::size_t i = 0; i < axis_names.size(); ++i) {
      const auto node = calibration.find_child_by_attribute(element, "Name", axis_names[i]);
      if (!node)
        fail(fmt::format("<{} Name=\"{}\"> is missing; all of Fx, Fy, Fz, Tx, Ty, Tz are needed", element,
                         axis_names[i]));
      const auto values = numbers(node, "values");
      if (values.size() != 6)
        fail(fmt::format("<{} Name=\"{}\"> has {} values; 6 gauges were expected", element, axis_names[i],
                         values.size()));
      const double scale = divide_by_scale ? number(node, "scale") : 1.0;
      if (!(scale > 0.0))
        fail(fmt::format("<{} Name=\"{}\"> has scale {}; a positive number was expected", element, axis_names[i],
                         scale));
      const auto row = static_cast<Eigen::Index>(i);
      for (std::size_t j = 0; j < 6; ++j) matrix(row, static_cast<Eigen::Index>(j)) = values[j] / scale;
      if (max != nullptr) {
        (*max)[row] = number(node, "max");
        if (!((*max)[row] > 0.0))
          fail(fmt::format("<{} Name=\"{}\"> has max {}; a positive range was expected", element, axis_names[i],
                           (*max)[row]));
      }
    }
    return matrix;
  }

 private:
  double parse(const std::string& word, const std::string& what) const {
    double value = 0.0;
    const auto* const end = word.data() + word.size();
    const auto result = std::from_chars(word.data(), end, value);
    if (result.ec != std::errc() || result.ptr != end || !std::isfinite(value))
      fail(fmt::format("{}: \"{}\" is not a finite number", what, word));
    return value;
  }

  std::string source_;
};

// T(d): torque to the point d, components turned by the angles.
Matrix6 transform(const Vec3& d, const Vec3& angles_rad) {
  const Mat3 turn =
      (Eigen::AngleAxisd(angles_rad.x(), Vec3::UnitX()) * Eigen::AngleAxisd(angles_rad.y(), Vec3::UnitY()) *
       Eigen::AngleAxisd(angles_rad.z(), Vec3::UnitZ()))
          .toRotationMatrix()
          .transpose();
  Mat3 cross;
  cross << 0, -d.z(), d.y(), d.z(), 0, -d.x(), -d.y(), d.x(), 0;
  Matrix6 t = Matrix6::Zero();
  t.topLeftCorner<3, 3>() = turn;
  t.bottomLeftCorner<3, 3>() = -turn * cross;
  t.bottomRightCorner<3, 3>() = turn;
  return t;
}

}  // namespace

CalendarDay parse_day(std::string_view text, std::string_view what) {
  CalendarDay day;
  const std::string copy(text);
  char trailing = 0;
  const bool slashes = std::sscanf(copy.c_str(), "%d/%d/%d%c", &day.month, &day.day, &day.year, &trailing) == 3;
  if (!slashes && std::sscanf(copy.c_str(), "%d-%d-%d%c", &day.year, &day.month, &day.day, &trailing) != 3) day = {};
  if (day.year < 1980 || day.year > 9999 || day.month < 1 || day.month > 12 || day.day < 1 || day.day > 31) {
    throw BadData(
        fmt::format("{}: \"{}\" is not a day; 2003-09-26 or 9/26/2003 (month first) was expected", what, text));
  }
  return day;
}

AtiCalibration read_ati_calibration(const std::filesystem::path& path, std::string_view expected_serial) {
  note_input_file(path);
  return parse_ati_calibration(read_file(path), path.string(), expected_serial);
}

AtiCalibration parse_ati_calibration(std::string_view xml, const std::string& source,
                                     std::string_view expected_serial) {
  const Reader reader(source);
  pugi::xml_document document;
  const auto parsed = document.load_buffer(xml.data(), xml.size());
  if (!parsed) reader.fail(fmt::format("is not XML: {} at byte {}", parsed.description(), parsed.offset));
  const auto sensor = document.child("FTSensor");
  if (!sensor) reader.fail("has no <FTSensor>; an ATI calibration file (.cal) was expected");

  AtiCalibration result;
  result.source = source;
  result.version = reader.text(sensor, "CalFileVersion");
  if (result.version != "1.0" && result.version != "1.1") {
    reader.fail(fmt::format("CalFileVersion \"{}\" is not known; 1.0 and 1.1 are", result.version));
  }
  result.serial = reader.text(sensor, "Serial");
  result.body_style = reader.text(sensor, "BodyStyle");
  if (!expected_serial.empty() && result.serial != expected_serial) {
    reader.fail(fmt::format("belongs to sensor {}, but {} is the one in use; take that sensor's calibration file",
                            result.serial, expected_serial));
  }
  if (const double gauges = reader.number(sensor, "NumGages"); gauges != 6.0)
    reader.fail(fmt::format("NumGages is {}; 6 were expected", gauges));

  const auto calibration = sensor.child("Calibration");
  if (!calibration) reader.fail("has no <Calibration>");
  result.part_number = reader.text(calibration, "PartNumber");
  result.calibrated = parse_day(reader.text(calibration, "CalDate"), source + ": CalDate");
  const double force = reader.unit(calibration, "ForceUnits", force_units());
  const double torque = reader.unit(calibration, "TorqueUnits", torque_units());
  const double length = reader.unit(calibration, "DistUnits", length_units());
  const bool bipolar = !calibration.attribute("OutputBipolar") || calibration.attribute("OutputBipolar").as_bool(true);
  const double output_range = reader.number(calibration, "OutputRange");
  if (!(output_range > 0.0))
    reader.fail(fmt::format("OutputRange is {}; a positive voltage was expected", output_range));
  result.gauge_limit_V = bipolar ? output_range / 2 : output_range;

  Eigen::Matrix<double, 6, 1> si;
  si << force, force, force, torque, torque, torque;
  Matrix6 basic = si.asDiagonal() * reader.rows(calibration, "Axis", &result.range, true);
  result.range = result.range.cwiseProduct(si);

  const auto place = calibration.child("BasicTransform");
  if (!place) reader.fail("has no <BasicTransform>");
  const Vec3 shift = length * Vec3(reader.number(place, "Dx"), reader.number(place, "Dy"), reader.number(place, "Dz"));
  const Vec3 turn = std::numbers::pi / 180.0 *
                    Vec3(reader.number(place, "Rx"), reader.number(place, "Ry"), reader.number(place, "Rz"));
  result.wrench_per_volt = transform(-shift, -turn) * basic;

  if (result.version == "1.1") {
    const Matrix6 user = si.asDiagonal() * reader.rows(calibration, "UserAxis", nullptr, false);
    // Forces and torques have their own scales: compare block by block.
    const auto deviation = [&](Eigen::Index row) {
      return (user.middleRows<3>(row) - result.wrench_per_volt.middleRows<3>(row)).cwiseAbs().maxCoeff() /
             user.middleRows<3>(row).cwiseAbs().maxCoeff();
    };
    result.user_axis_deviation = std::max(deviation(0), deviation(3));
    if (!(result.user_axis_deviation <= user_axis_tolerance)) {
      reader.fail(
          fmt::format("UserAxis and BasicTransform * Axis / scale differ by {:.3g} of the largest entry (at most "
                      "{:.0e} is rounding); "
                      "the file is damaged or was edited",
                      result.user_axis_deviation, user_axis_tolerance));
    }
    result.wrench_per_volt = user;
  }
  return result;
}

CalibratedSample apply_calibration(const AtiCalibration& calibration, const GaugeVoltages& volts,
                                   const GaugeVoltages& bias_volts) {
  CalibratedSample sample;
  Eigen::Matrix<double, 6, 1> v;
  for (std::size_t i = 0; i < volts.size(); ++i) {
    if (!std::isfinite(volts[i])) sample.flags |= sample_not_finite;
    if (std::abs(volts[i]) >= 0.995 * calibration.gauge_limit_V) sample.flags |= sample_saturated;
    v[static_cast<Eigen::Index>(i)] = volts[i] - bias_volts[i];
  }
  const Eigen::Matrix<double, 6, 1> w = calibration.wrench_per_volt * v;
  // Without the bias: gauges show volts without any load too. A bias taken under load hides that load from this check;
  // the gauges' own limit above does not depend on it.
  if ((w.cwiseAbs().array() > calibration.range.array()).any()) sample.flags |= sample_out_of_range;
  sample.wrench = {w.head<3>(), w.tail<3>()};
  return sample;
}

}  // namespace touchstone::recording
