#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "drivers/vendor_devices.h"
#include "drivers/vendor_library.h"

namespace touchstone::hil {
namespace {

// As dhdc.h declares them; all functions return a negative number on error.
struct Dhd {
  int (*open)();
  int (*close)(char id);
  int (*serial)(unsigned short* number, char id);
  int (*enable_force)(unsigned char on, char id);
  int (*set_force)(double fx, double fy, double fz, char id);
  int (*position)(double* x, double* y, double* z, char id);
  int (*velocity)(double* vx, double* vy, double* vz, char id);
  int (*button)(int index, char id);
  int (*watchdog)(unsigned char periods, char id);
  int (*status)(int* flags, char id);
  const char* (*last_error)();
};

constexpr double watchdog_step_s = 125e-6;
// Places in dhdGetStatus' answer (dhdc.h: DHD_STATUS_RESET, DHD_STATUS_ERROR; DHD_MAX_STATUS grew from 12 to 17 over
// the versions, so that the array leaves room).
constexpr std::size_t status_reset = 3, status_error = 9, most_status = 64;

class ForceDimension final : public HapticDevice {
 public:
  explicit ForceDimension(const VendorDeviceOptions& options)
      : library_(options.library.empty() ? std::vector<std::string>{"libdhd.so.3", "libdhd.so"}
                                         : std::vector<std::string>{options.library},
                 "install the vendor's Force Dimension SDK and name its libdhd.so as \"library\" in the hardware map") {
    library_.find(dhd_.open, "dhdOpen");
    library_.find(dhd_.close, "dhdClose");
    library_.find(dhd_.serial, "dhdGetSerialNumber");
    library_.find(dhd_.enable_force, "dhdEnableForce");
    library_.find(dhd_.set_force, "dhdSetForce");
    library_.find(dhd_.position, "dhdGetPosition");
    library_.find(dhd_.velocity, "dhdGetLinearVelocity");
    library_.find(dhd_.button, "dhdGetButton");
    library_.find(dhd_.watchdog, "dhdSetWatchdog");
    library_.find(dhd_.status, "dhdGetStatus");
    library_.find(dhd_.last_error, "dhdErrorGetLastStr");
    const int id = dhd_.open();
    if (id < 0) throw DeviceError(DeviceStatus::absent, fmt::format("Force Dimension: {}", dhd_.last_error()));
    id_ = static_cast<char>(id);
    try {
      start(options);
    } catch (...) {
      dhd_.close(id_);
      throw;
    }
  }
  ~ForceDimension() override {
    zero_force();
    dhd_.close(id_);
  }
  ForceDimension(const ForceDimension&) = delete;
  ForceDimension& operator=(const ForceDimension&) = delete;

  [[nodiscard]] const DeviceIdentity& identity() const override { return identity_; }
  [[nodiscard]] double watchdog_s() const override { return watchdog_s_; }
  // The device counts from its index marks (RESET): before, positions and the directions of forces are arbitrary.
  [[nodiscard]] bool calibrated() const override { return calibrated_; }

  DeviceState exchange(const Vec3& f, double) override {
    DeviceState state;
    check(dhd_.position(&state.p_W_m.x(), &state.p_W_m.y(), &state.p_W_m.z(), id_));
    check(dhd_.velocity(&state.v_W_m_per_s.x(), &state.v_W_m_per_s.y(), &state.v_W_m_per_s.z(), id_));
    state.t_s = clock_.now_s();
    state.buttons = dhd_.button(0, id_) > 0 ? 1U : 0U;
    read_status();
    const Vec3 force = calibrated_ ? f : Vec3(Vec3::Zero());
    check(dhd_.set_force(force.x(), force.y(), force.z(), id_));
    return state;
  }

  bool zero_force() noexcept override { return dhd_.set_force(0.0, 0.0, 0.0, id_) >= 0; }
  bool motors_off() noexcept override { return zero_force() && dhd_.enable_force(0, id_) >= 0; }

 private:
  void start(const VendorDeviceOptions& options) {
    unsigned short number = 0;
    check(dhd_.serial(&number, id_));
    const auto serial = std::to_string(number);
    if (!options.serial.empty() && serial != options.serial) {
      throw DeviceError(DeviceStatus::wrong_serial,
                        fmt::format("Force Dimension: serial {} was asked for, {} is there", options.serial, serial));
    }
    // The watchdog before the forces: from here on the device lets go by itself.
    const double periods = std::clamp(std::round(options.watchdog_s / watchdog_step_s), 1.0, 255.0);
    check(dhd_.watchdog(static_cast<unsigned char>(periods), id_));
    watchdog_s_ = periods * watchdog_step_s;
    check(dhd_.set_force(0.0, 0.0, 0.0, id_));
    check(dhd_.enable_force(1, id_));
    read_status();
    identity_ = {options.id, serial, library_.name(), "vendor's", options.emulated};
  }
  void read_status() {
    std::array<int, most_status> flags{};
    check(dhd_.status(flags.data(), id_));
    calibrated_ = flags[status_reset] == 1 && flags[status_error] == 0;
  }
  void check(int code) const {
    if (code < 0) throw DeviceError(DeviceStatus::failed, fmt::format("Force Dimension: {}", dhd_.last_error()));
  }

  VendorLibrary library_;
  Dhd dhd_{};
  char id_ = -1;
  double watchdog_s_ = 0.0;
  bool calibrated_ = false;
  DeviceIdentity identity_;
  MonotonicClock clock_;
};

}  // namespace

std::unique_ptr<HapticDevice> open_force_dimension(const VendorDeviceOptions& options) {
  return std::make_unique<ForceDimension>(options);
}

namespace {

std::unique_ptr<HapticDevice> mapped_force_dimension(const MappedDevice& device) {
  VendorDeviceOptions options;
  options.id = device.id;
  options.library = device.library;
  options.serial = device.serial;
  return open_force_dimension(options);
}

constexpr std::string_view force_dimension_note = "through the vendor's library, tried against a stub only";

}  // namespace

constexpr KnownDevice force_dimension_omega{.id = "force-dimension-omega",
                                            .name = "Force Dimension omega",
                                            .role = DeviceRole::haptic_device,
                                            .bus = Bus::usb,
                                            .usb = {UsbName{0x1451, 0x0402, ""}},
                                            .source = "usb.ids; vendor's udev rules",
                                            .confidence = Confidence::reported,
                                            .note = force_dimension_note,
                                            .open_handle = &mapped_force_dimension};
constexpr KnownDevice force_dimension_sigma{.id = "force-dimension-sigma",
                                            .name = "Force Dimension sigma",
                                            .role = DeviceRole::haptic_device,
                                            .bus = Bus::usb,
                                            .usb = {UsbName{0x1451, 0, "sigma"}},
                                            .source = "public logs: also seen as 1451:0401",
                                            .confidence = Confidence::conflicting,
                                            .note = force_dimension_note,
                                            .open_handle = &mapped_force_dimension};
constexpr KnownDevice force_dimension_delta{.id = "force-dimension-delta",
                                            .name = "Force Dimension delta",
                                            .role = DeviceRole::haptic_device,
                                            .bus = Bus::usb,
                                            .usb = {UsbName{0x1451, 0x0401, ""}},
                                            .source = "usb.ids; vendor's udev rules",
                                            .confidence = Confidence::reported,
                                            .note = force_dimension_note,
                                            .open_handle = &mapped_force_dimension};

}  // namespace touchstone::hil
