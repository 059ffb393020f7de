#include "drivers/haply.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>

#include "drivers/web_socket.h"

namespace touchstone::hil {

namespace haply {

std::string force_command(const std::string& device_id, const Vec3& f_W_N, ForceKey key) {
  const char* const name = key == ForceKey::vector ? "vector" : "values";
  return nlohmann::json{
      {"inverse3",
       {{{"device_id", device_id},
         {"commands", {{"set_cursor_force", {{name, {{"x", f_W_N.x()}, {"y", f_W_N.y()}, {"z", f_W_N.z()}}}}}}}}}}}
      .dump();
}

}  // namespace haply

namespace {

// Of an answer to a zero command, from any state.
constexpr double zero_patience_s = 0.05;
// Less than a device can apply.
constexpr double no_force_N = 1e-6;
constexpr std::array device_types{"inverse3", "inverse3x", "minverse"};

class HaplyDevice final : public HapticDevice {
 public:
  explicit HaplyDevice(const HaplyOptions& options)
      : socket_("Haply's Inverse service", options.host, options.port, options.timeout_s) {
    const auto inventory = parse(socket_.receive(clock_.now_s() + options.timeout_s));
    try {
      id_ = choose(inventory, options.serial);
      const auto& device = find(inventory);
      identity_ = {std::string(haply_device.id), id_,
                   device.value("/config/extended_firmware_version"_json_pointer, std::string("Inverse service")), "",
                   !is_a_device(device.value("/config/type"_json_pointer, std::string()))};
      if (device.contains("/config/basis"_json_pointer)) key_ = haply::ForceKey::vector;
      refuse_other_axes(device);
    } catch (const nlohmann::json::exception& error) {
      throw DeviceError(DeviceStatus::failed,
                        fmt::format("Haply's Inverse service: its inventory is not as documented: {}", error.what()));
    }
    take(inventory);
  }
  // Another program's session is none of a probe's business.
  ~HaplyDevice() override {
    if (commanded_) zero_force();
  }
  HaplyDevice(const HaplyDevice&) = delete;
  HaplyDevice& operator=(const HaplyDevice&) = delete;

  [[nodiscard]] const DeviceIdentity& identity() const override { return identity_; }
  [[nodiscard]] double watchdog_s() const override { return 0.0; }
  [[nodiscard]] bool calibrated() const override { return calibrated_; }

  DeviceState exchange(const Vec3& f_W_N, double deadline_s) override {
    commanded_ = true;
    socket_.send(haply::force_command(id_, f_W_N, key_), deadline_s);
    take(parse(socket_.receive(deadline_s)));
    return state_;
  }

  // Confirmed by the force that the service says it applies, where it says one; the state may be older than the
  // command.
  bool zero_force() noexcept override {
    try {
      const double until = clock_.now_s() + zero_patience_s;
      do {
        exchange(Vec3::Zero(), until);
        if (!applied_N_ || applied_N_->norm() <= no_force_N) return true;
      } while (clock_.now_s() < until);
    } catch (...) {
      // No answer in time.
    }
    return false;
  }

 private:
  [[nodiscard]] static bool is_a_device(const std::string& type) {
    return std::find(device_types.begin(), device_types.end(), type) != device_types.end();
  }

  // In other axes, or with lengths scaled, a position is none of the device's and a newton is no newton.
  void refuse_other_axes(const nlohmann::json& device) const {
    const auto axes = device.value("/config/basis/permutation"_json_pointer, std::string("XYZ"));
    if (axes != "XYZ")
      throw DeviceError(DeviceStatus::failed, fmt::format("Inverse3 {}: its axes are permuted, {}", id_, axes),
                        "set the basis to XYZ in Haply Hub");
    for (const char* const at : {"/config/mount/scale", "/state/transform/scale"}) {
      const auto scale = device.value(nlohmann::json::json_pointer(at), nlohmann::json::object());
      for (const char* const axis : {"x", "y", "z"}) {
        if (scale.value(axis, 1.0) != 1.0)
          throw DeviceError(DeviceStatus::failed, fmt::format("Inverse3 {}: {} is {}", id_, at, scale.dump()),
                            "lengths are metres at a scale of 1 alone: set it in Haply Hub");
      }
    }
  }

  [[nodiscard]] static nlohmann::json parse(const std::string& text) {
    auto json = nlohmann::json::parse(text, nullptr, false);
    if (!json.is_object())
      throw DeviceError(DeviceStatus::failed, "Haply's Inverse service: its message is no JSON object");
    return json;
  }

  static std::string choose(const nlohmann::json& inventory, const std::string& serial) {
    std::string there;
    std::size_t count = 0;
    if (inventory.contains("inverse3")) {
      for (const auto& device : inventory["inverse3"]) {
        const auto id = device.value("device_id", std::string());
        if (!serial.empty() && id == serial) return id;
        there += (there.empty() ? "" : ", ") + id;
        ++count;
      }
    }
    if (count == 0)
      throw DeviceError(DeviceStatus::absent, "Haply's Inverse service runs, but sees no Inverse3",
                        "is it switched on and connected by USB?");
    if (!serial.empty())
      throw DeviceError(DeviceStatus::wrong_serial,
                        fmt::format("Haply's Inverse service has {}; the hardware map wants {}", there, serial));
    if (count > 1)
      throw DeviceError(
          DeviceStatus::failed,
          fmt::format("Haply's Inverse service has {}: name one as \"serial\" in the hardware map", there));
    return there;
  }

  [[nodiscard]] const nlohmann::json& find(const nlohmann::json& message) const {
    if (const auto list = message.find("inverse3"); list != message.end()) {
      for (const auto& device : *list) {
        if (device.value("device_id", std::string()) == id_) return device;
      }
    }
    throw DeviceError(DeviceStatus::gone, fmt::format("Inverse3 {}: the service does not list it any more", id_));
  }

  [[nodiscard]] Vec3 vector_of(const nlohmann::json& state, const char* key) const {
    const auto v = state.find(key);
    if (v == state.end())
      throw DeviceError(DeviceStatus::failed, fmt::format("Inverse3 {}: its state has no {}", id_, key));
    const Vec3 p(v->value("x", std::nan("")), v->value("y", std::nan("")), v->value("z", std::nan("")));
    if (!p.allFinite())
      throw DeviceError(DeviceStatus::failed, fmt::format("Inverse3 {}: {} is {}", id_, key, v->dump()));
    return p;
  }

  void take(const nlohmann::json& message) {
    try {
      const auto& device = find(message);
      const auto state = device.find("state");
      if (state == device.end())
        throw DeviceError(DeviceStatus::failed, fmt::format("Inverse3 {}: a message without its state", id_));
      state_.t_s = clock_.now_s();
      state_.p_W_m = vector_of(*state, "cursor_position");
      state_.v_W_m_per_s = vector_of(*state, "cursor_velocity");
      applied_N_.reset();
      if (state->contains("current_cursor_force")) applied_N_ = vector_of(*state, "current_cursor_force");
      if (const auto status = device.find("status"); status != device.end())
        calibrated_ = status->value("calibrated", false) && status->value("ready", false);
      state_.buttons = 0;
      if (const auto grips = message.find("wireless_verse_grip"); grips != message.end() && !grips->empty()) {
        const auto buttons = grips->front().value("/state/buttons"_json_pointer, nlohmann::json::object());
        constexpr std::array names{"a", "b", "c"};
        for (std::size_t i = 0; i < names.size(); ++i)
          state_.buttons |= (buttons.value(names[i], false) ? 1U : 0U) << i;
      }
    } catch (const nlohmann::json::exception& error) {
      throw DeviceError(DeviceStatus::failed, fmt::format("Inverse3 {}: {}", id_, error.what()));
    }
  }

  MonotonicClock clock_;
  WebSocket socket_;
  std::string id_;
  DeviceIdentity identity_;
  DeviceState state_;
  haply::ForceKey key_ = haply::ForceKey::values;
  std::optional<Vec3> applied_N_;  // as the service's last state has it, where it says so
  bool calibrated_ = false, commanded_ = false;
};

}  // namespace

std::unique_ptr<HapticDevice> open_haply(const HaplyOptions& options) { return std::make_unique<HaplyDevice>(options); }

namespace {

// The service runs on this machine unless the map says where.
HaplyOptions mapped_haply(const MappedDevice& device) {
  HaplyOptions options;
  if (!device.address.empty()) options.host = device.address;
  if (device.port != 0) options.port = device.port;
  options.serial = device.serial;
  return options;
}

}  // namespace

constexpr KnownDevice haply_device{
    .id = "haply-inverse3",
    .name = "Haply Inverse3",
    .role = DeviceRole::haptic_device,
    .bus = Bus::network,
    .source = "docs.haply.co: WebSocket protocol of the Inverse service",
    .confidence = Confidence::confirmed,
    .note = "through Haply's service, which must run; tried against an emulator only",
    .open_handle = [](const MappedDevice& device) -> std::unique_ptr<HapticDevice> {
      return open_haply(mapped_haply(device));
    },
    .look = [](const MappedDevice& device, double timeout_s) -> DeviceSeen {
      HaplyOptions options = mapped_haply(device);
      options.timeout_s = timeout_s;
      const auto found = open_haply(options);
      return {found->identity().serial,
              fmt::format("through Haply's service at {}{}", options.host,
                          found->calibrated() ? "" : "; not calibrated yet: no force is commanded")};
    }};

}  // namespace touchstone::hil
