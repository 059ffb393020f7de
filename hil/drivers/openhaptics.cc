#include <fmt/format.h>

#include <array>
#include <atomic>
#include <condition_variable>
#include <mutex>
#include <vector>

#include "drivers/vendor_devices.h"
#include "drivers/vendor_library.h"

namespace touchstone::hil {
namespace {

// As hd.h, hdDefines.h and hdScheduler.h declare them (OpenHaptics 3.4).
using Handle = unsigned;
using Enum = unsigned;
struct ErrorInfo {
  Enum code;
  int internal;
  Handle device;
};
constexpr Enum current_buttons = 0x2000, current_position = 0x2050, current_velocity = 0x2051, device_serial = 0x2504,
               calibration_style = 0x2555, current_force = 0x2700, force_output = 0x4000, calibration_ok = 0x5000,
               calibration_needs_update = 0x5001;
constexpr int style_encoder_reset = 1, style_auto = 2, style_inkwell = 4;
constexpr unsigned callback_continue = 1;
constexpr unsigned short priority = 0x7fff;
constexpr double two_ticks_s = 0.002;  // of the vendor's servo thread: by then one has begun and ended

// Of the styles that a device supports the one that the vendor's examples prefer. The Touch, whose stylus rests in its
// inkwell, if it names none.
Enum preferred_style(int supported) {
  if ((supported & style_auto) != 0) return style_auto;
  if ((supported & style_inkwell) != 0 || (supported & style_encoder_reset) == 0) return style_inkwell;
  return style_encoder_reset;
}

struct Hd {
  Handle (*init)(const char* name);
  void (*disable_device)(Handle);
  void (*enable)(Enum);
  void (*disable)(Enum);
  void (*start_scheduler)();
  void (*stop_scheduler)();
  unsigned long (*schedule_asynchronous)(unsigned (*callback)(void*), void* data, unsigned short priority);
  void (*unschedule)(unsigned long);
  void (*begin_frame)(Handle);
  void (*end_frame)(Handle);
  void (*get_doubles)(Enum, double*);
  void (*get_integers)(Enum, int*);
  void (*set_doubles)(Enum, const double*);
  const char* (*get_string)(Enum);
  ErrorInfo (*get_error)();
  Enum (*check_calibration)();
  void (*update_calibration)(Enum style);
};

class OpenHaptics final : public HapticDevice {
 public:
  explicit OpenHaptics(const VendorDeviceOptions& options)
      : library_(options.library.empty() ? std::vector<std::string>{"libHD.so.3.4", "libHD.so"}
                                         : std::vector<std::string>{options.library},
                 "install the vendor's OpenHaptics and device driver, and name its libHD.so as \"library\" in the "
                 "hardware map") {
    library_.find(hd_.init, "hdInitDevice");
    library_.find(hd_.disable_device, "hdDisableDevice");
    library_.find(hd_.enable, "hdEnable");
    library_.find(hd_.disable, "hdDisable");
    library_.find(hd_.start_scheduler, "hdStartScheduler");
    library_.find(hd_.stop_scheduler, "hdStopScheduler");
    library_.find(hd_.schedule_asynchronous, "hdScheduleAsynchronous");
    library_.find(hd_.unschedule, "hdUnschedule");
    library_.find(hd_.begin_frame, "hdBeginFrame");
    library_.find(hd_.end_frame, "hdEndFrame");
    library_.find(hd_.get_doubles, "hdGetDoublev");
    library_.find(hd_.get_integers, "hdGetIntegerv");
    library_.find(hd_.set_doubles, "hdSetDoublev");
    library_.find(hd_.get_string, "hdGetString");
    library_.find(hd_.get_error, "hdGetError");
    library_.find(hd_.check_calibration, "hdCheckCalibration");
    library_.find(hd_.update_calibration, "hdUpdateCalibration");
    device_ = hd_.init(options.configuration.empty() ? nullptr : options.configuration.c_str());
    if (const auto error = hd_.get_error(); error.code != 0)
      throw DeviceError(DeviceStatus::absent,
                        fmt::format("3D Systems: the device did not open (HD error {:#x})", error.code));
    const char* const number = hd_.get_string(device_serial);
    const std::string serial = number != nullptr ? number : "";
    if (!options.serial.empty() && serial != options.serial) {
      hd_.disable_device(device_);
      throw DeviceError(DeviceStatus::wrong_serial,
                        fmt::format("3D Systems: serial {} was asked for, {} is there", options.serial, serial));
    }
    identity_ = {std::string(openhaptics_device.id), serial, library_.name(), "vendor's", options.emulated};
    int styles = 0;
    hd_.get_integers(calibration_style, &styles);
    // A library that does not know the question is no device that fails.
    if (hd_.get_error().code != 0) styles = 0;
    style_ = preferred_style(styles);
    hd_.enable(force_output);
    job_ = hd_.schedule_asynchronous(&OpenHaptics::servo, this, priority);
    hd_.start_scheduler();
  }
  ~OpenHaptics() override {
    zero_force();
    hd_.stop_scheduler();
    hd_.unschedule(job_);
    hd_.disable_device(device_);
  }
  OpenHaptics(const OpenHaptics&) = delete;
  OpenHaptics& operator=(const OpenHaptics&) = delete;

  [[nodiscard]] const DeviceIdentity& identity() const override { return identity_; }
  // None in the device that is documented: the servo thread of this process is what holds the force.
  [[nodiscard]] double watchdog_s() const override { return 0.0; }
  [[nodiscard]] bool calibrated() const override { return calibrated_; }

  // Hands the force to the vendor's servo thread and waits for its next tick.
  DeviceState exchange(const Vec3& f, double deadline_s) override {
    std::unique_lock lock(mutex_);
    force_ = f;
    const auto tick = ticks_;
    const double left = deadline_s - clock_.now_s();
    if (!ticked_.wait_for(lock, std::chrono::duration<double>(std::max(0.0, left)), [&] { return ticks_ != tick; })) {
      force_.setZero();
      throw DeviceError(DeviceStatus::timed_out, "3D Systems: the servo thread did not tick before the deadline");
    }
    if (error_ != 0) throw DeviceError(DeviceStatus::failed, fmt::format("3D Systems: HD error {:#x}", error_));
    return state_;
  }

  // Confirmed by a tick that began after the zero was handed over: a servo thread that hangs holds the force.
  bool zero_force() noexcept override {
    std::unique_lock lock(mutex_);
    force_.setZero();
    const auto tick = ticks_;
    const std::chrono::duration<double> patience(two_ticks_s);
    return ticked_.wait_for(lock, patience, [&] { return ticks_ != tick; }) && error_ == 0;
  }
  bool motors_off() noexcept override {
    hd_.disable(force_output);
    return zero_force();
  }

 private:
  static unsigned servo(void* self) {
    static_cast<OpenHaptics*>(self)->tick();
    return callback_continue;
  }
  void tick() {
    const std::scoped_lock lock(mutex_);
    std::array<double, 3> p{}, v{};
    int buttons = 0;
    // Between frames, as the vendor's examples do it; never while a force is on, since the position may jump. What else
    // it may answer, HD_CALIBRATION_NEEDS_MANUAL_INPUT, is for a person to end (KnownDevice::calibrating).
    const Enum calibration = hd_.check_calibration();
    calibrated_ = calibration == calibration_ok;
    if (calibration == calibration_needs_update && force_.isZero(0.0)) hd_.update_calibration(style_);
    hd_.begin_frame(device_);
    hd_.get_doubles(current_position, p.data());
    hd_.get_doubles(current_velocity, v.data());
    hd_.get_integers(current_buttons, &buttons);
    const std::array<double, 3> force{force_.x(), force_.y(), force_.z()};
    hd_.set_doubles(current_force, force.data());
    hd_.end_frame(device_);
    if (const auto error = hd_.get_error(); error.code != 0) error_ = error.code, force_.setZero();
    state_.t_s = clock_.now_s();
    state_.p_W_m = 1e-3 * Vec3(p[0], p[1], p[2]);  // the library speaks millimetres
    state_.v_W_m_per_s = 1e-3 * Vec3(v[0], v[1], v[2]);
    state_.buttons = static_cast<unsigned>(buttons);
    ++ticks_;
    ticked_.notify_all();
  }

  VendorLibrary library_;
  Hd hd_{};
  Handle device_ = 0;
  Enum style_ = style_inkwell;
  unsigned long job_ = 0;
  DeviceIdentity identity_;
  MonotonicClock clock_;
  std::mutex mutex_;
  std::condition_variable ticked_;
  Vec3 force_ = Vec3::Zero();
  DeviceState state_;
  std::uint64_t ticks_ = 0;
  Enum error_ = 0;
  std::atomic<bool> calibrated_{false};
};

}  // namespace

std::unique_ptr<HapticDevice> open_openhaptics(const VendorDeviceOptions& options) {
  return std::make_unique<OpenHaptics>(options);
}

constexpr KnownDevice openhaptics_device{
    .id = "3ds-touch",
    .name = "3D Systems Touch",
    .role = DeviceRole::haptic_device,
    .bus = Bus::usb,
    .usb = {UsbName{0x2988, 0x0302, ""}, UsbName{0x2988, 0x0304, ""},
            UsbName{0x8829, 0x0203, ""}},  // the last from one public source, its bytes swapped
    .source = "public driver logs (cdc_acm)",
    .confidence = Confidence::reported,
    .note = "through the vendor's library, tried against a stub only",
    .calibrating =
        "put its stylus into the inkwell and leave it there for a second; a device without an inkwell: move "
        "arm and gimbal through their whole range",
    .open_handle = [](const MappedDevice& device) -> std::unique_ptr<HapticDevice> {
      VendorDeviceOptions options;
      options.library = device.library;
      options.serial = device.serial;
      return open_openhaptics(options);
    }};

}  // namespace touchstone::hil
