#include "drivers/usb.h"

#include <fmt/format.h>
#include <libusb-1.0/libusb.h>

#include <algorithm>
#include <cmath>

namespace touchstone::hil {
namespace {

DeviceStatus status_of(int code) {
  switch (code) {
    case LIBUSB_ERROR_ACCESS:
      return DeviceStatus::no_permission;
    case LIBUSB_ERROR_BUSY:
      return DeviceStatus::busy;
    case LIBUSB_ERROR_NO_DEVICE:
      return DeviceStatus::gone;
    case LIBUSB_ERROR_NOT_FOUND:
      return DeviceStatus::absent;
    case LIBUSB_ERROR_TIMEOUT:
      return DeviceStatus::timed_out;
    default:
      return DeviceStatus::failed;
  }
}

std::string text_of(libusb_device_handle* handle, std::uint8_t index) {
  unsigned char text[256];
  const int n = index == 0 ? 0 : libusb_get_string_descriptor_ascii(handle, index, text, sizeof text);
  return n > 0 ? std::string(text, text + n) : std::string();
}

unsigned milliseconds(double timeout_s) { return static_cast<unsigned>(std::max(1.0, std::ceil(timeout_s * 1e3))); }

class DeviceList {
 public:
  explicit DeviceList(libusb_context* context) { count_ = libusb_get_device_list(context, &list_); }
  ~DeviceList() {
    if (count_ >= 0) libusb_free_device_list(list_, 1);
  }
  DeviceList(const DeviceList&) = delete;
  DeviceList& operator=(const DeviceList&) = delete;
  [[nodiscard]] std::span<libusb_device*> devices() const {
    return {list_, count_ > 0 ? static_cast<std::size_t>(count_) : 0};
  }

 private:
  libusb_device** list_ = nullptr;
  ssize_t count_ = 0;
};

}  // namespace

UsbContext::UsbContext() {
  const int code = libusb_init(&context_);
  if (code != 0)
    throw DeviceError(DeviceStatus::no_driver, fmt::format("USB is not available: {}", libusb_error_name(code)));
}

UsbContext::~UsbContext() { libusb_exit(context_); }

std::vector<UsbDeviceInfo> UsbContext::devices(std::span<const std::uint16_t> vendors) const {
  std::vector<UsbDeviceInfo> found;
  const DeviceList list(context_);
  for (libusb_device* const device : list.devices()) {
    libusb_device_descriptor descriptor{};
    if (libusb_get_device_descriptor(device, &descriptor) != 0) continue;
    UsbDeviceInfo info;
    info.vendor = descriptor.idVendor;
    info.product = descriptor.idProduct;
    info.bus = libusb_get_bus_number(device);
    info.address = libusb_get_device_address(device);
    if (std::find(vendors.begin(), vendors.end(), info.vendor) != vendors.end()) {
      libusb_device_handle* handle = nullptr;
      if (const int code = libusb_open(device, &handle); code != 0) {
        info.status = status_of(code);
      } else {
        info.manufacturer = text_of(handle, descriptor.iManufacturer);
        info.product_name = text_of(handle, descriptor.iProduct);
        info.serial = text_of(handle, descriptor.iSerialNumber);
        const int claimed = libusb_claim_interface(handle, 0);
        if (claimed == 0) libusb_release_interface(handle, 0);
        if (claimed == LIBUSB_ERROR_BUSY) info.status = DeviceStatus::busy;
        libusb_close(handle);
      }
    }
    found.push_back(std::move(info));
  }
  return found;
}

UsbHandle::UsbHandle(const UsbContext& context, std::uint16_t vendor, std::uint16_t product,
                     const std::string& serial) {
  name_ = fmt::format("USB device {:04x}:{:04x}", vendor, product);
  const DeviceList list(context.get());
  std::string others;
  int refused = 0;
  for (libusb_device* const device : list.devices()) {
    libusb_device_descriptor descriptor{};
    if (libusb_get_device_descriptor(device, &descriptor) != 0 || descriptor.idVendor != vendor ||
        descriptor.idProduct != product)
      continue;
    libusb_device_handle* handle = nullptr;
    if (const int code = libusb_open(device, &handle); code != 0) {
      refused = code;
      continue;
    }
    const auto found = text_of(handle, descriptor.iSerialNumber);
    if (!serial.empty() && found != serial) {
      others += (others.empty() ? "" : ", ") + found;
      libusb_close(handle);
      continue;
    }
    libusb_set_auto_detach_kernel_driver(handle, 1);
    if (const int code = libusb_claim_interface(handle, 0); code != 0) {
      libusb_close(handle);
      refused = code;
      continue;
    }
    handle_ = handle;
    serial_ = found;
    name_ += " " + found;
    return;
  }
  if (refused == LIBUSB_ERROR_ACCESS) {
    throw DeviceError(DeviceStatus::no_permission, fmt::format("{}: you may not open it", name_),
                      "install hil/udev/70-touchstone-haptics.rules and plug it in again");
  }
  if (refused != 0)
    throw DeviceError(status_of(refused), fmt::format("{}: {}", name_,
                                                      refused == LIBUSB_ERROR_BUSY ? "another program has it"
                                                                                   : libusb_error_name(refused)));
  if (!others.empty())
    throw DeviceError(DeviceStatus::wrong_serial,
                      fmt::format("{}: serial {} was asked for, {} is there", name_, serial, others));
  throw DeviceError(DeviceStatus::absent, fmt::format("{}: not there", name_));
}

UsbHandle::~UsbHandle() {
  libusb_release_interface(handle_, 0);
  libusb_close(handle_);
}

void UsbHandle::fail(int code, const char* what) const {
  throw DeviceError(status_of(code),
                    fmt::format("{}: {}: {}", name_, what,
                                code == LIBUSB_ERROR_PIPE ? "the device refused (stall)"
                                                          : libusb_strerror(static_cast<libusb_error>(code))));
}

void UsbHandle::control(std::uint8_t request, std::uint16_t value, std::uint16_t index, double timeout_s) {
  const int code = libusb_control_transfer(handle_, LIBUSB_REQUEST_TYPE_VENDOR, request, value, index, nullptr, 0,
                                           milliseconds(timeout_s));
  if (code < 0) fail(code, "control request");
}

void UsbHandle::write(std::uint8_t endpoint, std::span<const unsigned char> bytes, double timeout_s) {
  int done = 0;
  // libusb takes a pointer that is not const but does not write through it for an OUT endpoint.
  const int code = libusb_bulk_transfer(handle_, endpoint, const_cast<unsigned char*>(bytes.data()),
                                        static_cast<int>(bytes.size()), &done, milliseconds(timeout_s));
  if (code != 0) fail(code, "write");
  if (done != static_cast<int>(bytes.size()))
    throw DeviceError(DeviceStatus::failed, fmt::format("{}: took {} of {} bytes", name_, done, bytes.size()));
}

std::size_t UsbHandle::read(std::uint8_t endpoint, std::span<unsigned char> bytes, double timeout_s) {
  int done = 0;
  const int code = libusb_bulk_transfer(handle_, endpoint, bytes.data(), static_cast<int>(bytes.size()), &done,
                                        milliseconds(timeout_s));
  if (code != 0 && !(code == LIBUSB_ERROR_TIMEOUT && done > 0)) fail(code, "read");
  return static_cast<std::size_t>(done);
}

}  // namespace touchstone::hil
