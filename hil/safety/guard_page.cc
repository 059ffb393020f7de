#include "safety/guard_page.h"

#include <fmt/format.h>
#include <sys/mman.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <new>

namespace touchstone::hil {

static_assert(std::atomic<double>::is_always_lock_free && std::atomic<GuardPhase>::is_always_lock_free &&
              std::atomic<Trip>::is_always_lock_free);

std::string_view to_string(GuardPhase phase) {
  constexpr std::array names{"opening", "at zero", "pushing", "letting go", "rescue", "off", "UNCONFIRMED"};
  return names[static_cast<std::size_t>(phase)];
}

void GuardPage::log(double t_s, GuardPhase at, Trip reason, const char* what) noexcept {
  if (const std::uint64_t last = last_; last > 0) {
    Slot& slot = log_[slot_of(last)];
    if (slot.number == last && slot.phase == at && slot.reason == reason &&
        std::strncmp(slot.what, what, sizeof slot.what - 1) == 0) {
      ++slot.times;
      return;
    }
  }
  const std::uint64_t number = ++last_;
  Slot& slot = log_[slot_of(number)];
  slot.number = 0;
  slot.times = 1;
  slot.t_s = t_s;
  slot.phase = at;
  slot.reason = reason;
  std::strncpy(slot.what, what, sizeof slot.what - 1);
  slot.number = number;
}

std::vector<GuardEvent> GuardPage::events() const {
  std::vector<std::pair<std::uint64_t, GuardEvent>> found;
  for (const Slot& slot : log_) {
    const std::uint64_t number = slot.number;
    if (number == 0) continue;
    found.emplace_back(number, GuardEvent{slot.t_s, slot.phase, slot.reason, slot.what, slot.times});
  }
  std::sort(found.begin(), found.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  std::vector<GuardEvent> events;
  for (auto& [number, event] : found) events.push_back(std::move(event));
  return events;
}

std::shared_ptr<GuardPage> make_guard_page() {
  void* const memory =
      ::mmap(nullptr, sizeof(GuardPage), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS | MAP_POPULATE, -1, 0);
  if (memory == MAP_FAILED)
    throw DeviceError(DeviceStatus::failed, fmt::format("the guard's shared memory: {}", std::strerror(errno)));
  return {new (memory) GuardPage, [](GuardPage* page) { ::munmap(page, sizeof(GuardPage)); }};
}

void let_write(GuardPage& page, bool may) noexcept {
  ::mprotect(&page, sizeof page, may ? PROT_READ | PROT_WRITE : PROT_READ);
}

}  // namespace touchstone::hil
