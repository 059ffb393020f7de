// A USB device that unmodified libusb sees: umockdev's testbed with a handler that speaks the kernel's usbdevfs calls.
// The program must run with libumockdev-preload.so.0 preloaded. For correctness only: a frame costs most of a
// millisecond.
#pragma once

#include <atomic>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "drivers/falcon.h"

namespace touchstone::hil {

// What the device does with what it is sent. Called from the emulator's thread.
class EmulatedUsbModel {
 public:
  virtual ~EmulatedUsbModel() = default;
  virtual void control(unsigned request, unsigned value) = 0;
  virtual void received(const std::vector<unsigned char>& bytes) = 0;
  // The next packet for the host; nothing where there is none yet.
  virtual std::optional<std::vector<unsigned char>> packet() = 0;
};

struct UsbFaults {
  std::atomic<bool> stall{false};          // bulk transfers answer with a stall
  std::atomic<bool> silent{false};         // nothing comes in: transfers time out
  std::atomic<bool> busy{false};           // another program holds the interface
  std::atomic<bool> short_packets{false};  // every answer is cut after 7 bytes and the rest is lost
  std::atomic<bool> gone{false};           // unplugged, also in mid-transfer
};

class UsbEmulator {
 public:
  struct Identity {
    std::uint16_t vendor = 0x0403, product = 0xcb48;
    std::string product_name = "FALCON HAPTIC", serial = "EMUF0001";
  };
  UsbEmulator(const Identity& identity, EmulatedUsbModel& model);
  ~UsbEmulator();
  UsbEmulator(const UsbEmulator&) = delete;
  UsbEmulator& operator=(const UsbEmulator&) = delete;

  UsbFaults faults;
  void forbid();  // takes the user's permission on the device node away
  // Leaves the bus and comes to it again, with the kernel's messages that libusb listens to. A new device is plugged.
  void unplug();
  void plug();
  [[nodiscard]] static bool preloaded();

  // The handler's state, for its C callbacks.
  struct Testbed;

 private:
  std::unique_ptr<Testbed> testbed_;
};

// A Falcon behind the USB emulator: boot loader, firmware with echo, frames, homing, motors. Without a watchdog, as the
// real one. Frames and boot loader follow libnifalcon's FalconFirmwareNovintSDK.cpp and FalconCommLibUSB.cpp (revision
// f7c727a), homing its FalconFirmware.h: "the homing mode bit must be set in each input packet sent in order for the
// falcon to stay homed". Nothing is taken from the driver that it tests.
class FalconModel final : public EmulatedUsbModel {
 public:
  // Runs at once, or after a firmware of that many bytes was uploaded.
  explicit FalconModel(bool firmware_running, std::size_t firmware_size = 1)
      : firmware_size_(firmware_size), running_(firmware_running) {}
  void control(unsigned request, unsigned value) override;
  void received(const std::vector<unsigned char>& bytes) override;
  std::optional<std::vector<unsigned char>> packet() override;

  void set_encoders(const std::array<int, 3>& counts);
  void damage_next_frames(int count) { damaged_ = count; }
  void damage_echo() { bad_echo_ = true; }
  [[nodiscard]] std::array<int, 3> motors() const;
  [[nodiscard]] std::size_t firmware_bytes() const;

 private:
  void send(const std::vector<unsigned char>& bytes);

  mutable std::mutex mutex_;
  std::deque<std::vector<unsigned char>> out_;
  std::vector<unsigned char> in_;
  std::array<int, 3> encoders_{}, motors_{};
  std::size_t firmware_size_;
  std::size_t firmware_bytes_ = 0;
  int frames_ = 0;
  bool running_, booting_ = false, loading_ = false;
  std::atomic<int> damaged_{0};
  std::atomic<bool> bad_echo_{false};
};

}  // namespace touchstone::hil
