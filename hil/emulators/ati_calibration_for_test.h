// A calibration file of a Nano17 whose axes are each 2 N or N mm per volt of their own gauge, laid out as ATI's files
// of version 1.0 are.
#pragma once

#include <fmt/format.h>

#include <string>

namespace touchstone::hil {

inline std::string ati_calibration_for_test() {
  std::string xml =
      "<FTSensor Serial=\"FT9\" BodyStyle=\"Nano17\" Family=\"DAQ\" NumGages=\"6\" "
      "CalFileVersion=\"1.0\"><Calibration PartNumber=\"SI-12-0.12\" CalDate=\"2/3/2020\" "
      "ForceUnits=\"N\" TorqueUnits=\"N-mm\" DistUnits=\"mm\" OutputRange=\"20\" OutputBipolar=\"True\">";
  const char* const names[] = {"Fx", "Fy", "Fz", "Tx", "Ty", "Tz"};
  for (int i = 0; i < 6; ++i) {
    xml += fmt::format("<Axis Name=\"{}\" scale=\"1\" max=\"17\" values=\"", names[i]);
    for (int j = 0; j < 6; ++j) xml += i == j ? " 2" : " 0";
    xml += "\"/>";
  }
  return xml + "<BasicTransform Dx=\"0\" Dy=\"0\" Dz=\"0\" Rx=\"0\" Ry=\"0\" Rz=\"0\"/></Calibration></FTSensor>";
}

}  // namespace touchstone::hil
