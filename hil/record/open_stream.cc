#include "record/open_stream.h"

#include <fmt/format.h>

#include "drivers/device_table.h"
#include "harness/base/error.h"

namespace touchstone::hil {

std::unique_ptr<Stream> open_stream(const MappedDevice& device, const StreamSettings& settings) {
  const KnownDevice* const known = find_known_device(device.id);
  if (known == nullptr)
    throw UsageError(fmt::format("{}: not a known device; touchstone hil probe lists them", device.id));
  if (known->open_force != nullptr) return stream_of(open_force(device, settings.card_rate_Hz), device.rate_Hz);
  if (known->open_poses != nullptr) return stream_of(open_poses(device));
  if (known->open_handle != nullptr) return stream_of(open_handle(device), settings.handle_rate_Hz);
  throw UsageError(fmt::format("{}: no driver here records from it; these have one: {}", device.id,
                               ids_of_devices([](const KnownDevice& d) {
                                 return d.open_force != nullptr || d.open_poses != nullptr || d.open_handle != nullptr;
                               })));
}

}  // namespace touchstone::hil
