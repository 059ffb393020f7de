#include "harness/plugin/plugin_channel.h"

#include <linux/futex.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <climits>
#include <ctime>

namespace touchstone::plugin {
namespace {

// Longer than a usual step and the way of a word from one processor to another. Not much longer: where other programs
// want the processors too, one that looks keeps the one it waits for from running (bench_plugin with both processors
// busy: 1.7 us a step at 5 us, 45 us and more at 20 us and above).
constexpr std::chrono::microseconds looking{5};

// On one processor the other side cannot work while this one looks.
bool may_look() noexcept {
  static const bool several = ::sysconf(_SC_NPROCESSORS_ONLN) > 1;
  return several;
}

void relax() noexcept {
#if defined(__x86_64__) || defined(__i386__)
  __builtin_ia32_pause();
#endif
}

void futex_wait(std::atomic<std::uint32_t>& word, std::uint32_t seen, std::chrono::nanoseconds limit) noexcept {
  const auto seconds = std::chrono::duration_cast<std::chrono::seconds>(limit);
  const std::timespec relative{static_cast<std::time_t>(seconds.count()), static_cast<long>((limit - seconds).count())};
  ::syscall(SYS_futex, &word, FUTEX_WAIT, seen, &relative, nullptr, 0);
}

}  // namespace

const char* name_of(PluginRequest request, unsigned version) noexcept {
  const bool first = version == TOUCHSTONE_PLUGIN_VERSION;
  switch (request) {
    case PluginRequest::create:
      return first ? "touchstone_create" : "touchstone2_create";
    case PluginRequest::reset:
      return first ? "touchstone_reset" : "touchstone2_reset";
    case PluginRequest::step:
      return first ? "touchstone_step" : "touchstone2_step";
    case PluginRequest::destroy:
      return first ? "touchstone_destroy" : "touchstone2_destroy";
  }
  return "?";
}

void Doorbell::ring() noexcept {
  // In one order with await(): either the sleeper is seen here, or the count is seen there.
  count.fetch_add(1, std::memory_order_seq_cst);
  if (sleepers.load(std::memory_order_seq_cst) != 0) {
    ::syscall(SYS_futex, &count, FUTEX_WAKE, INT_MAX, nullptr, nullptr, 0);
  }
}

bool Doorbell::await(std::uint32_t seen, std::chrono::nanoseconds limit) noexcept {
  using Clock = std::chrono::steady_clock;
  const auto begin = Clock::now();
  if (may_look()) {
    do {
      for (int i = 0; i < 32; ++i) {
        if (count.load(std::memory_order_acquire) != seen) return true;
        relax();
      }
    } while (Clock::now() - begin < std::min<std::chrono::nanoseconds>(looking, limit));
  }
  for (;;) {
    const auto left = limit - (Clock::now() - begin);
    if (count.load(std::memory_order_acquire) != seen) return true;
    if (left <= std::chrono::nanoseconds::zero()) return false;
    sleepers.fetch_add(1, std::memory_order_seq_cst);
    if (count.load(std::memory_order_seq_cst) == seen) futex_wait(count, seen, left);
    sleepers.fetch_sub(1, std::memory_order_seq_cst);
  }
}

}  // namespace touchstone::plugin
