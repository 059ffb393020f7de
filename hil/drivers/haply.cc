#include "hil/drivers/haply.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <nlohmann/json.hpp>

#include "hil/drivers/web_socket.h"

namespace touchstone::hil {

namespace haply {

std::string force_command(const std::string& device_id, const Vec3& f_W_N) {
  return nlohmann::json{
      {"inverse3",
       {{{"device_id", device_id},
         {"commands", {{"set_cursor_force", {{"values", {{"x", f_W_N.x()}, {"y", f_W_N.y()}, {"z", f_W_N.z()}}}}}}}}}}}
      .dump();
}

}  // namespace haply

namespace {

// Of an answer to a zero command, from any state.
constexpr double zero_patience_s = 0.05;

class HaplyDevice final : public HapticDevice {
 public:
  explicit HaplyDevice(const HaplyOptions& options)
      : socket_("Haply's Inverse service", options.host, options.port, options.timeout_s) {
    const auto inventory = parse(socket_.receive(clock_.now_s() + options.timeout_s));
    try {
      id_ = choose(inventory, options.serial);
      const auto& device = find(inventory);
      identity_ = {"haply-inverse3", id_,
                   device.value("/config/extended_firmware_version"_json_pointer, std::string("Inverse service")), "",
                   device.value("/config/type"_json_pointer, std::string()) == "emulated"};
    } catch (const nlohmann::json::exception& error) {
      throw DeviceError(DeviceStatus::failed,
                        fmt::format("Haply's Inverse service: its inventory is not as documented: {}", error.what()));
    }
    take(inventory);
  }
  ~HaplyDevice() override { zero_force(); }
  HaplyDevice(const HaplyDevice&) = delete;
  HaplyDevice& operator=(const HaplyDevice&) = delete;

  [[nodiscard]] const DeviceIdentity& identity() const override { return identity_; }
  [[nodiscard]] double watchdog_s() const override { return 0.0; }
  [[nodiscard]] bool calibrated() const override { return calibrated_; }

  DeviceState exchange(const Vec3& f_W_N, double deadline_s) override {
    socket_.send(haply::force_command(id_, f_W_N), deadline_s);
    take(parse(socket_.receive(deadline_s)));
    return state_;
  }

  // One answer comes for each message: the answer to this one says that the service has it.
  bool zero_force() noexcept override {
    try {
      exchange(Vec3::Zero(), clock_.now_s() + zero_patience_s);
      return true;
    } catch (...) {
      return false;
    }
  }

 private:
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
      throw DeviceError(DeviceStatus::absent,
                        "Haply's Inverse service runs, but sees no Inverse3: is it switched on and "
                        "connected by USB?");
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
  bool calibrated_ = false;
};

}  // namespace

std::unique_ptr<HapticDevice> open_haply(const HaplyOptions& options) { return std::make_unique<HaplyDevice>(options); }

}  // namespace touchstone::hil
