// An emulated haptic device in a file that processes share: what it applies outlives the program that commanded it, as
// a real device does. With a watchdog it lets go when no command has come for that long; without, it holds for ever.
#pragma once

#include <atomic>
#include <filesystem>
#include <memory>

#include "devices/interfaces.h"

namespace touchstone::hil {

// What lies in the shared file.
struct EmulatedHapticState {
  std::atomic<double> force_N[3];
  std::atomic<double> commanded_at_s;
  std::atomic<double> watchdog_s;  // 0: none
  std::atomic<double> last_zeroed_at_s;
  std::atomic<std::uint64_t> commands;
};

// The device itself, seen from the test.
class EmulatedHapticPlant {
 public:
  EmulatedHapticPlant(const std::filesystem::path& file, double watchdog_s);
  ~EmulatedHapticPlant();
  EmulatedHapticPlant(const EmulatedHapticPlant&) = delete;
  EmulatedHapticPlant& operator=(const EmulatedHapticPlant&) = delete;

  // What the motors apply now.
  [[nodiscard]] Vec3 applied_N() const;
  [[nodiscard]] std::uint64_t commands() const;

 private:
  std::filesystem::path file_;
  EmulatedHapticState* state_;
};

// The driver's side; opens the file that a plant made, and throws DeviceError if there is none. The handle swings
// slowly through a centimetre.
std::unique_ptr<HapticDevice> open_emulated_haptic(const std::filesystem::path& file);

}  // namespace touchstone::hil
