// A device of the hardware map as a stream to record.
#pragma once

#include <memory>

#include "devices/hardware_map.h"
#include "drivers/open_mapped.h"
#include "record/stream.h"

namespace touchstone::hil {

struct StreamSettings {
  double card_rate_Hz = usual_card_rate_Hz;  // scans of a data acquisition card
  double handle_rate_Hz = 1000.0;            // exchanges with a haptic device, at zero force
};

// Any device that can be recorded: force sensors, trackers, haptic devices. Throws UsageError where the device is none
// or the map lacks what it needs (the message says what), DeviceError where it cannot be opened.
std::unique_ptr<Stream> open_stream(const MappedDevice& device, const StreamSettings& settings = {});

}  // namespace touchstone::hil
