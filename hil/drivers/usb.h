// libusb with owners instead of pointers, and its errors as DeviceStatus.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "devices/device_error.h"

struct libusb_context;
struct libusb_device_handle;

namespace touchstone::hil {

// A device on the bus; strings are empty where the device could not be opened to ask for them.
struct UsbDeviceInfo {
  std::uint16_t vendor = 0, product = 0;
  std::uint8_t bus = 0, address = 0;
  std::string manufacturer, product_name, serial;
  DeviceStatus status = DeviceStatus::present;  // or no_permission, busy (another program holds its interface), failed
};

class UsbContext {
 public:
  UsbContext();  // throws DeviceError(no_driver) where there is no USB support at all
  ~UsbContext();
  UsbContext(const UsbContext&) = delete;
  UsbContext& operator=(const UsbContext&) = delete;
  [[nodiscard]] libusb_context* get() const noexcept { return context_; }
  // Every device that is there; those of `vendors` are opened to read their strings and to see whether they are free.
  [[nodiscard]] std::vector<UsbDeviceInfo> devices(std::span<const std::uint16_t> vendors) const;

 private:
  libusb_context* context_ = nullptr;
};

// An opened device with interface 0 claimed; released and closed when it goes.
class UsbHandle {
 public:
  // Any serial where `serial` is empty. Throws DeviceError: absent, wrong_serial, no_permission, busy.
  UsbHandle(const UsbContext& context, std::uint16_t vendor, std::uint16_t product, const std::string& serial);
  ~UsbHandle();
  UsbHandle(const UsbHandle&) = delete;
  UsbHandle& operator=(const UsbHandle&) = delete;

  // Vendor request without data. All throw DeviceError: timed_out, gone, failed (stall).
  void control(std::uint8_t request, std::uint16_t value, std::uint16_t index, double timeout_s);
  void write(std::uint8_t endpoint, std::span<const unsigned char> bytes, double timeout_s);
  std::size_t read(std::uint8_t endpoint, std::span<unsigned char> bytes, double timeout_s);
  [[nodiscard]] const std::string& serial() const noexcept { return serial_; }

 private:
  [[noreturn]] void fail(int code, const char* what) const;

  libusb_device_handle* handle_ = nullptr;
  std::string name_, serial_;
};

}  // namespace touchstone::hil
