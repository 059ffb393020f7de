#include "hil/drivers/open_mapped.h"

#include <fmt/format.h>

#include "harness/base/error.h"
#include "hil/drivers/falcon.h"
#include "hil/drivers/haply.h"
#include "hil/drivers/vendor_devices.h"

namespace touchstone::hil {

std::unique_ptr<HapticDevice> open_mapped_device(const std::string& id, const MappedDevice& mapped) {
  if (id == "novint-falcon") {
    FalconOptions options;
    options.serial = mapped.serial;
    options.firmware = mapped.firmware;
    return open_falcon(options);
  }
  if (id == "haply-inverse3") {
    HaplyOptions options;
    if (!mapped.address.empty()) options.host = mapped.address;
    if (mapped.port != 0) options.port = mapped.port;
    options.serial = mapped.serial;
    return open_haply(options);
  }
  VendorDeviceOptions vendor;
  vendor.library = mapped.library;
  vendor.serial = mapped.serial;
  if (id == "3ds-touch") return open_openhaptics(vendor);
  if (id.rfind("force-dimension-", 0) == 0) return open_force_dimension(vendor);
  throw UsageError(
      fmt::format("{}: no driver here renders forces on it; novint-falcon, haply-inverse3, 3ds-touch and "
                  "force-dimension-omega, -sigma, -delta have one, and any other device takes a plug-in "
                  "(touchstone/device.h)",
                  id));
}

}  // namespace touchstone::hil
