// The list of devices: what each entry must say so that everything that goes by it works.
#include "drivers/device_table.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <set>

#include "drivers/open_mapped.h"
#include "harness/base/atomic_file.h"
#include "harness/base/error.h"

namespace touchstone::hil {
namespace {

using ::testing::HasSubstr;

TEST(DeviceTable, EveryEntryDescribesItself) {
  std::set<std::string_view> ids;
  for (const KnownDevice* const d : known_devices()) {
    SCOPED_TRACE(d->id);
    EXPECT_TRUE(ids.insert(d->id).second) << "twice";
    EXPECT_FALSE(d->name.empty());
    EXPECT_FALSE(d->source.empty());
    EXPECT_FALSE(d->note.empty());
    EXPECT_EQ(find_known_device(d->id), d);
    EXPECT_EQ(d->bus == Bus::usb, d->usb.front().vendor != 0) << "USB names and the bus go together";
    EXPECT_EQ(d->bus == Bus::network, d->look != nullptr) << "who is on the network is looked for by asking";
    // What it measures and what it can be opened as.
    EXPECT_TRUE(d->open_force == nullptr || d->role == DeviceRole::wrench_source);
    EXPECT_TRUE(d->open_poses == nullptr || d->role == DeviceRole::tracker);
    EXPECT_TRUE(d->open_handle == nullptr || d->role == DeviceRole::haptic_device);
    EXPECT_TRUE(d->bus != Bus::serial || !d->address_example.empty());
  }
}

TEST(DeviceTable, ProductStringsDecideWhereIdsConflict) {
  EXPECT_EQ(match_usb(0x1451, 0x0401, "delta.3")->id, "force-dimension-delta");
  EXPECT_EQ(match_usb(0x1451, 0x0401, "sigma.7 haptic")->id, "force-dimension-sigma");
  EXPECT_EQ(match_usb(0x0403, 0xcb48, "")->id, "novint-falcon");
  EXPECT_EQ(match_usb(0x0403, 0x6001, "FT232"), nullptr);
  EXPECT_EQ(match_usb(0x3923, 0x7272, "USB-6218")->id, "ni-daq");
  for (const std::uint16_t product : {0x0302, 0x0304}) EXPECT_EQ(match_usb(0x2988, product, "")->id, "3ds-touch");
  EXPECT_EQ(match_usb(0x8829, 0x0203, "")->id, "3ds-touch");
  EXPECT_EQ(match_usb(0, 0, ""), nullptr) << "an entry's empty places are no device";
}

// A device that the rules leave out can be seen and not opened.
TEST(DeviceTable, TheUdevRulesNameEveryUsbDevice) {
  const char* const source = std::getenv("TOUCHSTONE_SOURCE_DIR");
  ASSERT_NE(source, nullptr);
  const auto rules = read_file(std::filesystem::path(source) / "hil" / "udev" / "70-touchstone-haptics.rules");
  for (const KnownDevice* const d : known_devices()) {
    for (const UsbName& name : d->usb) {
      if (name.vendor == 0) continue;
      EXPECT_THAT(rules, HasSubstr(fmt::format("ATTR{{idVendor}}==\"{:04x}\"", name.vendor))) << d->id;
    }
  }
}

template <class Open>
std::string complaint(Open open) {
  try {
    open();
  } catch (const UsageError& error) {
    return error.what();
  }
  return "opened";
}

TEST(DeviceTable, WhatADeviceIsNotIsSaidWithThoseThatAre) {
  MappedDevice device;
  device.id = "optitrack";
  device.address = "127.0.0.1";
  EXPECT_THAT(complaint([&] { open_force(device); }), HasSubstr("ati-netft, onrobot-hex, ati-nano17-daq"));
  EXPECT_THAT(complaint([&] { open_handle(device); }), HasSubstr("novint-falcon, haply-inverse3"));
  device.id = "ati-netft";
  EXPECT_THAT(complaint([&] { open_poses(device); }), HasSubstr("optitrack, vrpn, ndi-polaris"));
  device.address.clear();
  EXPECT_THAT(complaint([&] { open_force(device); }), HasSubstr("as \"192.168.1.1\""));
  device.id = "ati-netf";
  EXPECT_THAT(complaint([&] { open_force(device); }), HasSubstr("not a known device"));
}

}  // namespace
}  // namespace touchstone::hil
