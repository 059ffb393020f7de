// Haptic devices that only their vendors' libraries speak to: Force Dimension (libdhd) and 3D Systems (libHD,
// OpenHaptics). Opened at run time. TRIED AGAINST STUBS ONLY: the calls and their order follow the vendors'
// documentation; no such device has answered this code.
#pragma once

#include <memory>
#include <string>

#include "devices/interfaces.h"
#include "devices/known_device.h"

namespace touchstone::hil {

struct VendorDeviceOptions {
  std::string id = "force-dimension-omega";  // of the family's device, as in the hardware map; Force Dimension only
  std::string library;                       // empty: the usual names on the loader's path
  std::string serial;                        // empty: the first device
  std::string configuration;                 // OpenHaptics: the device's configured name; empty: the default one
  double watchdog_s = 0.02;  // Force Dimension: the library's watchdog, at most 31.875 ms in steps of 125 us
  bool emulated = false;
};

std::unique_ptr<HapticDevice> open_force_dimension(const VendorDeviceOptions& options);
std::unique_ptr<HapticDevice> open_openhaptics(const VendorDeviceOptions& options);

extern const KnownDevice force_dimension_omega, force_dimension_sigma, force_dimension_delta;
extern const KnownDevice openhaptics_device;

}  // namespace touchstone::hil
