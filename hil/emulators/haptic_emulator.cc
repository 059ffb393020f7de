#include "emulators/haptic_emulator.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cmath>
#include <new>
#include <stdexcept>

namespace touchstone::hil {
namespace {

EmulatedHapticState* map_state(const std::filesystem::path& file, bool create) {
  static_assert(std::atomic<double>::is_always_lock_free);
  const int fd = ::open(file.c_str(), O_RDWR | O_CLOEXEC | (create ? O_CREAT | O_TRUNC : 0), 0600);
  if (fd < 0) throw DeviceError(DeviceStatus::absent, fmt::format("{}: no emulated device there", file.string()));
  if (create && ::ftruncate(fd, sizeof(EmulatedHapticState)) != 0) throw std::runtime_error("ftruncate");
  void* const memory = ::mmap(nullptr, sizeof(EmulatedHapticState), PROT_READ | PROT_WRITE, MAP_SHARED, fd, 0);
  ::close(fd);
  if (memory == MAP_FAILED) throw std::runtime_error("mmap");
  return create ? new (memory) EmulatedHapticState{} : static_cast<EmulatedHapticState*>(memory);
}

class EmulatedHaptic final : public HapticDevice {
 public:
  explicit EmulatedHaptic(const std::filesystem::path& file)
      : state_(map_state(file, false)),
        identity_{"novint-falcon", "EMU-" + file.filename().string(), "emulated", "", true} {}
  ~EmulatedHaptic() override { ::munmap(state_, sizeof *state_); }
  EmulatedHaptic(const EmulatedHaptic&) = delete;
  EmulatedHaptic& operator=(const EmulatedHaptic&) = delete;

  [[nodiscard]] const DeviceIdentity& identity() const override { return identity_; }
  [[nodiscard]] double watchdog_s() const override { return state_->watchdog_s; }
  [[nodiscard]] bool calibrated() const override { return true; }
  DeviceState exchange(const Vec3& f_W_N, double) override {
    command(f_W_N);
    DeviceState state;
    state.t_s = clock_.now_s();
    state.p_W_m = Vec3(0.01 * std::sin(state.t_s), 0, 0);
    state.v_W_m_per_s = Vec3(0.01 * std::cos(state.t_s), 0, 0);
    return state;
  }
  bool zero_force() noexcept override {
    command(Vec3::Zero());
    state_->last_zeroed_at_s = clock_.now_s();
    return true;
  }

 private:
  void command(const Vec3& f) noexcept {
    for (int k = 0; k < 3; ++k) state_->force_N[k] = f[k];
    state_->commanded_at_s = clock_.now_s();
    ++state_->commands;
  }

  EmulatedHapticState* state_;
  DeviceIdentity identity_;
  MonotonicClock clock_;
};

}  // namespace

EmulatedHapticPlant::EmulatedHapticPlant(const std::filesystem::path& file, double watchdog_s)
    : file_(file), state_(map_state(file, true)) {
  state_->watchdog_s = watchdog_s;
}

EmulatedHapticPlant::~EmulatedHapticPlant() {
  ::munmap(state_, sizeof *state_);
  std::error_code ignored;
  std::filesystem::remove(file_, ignored);
}

Vec3 EmulatedHapticPlant::applied_N() const {
  const double watchdog = state_->watchdog_s;
  if (watchdog > 0.0 && MonotonicClock().now_s() - state_->commanded_at_s > watchdog) return Vec3::Zero();
  return {state_->force_N[0], state_->force_N[1], state_->force_N[2]};
}

std::uint64_t EmulatedHapticPlant::commands() const { return state_->commands; }

std::unique_ptr<HapticDevice> open_emulated_haptic(const std::filesystem::path& file) {
  return std::make_unique<EmulatedHaptic>(file);
}

}  // namespace touchstone::hil
