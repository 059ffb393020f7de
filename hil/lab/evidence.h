// What a lab test leaves behind so that another person can check it: raw samples, counters, serials, calibration, clock
// and scheduling. Written to the folder that TOUCHSTONE_HIL_EVIDENCE names; without it only the numbers are printed.
#pragma once

#include <string>
#include <vector>

#include "hil/devices/interfaces.h"

namespace touchstone::hil {

struct Measurement {
  std::string name;  // with its unit: noise_fx_N
  double value = 0.0;
};

struct Evidence {
  std::string test;
  DeviceIdentity device;
  std::string fixture;
  StreamCounters counters;
  std::vector<Measurement> measurements;
};

// Prints each number: from hardware in CTest's form, so that a dashboard takes it up; from an emulator as plain text
// under the word "emulated", which no dashboard reads. Throws BadData for numbers that are not finite.
void publish(const Evidence& evidence, const std::vector<WrenchSample>& samples = {});

}  // namespace touchstone::hil
