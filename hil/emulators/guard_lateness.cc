#include "emulators/guard_lateness.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

namespace touchstone::hil {
namespace {

constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
constexpr double between_looks_s = 0.0005;  // a twelfth of the shortest patience
constexpr double kept_s = 2.0;              // longer than every patience that a test gives the guard

}  // namespace

double patience_of(Trip reason, const GuardOptions& options) {
  switch (reason) {
    case Trip::stale:
      return options.limits.stale_s;
    case Trip::driver_silent:
      return options.driver_timeout_s;
    case Trip::guard_gone:
    case Trip::watchdog_gone:
      return options.watchdog_s;
    default:
      return 0.0;
  }
}

bool explains(const GuardWaits& waits, Trip reason, const GuardOptions& options) {
  // Whose waits add up to the silence: a command and the state that answers it pass the program, the guard and the
  // driver; an answer of the driver is waited for by the guard; the rescuer sees the guard alone, and the guard the
  // rescuer.
  double silence = 0.0;
  if (reason == Trip::stale) silence = waits.program_s + waits.guard_s + waits.driver_s;
  if (reason == Trip::driver_silent) silence = waits.guard_s + waits.driver_s;
  if (reason == Trip::guard_gone) silence = waits.guard_s;
  if (reason == Trip::watchdog_gone) silence = waits.rescuer_s;
  const double patience = patience_of(reason, options);
  if (patience <= 0.0) return false;
  const double needed = patience - usual_silence_s;
  return silence >= needed || waits.watcher_s >= needed;  // false for NaN
}

GuardLateness::GuardLateness(int program_pid, const GuardPage& page) : page_(page), program_pid_(program_pid) {
  files_.fill(-1);
  last_s_.fill(unknown);
}

GuardLateness::~GuardLateness() {
  for (const int file : files_) {
    if (file >= 0) ::close(file);
  }
}

double GuardLateness::total_s(std::size_t process) {
  if (files_[process] < 0) {
    const std::array<int, 4> pids{program_pid_, page_.guard_pid, page_.driver_pid, page_.rescuer_pid};
    if (pids[process] <= 0) return unknown;
    files_[process] = ::open(fmt::format("/proc/{}/schedstat", pids[process]).c_str(), O_RDONLY | O_CLOEXEC);
    if (files_[process] < 0) return unknown;
  }
  std::array<char, 96> text{};
  unsigned long long ran_ns = 0, waited_ns = 0;
  const auto size = ::pread(files_[process], text.data(), text.size() - 1, 0);
  // A process that is gone waits no more.
  if (size > 0 && std::sscanf(text.data(), "%llu %llu", &ran_ns, &waited_ns) == 2)
    last_s_[process] = 1e-9 * static_cast<double>(waited_ns);
  return last_s_[process];
}

void GuardLateness::look(double due_s) {
  const double now = clock_.now_s();
  const double late = std::max(0.0, now - due_s);
  if (!looks_.empty() && now - looks_.back().t_s < between_looks_s && late < between_looks_s) return;
  Look look;
  look.t_s = now;
  look.watcher_s = late;
  for (std::size_t i = 0; i < files_.size(); ++i) look.total_s[i] = total_s(i);
  looks_.push_back(look);
  while (now - looks_.front().t_s > kept_s) looks_.pop_front();
}

GuardWaits GuardLateness::since(double t_s) const {
  if (looks_.empty()) return {unknown, unknown, unknown, unknown, 0.0};
  auto from = looks_.begin();
  while (std::next(from) != looks_.end() && std::next(from)->t_s <= t_s) ++from;
  // A process that was not there yet had not waited yet.
  const auto waited = [&](std::size_t i) {
    return looks_.back().total_s[i] - (std::isnan(from->total_s[i]) ? 0.0 : from->total_s[i]);
  };
  GuardWaits waits{waited(0), waited(1), waited(2), waited(3), 0.0};
  for (auto look = std::next(from); look != looks_.end(); ++look)
    waits.watcher_s = std::max(waits.watcher_s, look->watcher_s);
  return waits;
}

}  // namespace touchstone::hil
