// Calibration files of ATI force/torque sensors (XML, CalFileVersion 1.0 and 1.1): six gauge voltages to a wrench.
//   wrench = A (V - V_bias),  A = T(-BasicTransform) (Axis / scale);
// version 1.1 also carries the product as UserAxis, and then both must agree. T(d) moves the torque to the point d and
// turns the components by the angles (Rx, then Ry, then Rz, degrees): T' = R (T - d x F).
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

#include "harness/base/wrench.h"

namespace touchstone::recording {

using GaugeVoltages = std::array<double, 6>;

// A calendar day, for calibrations that expire.
struct CalendarDay {
  int year = 0;
  int month = 0;
  int day = 0;
  // NOLINTNEXTLINE(modernize-use-nullptr): clang-tidy takes the 0 of a three-way comparison for a pointer
  auto operator<=>(const CalendarDay&) const = default;
};

// "9/26/2003" (month first, as the files write it) or "2003-09-26". Throws BadData naming `what`.
CalendarDay parse_day(std::string_view text, std::string_view what);

struct AtiCalibration {
  std::string serial;
  std::string body_style;
  std::string part_number;  // "SI-12-0.12"
  CalendarDay calibrated;
  Eigen::Matrix<double, 6, 6> wrench_per_volt;  // rows Fx Fy Fz [N/V], Tx Ty Tz [N m/V], in the sensor's frame
  Eigen::Matrix<double, 6, 1> range;            // [N, N, N, N m, N m, N m]
  double gauge_limit_V = 0.0;                   // half of OutputRange where it is bipolar; beyond it the input clips
  double user_axis_deviation = 0.0;             // of UserAxis from the product, relative to its largest entry; 0 in 1.0
  std::string version;                          // "1.0", "1.1"
  std::string source;
};

// Throws BadData naming the file, the element and what was expected. `expected_serial` is checked where not empty.
AtiCalibration read_ati_calibration(const std::filesystem::path& path, std::string_view expected_serial = {});
AtiCalibration parse_ati_calibration(std::string_view xml, const std::string& source,
                                     std::string_view expected_serial = {});

// What is wrong with a sample; a recording keeps them so that nothing doubtful passes for a measurement.
enum SampleFlag : std::uint32_t {
  sample_ok = 0,
  sample_saturated = 1U << 0U,     // a gauge within 0.5 % of the end of its input range
  sample_out_of_range = 1U << 1U,  // a force or torque beyond the calibrated range
  sample_not_finite = 1U << 2U,
  sample_device_error = 1U << 3U,  // the device reported an error with the sample
  sample_after_gap = 1U << 4U,     // samples before this one were lost
  sample_not_tracked = 1U << 5U,   // the tracker did not see the body: its pose means nothing
};

struct CalibratedSample {
  Wrench wrench;  // in the sensor's frame, bias removed
  std::uint32_t flags = sample_ok;
};

CalibratedSample apply_calibration(const AtiCalibration& calibration, const GaugeVoltages& volts,
                                   const GaugeVoltages& bias_volts);

}  // namespace touchstone::recording
