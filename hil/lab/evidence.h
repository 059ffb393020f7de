// What a lab test leaves behind so that another person can check it: raw samples, counters, serials, calibration, clock
// and scheduling. Written to the folder that TOUCHSTONE_HIL_EVIDENCE names; without it only the numbers are printed.
#pragma once

#include <string>
#include <vector>

#include "devices/interfaces.h"
#include "lab/finding.h"

namespace touchstone::hil {

struct Evidence {
  std::string test;
  DeviceIdentity device;
  std::string fixture;
  StreamCounters counters;
  std::vector<Measurement> measurements;
  std::vector<Limit> limits;
  std::vector<Picture> pictures;
  std::vector<ServoRun> runs;
  std::string sensor;    // id, serial and calibration of a force sensor that took part beside the device
  std::string dead_man;  // what allowed forces; empty where none were commanded

  // Takes test, measurements, limits, pictures and raw samples from a finding.
  void take(const Finding& finding);
};

// Prints each number: from hardware in CTest's form, so that a dashboard takes it up; from an emulator as plain text
// under the word "emulated", which no dashboard reads. Writes `<test>.json` (schema touchstone-hil-evidence/1) and the
// samples beside it. Throws BadData for numbers that are not finite.
void publish(const Evidence& evidence, const std::vector<WrenchSample>& samples = {});

}  // namespace touchstone::hil
