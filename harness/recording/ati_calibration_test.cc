// The synthetic sensor: a known 6x6 matrix, written as a calibration file with arbitrary scales, read back, and
// compared.
#include "harness/recording/ati_calibration.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <cstdlib>
#include <limits>

#include "harness/base/error.h"
#include "harness/base/random.h"

namespace touchstone::recording {
namespace {

using Matrix6 = Eigen::Matrix<double, 6, 6>;
using testing::HasSubstr;

struct FileText {
  std::string version = "1.0", force_unit = "N", torque_unit = "N-mm", length_unit = "mm", serial = "FT0001",
              date = "9/26/2003";
  double dz = 0.0;
  double user_dz = 0.0;  // the shift that UserAxis was computed with
  std::string left_out;  // an axis not to write
  std::string user_left_out;
};

Matrix6 made_up_axes(std::uint64_t seed) {
  Random random(seed);
  Matrix6 m;
  for (int i = 0; i < 6; ++i) {
    for (int j = 0; j < 6; ++j) m(i, j) = random.normal() * (i < 3 ? 2.0 : 15.0);
  }
  return m;
}

// T' = T - d x F with d = -(0, 0, dz): the torque about a point dz below the basic origin.
Matrix6 shifted(Matrix6 axes, double dz) {
  const Vec3 d(0, 0, -dz);
  for (int j = 0; j < 6; ++j) {
    const Vec3 f = axes.block<3, 1>(0, j);
    axes.block<3, 1>(3, j) -= d.cross(f);
  }
  return axes;
}

std::string calibration_xml(const Matrix6& axes, const FileText& text) {
  const char* const names[] = {"Fx", "Fy", "Fz", "Tx", "Ty", "Tz"};
  std::string xml = fmt::format(
      "<?xml version=\"1.0\"?>\n<FTSensor Serial=\"{}\" BodyStyle=\"Nano17\" Family=\"DAQ\" NumGages=\"6\" "
      "CalFileVersion=\"{}\">\n"
      "<Calibration PartNumber=\"SI-12-0.12\" CalDate=\"{}\" ForceUnits=\"{}\" TorqueUnits=\"{}\" DistUnits=\"{}\" "
      "OutputRange=\"20\" "
      "OutputMode=\"Differential\" OutputBipolar=\"True\">\n",
      text.serial, text.version, text.date, text.force_unit, text.torque_unit, text.length_unit);
  for (int i = 0; i < 6; ++i) {
    if (names[i] == text.left_out) continue;
    const double scale = 3.5 + 0.25 * i;
    xml += fmt::format("<Axis Name=\"{}\" values=\"", names[i]);
    for (int j = 0; j < 6; ++j) xml += fmt::format(" {:.17g}", axes(i, j) * scale);
    xml += fmt::format("\" max=\"{}\" scale=\"{:.17g}\"/>\n", i < 2 ? 12 : i == 2 ? 17 : 120, scale);
  }
  xml += fmt::format("<BasicTransform Dx=\"0\" Dy=\"0\" Dz=\"{}\" Rx=\"0\" Ry=\"0\" Rz=\"0\"/>\n", text.dz);
  if (text.version == "1.1") {
    const Matrix6 user = shifted(axes, text.user_dz);
    for (int i = 0; i < 6; ++i) {
      if (names[i] == text.user_left_out) continue;
      xml += fmt::format("<UserAxis Name=\"{}\" values=\"", names[i]);
      for (int j = 0; j < 6; ++j) xml += fmt::format(" {:.8g}", user(i, j));
      xml += "\" max=\"17\"/>\n";
    }
  }
  return xml + "</Calibration></FTSensor>\n";
}

std::string complaint(const std::string& xml, std::string_view serial = {}) {
  try {
    parse_ati_calibration(xml, "sensor.cal", serial);
  } catch (const BadData& error) {
    return error.what();
  }
  return "accepted";
}

TEST(AtiCalibration, GivesTheWrenchThatMadeTheVoltagesInEveryUnit) {
  const struct {
    const char* force;
    const char* torque;
    double newtons;
    double newton_metres;
  } units[] = {{"N", "N-mm", 1.0, 1e-3},
               {"N", "N-m", 1.0, 1.0},
               {"lbf", "lbf-in", 4.4482216152605, 4.4482216152605 * 0.0254},
               {"kN", "kN-m", 1e3, 1e3}};
  for (const auto& unit : units) {
    SCOPED_TRACE(unit.force);
    const Matrix6 axes = made_up_axes(11);
    FileText text;
    text.force_unit = unit.force;
    text.torque_unit = unit.torque;
    const auto calibration = parse_ati_calibration(calibration_xml(axes, text), "sensor.cal");
    Random random(12);
    for (int trial = 0; trial < 50; ++trial) {
      const Vec3 force = random.direction(), torque = random.direction();  // in the file's units
      Eigen::Matrix<double, 6, 1> load;
      load << force, torque;
      const Eigen::Matrix<double, 6, 1> volts = axes.inverse() * load;
      GaugeVoltages v{}, bias{};
      for (std::size_t i = 0; i < 6; ++i) bias[i] = 0.1 * random.normal(), v[i] = bias[i] + volts[static_cast<int>(i)];
      const auto sample = apply_calibration(calibration, v, bias);
      EXPECT_NEAR((sample.wrench.f_N / unit.newtons - force).norm(), 0.0, 1e-11);
      EXPECT_NEAR((sample.wrench.torque_Nm / unit.newton_metres - torque).norm(), 0.0, 1e-11);
    }
  }
}

TEST(AtiCalibration, BasicTransformMovesTheTorqueAgainstItsSign) {
  const Matrix6 axes = made_up_axes(13);
  FileText text;
  text.dz = 4.2;
  const auto calibration = parse_ati_calibration(calibration_xml(axes, text), "sensor.cal");
  Matrix6 expected = shifted(axes, 4.2);  // N mm, mm
  expected.bottomRows<3>() *= 1e-3;
  EXPECT_LT((calibration.wrench_per_volt - expected).cwiseAbs().maxCoeff(), 1e-13 * expected.cwiseAbs().maxCoeff());
}

TEST(AtiCalibration, Version11MustAgreeWithItsOwnProduct) {
  const Matrix6 axes = made_up_axes(14);
  FileText text;
  text.version = "1.1";
  text.dz = text.user_dz = 4.2;
  const auto good = parse_ati_calibration(calibration_xml(axes, text), "sensor.cal");
  EXPECT_LT(good.user_axis_deviation, 1e-7);
  EXPECT_EQ(good.calibrated, (CalendarDay{2003, 9, 26}));
  text.user_dz = -4.2;
  EXPECT_THAT(complaint(calibration_xml(axes, text)), HasSubstr("UserAxis and BasicTransform"));
}

TEST(AtiCalibration, SaysWhatIsWrongWithAFile) {
  const Matrix6 axes = made_up_axes(15);
  FileText text;
  text.left_out = "Ty";
  EXPECT_THAT(complaint(calibration_xml(axes, text)), HasSubstr("<Axis Name=\"Ty\"> is missing"));
  text = {};
  text.version = "1.1";
  text.user_left_out = "Fz";
  EXPECT_THAT(complaint(calibration_xml(axes, text)), HasSubstr("<UserAxis Name=\"Fz\"> is missing"));
  text = {};
  text.version = "2.0";
  EXPECT_THAT(complaint(calibration_xml(axes, text)), HasSubstr("CalFileVersion \"2.0\" is not known"));
  text = {};
  text.force_unit = "newton";
  EXPECT_THAT(complaint(calibration_xml(axes, text)), HasSubstr("ForceUnits \"newton\""));
  text = {};
  text.torque_unit = "N/m";
  EXPECT_THAT(complaint(calibration_xml(axes, text)), HasSubstr("TorqueUnits \"N/m\""));
  text = {};
  text.date = "26/9/2003";
  EXPECT_THAT(complaint(calibration_xml(axes, text)), HasSubstr("is not a day"));
  EXPECT_THAT(complaint(calibration_xml(axes, {}), "FT0002"), HasSubstr("belongs to sensor FT0001"));
  EXPECT_THAT(complaint("fx,fy\n1,2\n"), HasSubstr("sensor.cal"));
  EXPECT_THAT(complaint("<FTSensor Serial='a'"), HasSubstr("is not XML"));
  auto bad_number = calibration_xml(axes, {});
  bad_number.replace(bad_number.find("scale=\"3.5"), 10, "scale=\"nan");
  EXPECT_THAT(complaint(bad_number), HasSubstr("not a finite number"));
}

TEST(AtiCalibration, FlagsWhatCannotBeTrusted) {
  const auto calibration = parse_ati_calibration(calibration_xml(made_up_axes(16), {}), "sensor.cal");
  GaugeVoltages zero{};
  EXPECT_EQ(apply_calibration(calibration, zero, zero).flags, sample_ok);
  auto volts = zero;
  volts[3] = -9.96;  // of +-10 V
  EXPECT_TRUE(apply_calibration(calibration, volts, zero).flags & sample_saturated);
  volts[3] = 9.5;  // far beyond 12 N with these axes
  EXPECT_TRUE(apply_calibration(calibration, volts, zero).flags & sample_out_of_range);
  volts[3] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(apply_calibration(calibration, volts, zero).flags & sample_not_finite);
}

TEST(Wrench, TorqueAboutAnotherPointUndoesItself) {
  Random random(17);
  for (const double scale : {1e-3, 1.0, 1e3}) {
    const Wrench w{scale * random.direction(), scale * random.direction()};
    const Vec3 r = scale * random.direction();
    const Wrench back = wrench_about(wrench_about(w, r), -r);
    EXPECT_LE((back.torque_Nm - w.torque_Nm).norm(), 1e-15 * (w.torque_Nm.norm() + r.norm() * w.f_N.norm()));
    // A pure force through r has no torque about r.
    const Wrench through{w.f_N, r.cross(w.f_N)};
    EXPECT_LE(wrench_about(through, r).torque_Nm.norm(), 1e-15 * r.norm() * w.f_N.norm());
  }
}

}  // namespace
}  // namespace touchstone::recording
