#include "safety/rescue.h"

#include <poll.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <sys/time.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <csignal>

namespace touchstone::hil {
namespace {

constexpr double shortest_turn_s = 0.05;  // for a device that opens at once
// Vendors' openings take about a second (hdInitDevice, dhdOpen); one that takes longer than this is taken to hang. The
// next one of the same watchman may take twice as long.
constexpr double longest_attempt_s = 2.0, longest_of_all_s = 10.0;
// Between attempts: a twentieth of the time that they take already, so that a device that comes back within
// milliseconds is not missed, and one that stays away for minutes costs next to nothing.
constexpr double shortest_pause_s = 2e-4, longest_pause_s = 1.0, pause_share = 0.05;
constexpr double says_so_s = 0.05;     // without zero for so long, the program is told to use the physical switch
constexpr double gives_up_s = 3600.0;  // nobody is there

// So that an attempt ends by itself even if the process that started it is stopped, and with it if it dies: whoever is
// left starts one of its own.
void end_after(double seconds) {
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  double whole = 0.0;
  const double rest = std::modf(seconds, &whole);
  const itimerval timer{{0, 0}, {static_cast<time_t>(whole), static_cast<suseconds_t>(rest * 1e6)}};
  std::signal(SIGALRM, SIG_DFL);
  ::setitimer(ITIMER_REAL, &timer, nullptr);
}

}  // namespace

ProcessHandle::ProcessHandle(pid_t pid) : fd_(static_cast<int>(::syscall(SYS_pidfd_open, pid, 0U))) {}
ProcessHandle::~ProcessHandle() {
  if (fd_ >= 0) ::close(fd_);
}
void ProcessHandle::kill() const noexcept {
  if (fd_ >= 0) ::syscall(SYS_pidfd_send_signal, fd_, SIGKILL, nullptr, 0U);
}

bool ProcessHandle::ends_within(double seconds) const noexcept {
  pollfd ended{fd_, POLLIN, 0};
  return fd_ < 0 || ::poll(&ended, 1, static_cast<int>(std::lround(1e3 * seconds))) > 0;
}

Rescue::Rescue(Watchman self, const OpenDevice& open, GuardPage& page, double other_silent_s)
    : self_(self),
      other_(self == Watchman::guard ? Watchman::rescuer : Watchman::guard),
      open_(open),
      page_(page),
      other_silent_s_(other_silent_s) {}

void Rescue::begin(Trip reason) noexcept {
  reason_ = reason;
  page_.trip_for(reason);
  begun_s_ = clock_.now_s();
  double never = 0.0;
  page_.tripped_s.compare_exchange_strong(never, begun_s_);
  turn_s_ = shortest_turn_s + 2.0 * page_.open_took_s;
  longest_s_ = std::max(longest_attempt_s, 2.0 * turn_s_);
}

bool Rescue::step() noexcept {
  const double now = clock_.now_s();
  if (attempt_ != 0) {
    // Nothing to wait for where the kernel reaps by itself (SIGCHLD ignored): then it is an error once it has ended.
    if (::waitpid(attempt_, nullptr, WNOHANG) != 0) {
      attempt_ = 0;
      if (!page_.rescued) failed(now, "an attempt to bring the device to zero failed");
    } else if (now > deadline_s_) {
      ::kill(attempt_, SIGKILL);  // still a child of this process: the number cannot be another's
      ::waitpid(attempt_, nullptr, 0);
      attempt_ = 0;
      longest_s_ = std::min(std::max(longest_of_all_s, longest_s_), 2.0 * longest_s_);
      failed(now, "an attempt to bring the device to zero took too long");
    } else if (now > turn_ends_s_ && page_.turn == self_) {
      page_.turn = other_;
    }
  }
  if (page_.rescued || now - begun_s_ > gives_up_s) return true;
  if (now - begun_s_ > says_so_s && page_.phase == GuardPhase::rescue)
    note(GuardPhase::unconfirmed, "force may still be on: use the physical switch");
  if (attempt_ != 0 || now < not_before_s_) return false;
  if (page_.turn == self_ || now - page_.beat_s(other_) > other_silent_s_) start(now);
  return false;
}

void Rescue::start(double now_s) noexcept {
  page_.turn = self_;
  ++page_.attempts;
  turn_ends_s_ = now_s + turn_s_;
  deadline_s_ = now_s + longest_s_;
  const bool none_before = no_process_;
  attempt_ = ::fork();
  if (attempt_ == 0) {
    std::signal(SIGCHLD, SIG_DFL);  // as a vendor's library expects it
    end_after(2.0 * longest_s_);
    ::_exit(bring_to_rest_anew(deadline_s_) ? 0 : 1);
  }
  no_process_ = attempt_ < 0;
  if (!no_process_) return;
  attempt_ = 0;
  failed(now_s, "no process can be started");
  // The second time nobody else could either, and a call that blocks here is better than a force that stays.
  if (none_before && !page_.rescued) static_cast<void>(bring_to_rest_anew(clock_.now_s() + longest_s_));
}

void Rescue::failed(double now_s, const char* what) noexcept {
  note(page_.phase == GuardPhase::unconfirmed ? GuardPhase::unconfirmed : GuardPhase::rescue, what);
  not_before_s_ = now_s + std::clamp(pause_share * (now_s - begun_s_), shortest_pause_s, longest_pause_s);
  page_.turn = other_;
}

void Rescue::note(GuardPhase phase, const char* what) noexcept {
  // Not after zero was confirmed, which another process may do meanwhile.
  if (GuardPhase now = page_.phase; now != GuardPhase::off && page_.phase.compare_exchange_strong(now, phase))
    page_.log(clock_.now_s(), phase, reason_, what);
}

bool Rescue::bring_to_rest_anew(double deadline_s) const noexcept {
  try {
    const auto device = open_();
    if (!bring_to_rest(*device, deadline_s)) return false;
    page_.device_zero = true;
    page_.pushing = false;
    page_.zeroed_s = clock_.now_s();
    page_.phase = GuardPhase::off;
    if (!page_.rescued.exchange(true))
      page_.log(clock_.now_s(), GuardPhase::off, reason_, "the device was opened anew and confirmed zero");
    return true;
  } catch (...) {
    return false;
  }
}

}  // namespace touchstone::hil
