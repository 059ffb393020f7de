// A force sensor's six gauge voltages through a data acquisition card with a comedi driver, turned into wrenches by the
// sensor's calibration file. comedilib is opened at run time: a machine without it is one without these devices.
#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "devices/interfaces.h"
#include "devices/known_device.h"

namespace touchstone::hil {

struct ComediOptions {
  std::string node = "/dev/comedi0";
  std::string library;  // empty: libcomedi.so.0
  std::filesystem::path calibration_file;
  std::string sensor_serial;  // checked against the calibration's where not empty
  double rate_Hz = 5000.0;
  bool emulated = false;
};

// The card's own name, without starting anything. Throws DeviceError: no_driver, absent, no_permission, busy.
std::string comedi_board(const std::string& node, const std::string& library);

// Streams by a comedi command (hardware-timed scans of six differential channels). start() takes the bias: nothing may
// touch the probe then.
std::unique_ptr<WrenchSource> open_comedi_ati(const ComediOptions& options);

extern const KnownDevice nano17_device;

}  // namespace touchstone::hil
