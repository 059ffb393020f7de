#include "hil/safety/guard_page.h"

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
  const std::uint64_t number = ++next_;
  Slot& slot = log_[number % slots];
  slot.number = 0;
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
    found.emplace_back(number, GuardEvent{slot.t_s, slot.phase, slot.reason, slot.what});
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

}  // namespace touchstone::hil
