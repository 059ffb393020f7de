#include "drivers/plugin_device.h"

#include <fmt/format.h>
#include <touchstone/device.h>

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include "drivers/vendor_library.h"

namespace touchstone::hil {
namespace {

// A name without a slash would be looked for on the loader's path.
std::string path_of(const std::filesystem::path& library) { return std::filesystem::absolute(library).string(); }

const touchstone_device_functions& functions_of(const VendorLibrary& library) {
  decltype(&::touchstone_device) ask = nullptr;
  library.find(ask, "touchstone_device");
  const touchstone_device_functions* const f = ask(TOUCHSTONE_DEVICE_VERSION);
  if (f == nullptr || f->version != TOUCHSTONE_DEVICE_VERSION) {
    throw DeviceError(
        DeviceStatus::no_driver,
        fmt::format("{}: does not have version {} of the device interface (it has {})", library.name(),
                    TOUCHSTONE_DEVICE_VERSION, f == nullptr ? std::string("not this one") : std::to_string(f->version)),
        "compile it against this program's touchstone/device.h");
  }
  const std::pair<bool, const char*> needed[] = {{f->name != nullptr, "name"},
                                                 {f->open != nullptr, "open"},
                                                 {f->close != nullptr, "close"},
                                                 {f->serial != nullptr, "serial"},
                                                 {f->exchange != nullptr, "exchange"},
                                                 {f->zero_force != nullptr, "zero_force"},
                                                 {f->calibrated != nullptr, "calibrated"},
                                                 {f->watchdog_s != nullptr, "watchdog_s"}};
  for (const auto& [there, name] : needed) {
    if (!there)
      throw DeviceError(DeviceStatus::no_driver, fmt::format("{}: {} is NULL", library.name(), name),
                        "of the table in touchstone/device.h only motors_off may be");
  }
  return *f;
}

class PluginDevice final : public HapticDevice {
 public:
  PluginDevice(const std::filesystem::path& library, const std::string& settings)
      : library_({path_of(library)},
                 "a device plug-in is a shared library with the function touchstone_device of touchstone/device.h"),
        functions_(functions_of(library_)) {
    device_ = functions_.open(settings.c_str(), message_.data(), message_.size() - 1);
    if (device_ == nullptr) throw DeviceError(DeviceStatus::failed, fmt::format("{}: {}", library.string(), said()));
    const char* const serial = functions_.serial(device_);
    identity_ = {functions_.name, serial != nullptr ? serial : "", library.filename().string(), "",
                 functions_.emulated != 0};
  }
  ~PluginDevice() override {
    zero_force();
    functions_.close(device_);
  }
  PluginDevice(const PluginDevice&) = delete;
  PluginDevice& operator=(const PluginDevice&) = delete;

  [[nodiscard]] const DeviceIdentity& identity() const override { return identity_; }
  [[nodiscard]] double watchdog_s() const override { return functions_.watchdog_s(device_); }
  [[nodiscard]] bool calibrated() const override { return functions_.calibrated(device_) != 0; }

  DeviceState exchange(const Vec3& f_W_N, double deadline_s) override {
    const double force[3] = {f_W_N.x(), f_W_N.y(), f_W_N.z()};
    touchstone_device_state answer{};
    message_.front() = '\0';
    if (functions_.exchange(device_, force, std::max(0.0, deadline_s - clock_.now_s()), &answer, message_.data(),
                            message_.size() - 1) != 0)
      throw DeviceError(DeviceStatus::failed, fmt::format("{}: {}", identity_.id, said()));
    DeviceState state;
    state.t_s = clock_.now_s() - answer.age_s;
    state.p_W_m = Vec3(answer.p_W_m[0], answer.p_W_m[1], answer.p_W_m[2]);
    state.v_W_m_per_s = Vec3(answer.v_W_m_per_s[0], answer.v_W_m_per_s[1], answer.v_W_m_per_s[2]);
    state.buttons = answer.buttons;
    state.temperature_C = answer.motor_temperature_C;
    return state;
  }
  bool zero_force() noexcept override { return functions_.zero_force(device_) == 0; }
  bool motors_off() noexcept override {
    return functions_.motors_off != nullptr ? functions_.motors_off(device_) == 0 : zero_force();
  }

 private:
  [[nodiscard]] std::string said() const {
    return message_.front() != '\0' ? message_.data() : "the plug-in failed and did not say why";
  }

  VendorLibrary library_;
  const touchstone_device_functions& functions_;
  void* device_ = nullptr;
  DeviceIdentity identity_;
  MonotonicClock clock_;
  std::array<char, 256> message_{};  // its last byte stays 0
};

}  // namespace

std::unique_ptr<HapticDevice> open_plugin_device(const std::filesystem::path& library, const std::string& settings) {
  return std::make_unique<PluginDevice>(library, settings);
}

}  // namespace touchstone::hil
