#include "drivers/falcon.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "drivers/falcon_kinematics.h"
#include "drivers/usb.h"
#include "harness/base/atomic_file.h"

namespace touchstone::hil {

namespace falcon {
namespace {

void put_word(unsigned char* to, int value) {
  for (int i = 0; i < 4; ++i)
    to[i] = static_cast<unsigned char>(0x41 + ((static_cast<unsigned>(value) >> (4 * i)) & 0xfU));
}

int get_word(const unsigned char* from) {
  unsigned value = 0;
  for (unsigned i = 0; i < 4; ++i) value |= (static_cast<unsigned>(from[i] - 0x41) & 0xfU) << (4 * i);
  return static_cast<std::int16_t>(value);
}

}  // namespace

std::array<int, 3> motor_counts(const Vec3& torque_Nm, double counts_per_Nm) {
  constexpr double largest = 4095.0;
  const Vec3 wanted = -counts_per_Nm * torque_Nm;
  std::array<int, 3> counts{};
  if (!wanted.allFinite()) return counts;
  const double scale = std::min(1.0, largest / std::max(largest, wanted.cwiseAbs().maxCoeff()));
  for (int i = 0; i < 3; ++i) counts[static_cast<std::size_t>(i)] = static_cast<int>(std::lround(scale * wanted[i]));
  return counts;
}

Frame encode(const Command& command) {
  Frame frame;
  frame.fill(0x41);
  frame.front() = '<', frame.back() = '>';
  for (std::size_t i = 0; i < 3; ++i) put_word(frame.data() + 1 + 4 * i, std::clamp(command.motors[i], -32768, 32767));
  frame[13] = static_cast<unsigned char>(0x41 + (command.homing ? 1 : 0));
  return frame;
}

Command decode_command(const Frame& frame) {
  Command command;
  for (std::size_t i = 0; i < 3; ++i) command.motors[i] = get_word(frame.data() + 1 + 4 * i);
  command.homing = ((frame[13] - 0x41) & 1) != 0;
  return command;
}

Frame encode(const Answer& answer) {
  Frame frame;
  frame.fill(0x41);
  frame.front() = '<', frame.back() = '>';
  for (std::size_t i = 0; i < 3; ++i) put_word(frame.data() + 1 + 4 * i, answer.encoders[i]);
  frame[13] = static_cast<unsigned char>(0x41 + (answer.homed << 4U | answer.buttons));
  return frame;
}

std::optional<Answer> decode_answer(std::span<const unsigned char, frame_bytes> bytes) {
  if (bytes.front() != '<' || bytes.back() != '>') return std::nullopt;
  for (std::size_t i = 1; i < 13; ++i) {
    if (bytes[i] < 0x41 || bytes[i] > 0x50) return std::nullopt;
  }
  Answer answer;
  for (std::size_t i = 0; i < 3; ++i) answer.encoders[i] = get_word(bytes.data() + 1 + 4 * i);
  const unsigned status = static_cast<unsigned>(bytes[13] - 0x41);
  answer.homed = status >> 4U & 7U;
  answer.buttons = status & 0xfU;
  return answer;
}

}  // namespace falcon

namespace {

// FTDI vendor requests.
constexpr std::uint8_t request_reset = 0, request_modem = 1, request_flow = 2, request_baud = 3, request_data = 4,
                       request_latency = 9;
constexpr std::uint8_t endpoint_out = 0x02, endpoint_in = 0x81;
constexpr std::uint16_t purge_received = 1, purge_sent = 2;  // values of request_reset
constexpr double confirm_s = 0.01;                           // ten frames of the servo rate

class Falcon final : public HapticDevice {
 public:
  explicit Falcon(const FalconOptions& options)
      : options_(options), usb_(context_, falcon::vendor, falcon::product, options.serial) {
    purge();
    normal_mode();
    if (!answers()) {
      if (options_.firmware.empty()) {
        throw DeviceError(DeviceStatus::failed, "Novint Falcon: no firmware is running and the hardware map names none",
                          "set \"firmware\" to the vendor's file");
      }
      upload(read_file(options_.firmware));
      normal_mode();
      if (!answers())
        throw DeviceError(DeviceStatus::failed, fmt::format("Novint Falcon: does not answer after {} was uploaded",
                                                            options_.firmware.string()));
    }
    identity_ = {std::string(falcon_device.id), usb_.serial(), options_.firmware.filename().string(),
                 fmt::format("nominal scale {} counts per N m", options_.counts_per_newton_metre), options_.emulated};
  }
  ~Falcon() override { zero_force(); }
  Falcon(const Falcon&) = delete;
  Falcon& operator=(const Falcon&) = delete;

  [[nodiscard]] const DeviceIdentity& identity() const override { return identity_; }
  [[nodiscard]] double watchdog_s() const override { return 0.0; }
  [[nodiscard]] bool calibrated() const override { return answer_.homed == 7U && position_known_; }

  DeviceState exchange(const Vec3& f_W_N, double deadline_s) override {
    falcon::Command command;
    if (calibrated()) {
      command.motors =
          falcon::motor_counts(falcon::motor_torques(position_m_, angles_, f_W_N), options_.counts_per_newton_metre);
    }
    transfer(command, deadline_s);
    DeviceState state;
    state.t_s = clock_.now_s();
    state.buttons = answer_.buttons;
    for (std::size_t i = 0; i < 3; ++i) angles_[i] = falcon::angle_of_count(answer_.encoders[i]);
    const auto position = falcon::forward(angles_, position_known_ ? position_m_ : Vec3(0, 0, 0.11));
    position_known_ = position.has_value();
    if (position) {
      if (last_s_ > 0.0 && state.t_s > last_s_) state.v_W_m_per_s = (*position - position_m_) / (state.t_s - last_s_);
      position_m_ = *position;
      last_s_ = state.t_s;
    }
    state.p_W_m = position_m_;
    return state;
  }

  bool zero_force() noexcept override {
    try {
      // Old answers out of the way first, so that the one that comes confirms this command.
      usb_.control(request_reset, purge_received, 0, confirm_s);
      transfer(falcon::Command{}, clock_.now_s() + confirm_s);
      return true;
    } catch (...) {
      return false;
    }
  }

 private:
  void purge() {
    usb_.control(request_reset, purge_received, 0, options_.timeout_s);
    usb_.control(request_reset, purge_sent, 0, options_.timeout_s);
  }

  void normal_mode() {
    usb_.control(request_latency, 1, 0, options_.timeout_s);
    usb_.control(request_baud, 0x2, 0, options_.timeout_s);  // 1.5 Mbaud
    purge();
  }

  bool answers() {
    for (int attempt = 0; attempt < 3; ++attempt) {
      try {
        // A boot loader in the middle of an upload echoes what it gets, which looks like an answer.
        const falcon::Command question;
        transfer(question, clock_.now_s() + 0.1);
        return last_frame_ != falcon::encode(question);
      } catch (const DeviceError& error) {
        if (error.device_status() != DeviceStatus::timed_out && error.device_status() != DeviceStatus::failed) throw;
      }
    }
    return false;
  }

  // One frame out, one frame back; bytes before a frame's `<` are skipped, a broken frame is an error.
  void transfer(const falcon::Command& command, double deadline_s) {
    usb_.write(endpoint_out, falcon::encode(command), std::max(1e-3, deadline_s - clock_.now_s()));
    std::vector<unsigned char> bytes;
    std::array<unsigned char, 64> packet;
    for (;;) {
      const double left = deadline_s - clock_.now_s();
      if (left <= 0.0) throw DeviceError(DeviceStatus::timed_out, "Novint Falcon: no whole frame before the deadline");
      const std::size_t n = usb_.read(endpoint_in, packet, left);
      if (n > 2)
        bytes.insert(bytes.end(), packet.begin() + 2,
                     packet.begin() + static_cast<std::ptrdiff_t>(n));  // after the modem bytes
      bytes.erase(bytes.begin(), std::find(bytes.begin(), bytes.end(), '<'));
      if (bytes.size() < falcon::frame_bytes) continue;
      const auto answer =
          falcon::decode_answer(std::span<const unsigned char, falcon::frame_bytes>(bytes.data(), falcon::frame_bytes));
      if (!answer) throw DeviceError(DeviceStatus::failed, "Novint Falcon: a frame is damaged");
      answer_ = *answer;
      std::copy_n(bytes.begin(), last_frame_.size(), last_frame_.begin());
      return;
    }
  }

  std::vector<unsigned char> reply(std::size_t wanted) {
    const double deadline = clock_.now_s() + options_.timeout_s;
    std::vector<unsigned char> bytes;
    std::array<unsigned char, 64> packet;
    while (bytes.size() < wanted && clock_.now_s() < deadline) {
      const std::size_t n = usb_.read(endpoint_in, packet, std::max(1e-3, deadline - clock_.now_s()));
      if (n > 2) bytes.insert(bytes.end(), packet.begin() + 2, packet.begin() + static_cast<std::ptrdiff_t>(n));
    }
    return bytes;
  }

  void upload(const std::string& firmware) {
    purge();
    usb_.control(request_latency, 16, 0, options_.timeout_s);
    usb_.control(request_baud, 0x4138, 0, options_.timeout_s);  // 9600 baud
    usb_.control(request_data, 8, 0, options_.timeout_s);
    usb_.control(request_flow, 0, 0, options_.timeout_s);
    usb_.control(request_modem, 0x0200, 0, options_.timeout_s);  // RTS low
    usb_.control(request_modem, 0x0100, 0, options_.timeout_s);  // DTR low: resets the board
    usb_.control(request_modem, 0x0101, 0, options_.timeout_s);  // DTR high
    const std::array<unsigned char, 3> hello{0x0a, 0x43, 0x0d};
    usb_.write(endpoint_out, hello, options_.timeout_s);
    const auto greeting = reply(4);
    const std::array<unsigned char, 4> expected{0x0a, 0x44, 0x2c, 0x0d};
    if (std::search(greeting.begin(), greeting.end(), expected.begin(), expected.end()) == greeting.end()) {
      throw DeviceError(DeviceStatus::failed, "Novint Falcon: the boot loader did not answer as expected",
                        "switch the device off and on");
    }
    usb_.control(request_modem, 0x0100, 0, options_.timeout_s);
    usb_.control(request_baud, 0x15, 0, options_.timeout_s);  // 140 kbaud
    const std::array<unsigned char, 1> start{0x41};
    usb_.write(endpoint_out, start, options_.timeout_s);
    if (const auto echo = reply(1); echo.size() != 1 || echo[0] != 0x41) {
      throw DeviceError(DeviceStatus::failed, "Novint Falcon: the boot loader did not switch to 140 kbaud");
    }
    constexpr std::size_t chunk = 62;  // with the modem bytes, a full-speed packet
    for (std::size_t at = 0; at < firmware.size(); at += chunk) {
      const std::vector<unsigned char> part(
          firmware.begin() + static_cast<std::ptrdiff_t>(at),
          firmware.begin() + static_cast<std::ptrdiff_t>(std::min(firmware.size(), at + chunk)));
      usb_.write(endpoint_out, part, options_.timeout_s);
      if (reply(part.size()) != part) {
        throw DeviceError(
            DeviceStatus::failed,
            fmt::format("Novint Falcon: the echo of the firmware differs near byte {}; it was not started", at));
      }
    }
  }

  FalconOptions options_;
  UsbContext context_;
  UsbHandle usb_;
  DeviceIdentity identity_;
  MonotonicClock clock_;
  falcon::Answer answer_;
  falcon::Frame last_frame_{};
  falcon::Angles angles_{};
  Vec3 position_m_ = Vec3::Zero();
  bool position_known_ = false;
  double last_s_ = 0.0;
};

}  // namespace

std::unique_ptr<HapticDevice> open_falcon(const FalconOptions& options) { return std::make_unique<Falcon>(options); }

constexpr KnownDevice falcon_device{.id = "novint-falcon",
                                    .name = "Novint Falcon",
                                    .role = DeviceRole::haptic_device,
                                    .bus = Bus::usb,
                                    .usb = {UsbName{falcon::vendor, falcon::product, ""}},
                                    .source = "libnifalcon; linux-usb.org",
                                    .confidence = Confidence::confirmed,
                                    .note = "has no watchdog of its own: only run behind the guardian process",
                                    .calibrating = "move its grip all the way out, then all the way in",
                                    .open_handle = [](const MappedDevice& device) -> std::unique_ptr<HapticDevice> {
                                      FalconOptions options;
                                      options.serial = device.serial;
                                      options.firmware = device.firmware;
                                      return open_falcon(options);
                                    }};

}  // namespace touchstone::hil
