#include "safety/stop_signal.h"

#include <ctime>
#include <initializer_list>

namespace touchstone::hil {

StopSignal::StopSignal() {
  sigemptyset(&watched_);
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) sigaddset(&watched_, signal);
  pthread_sigmask(SIG_BLOCK, &watched_, &before_);
}

StopSignal::~StopSignal() { pthread_sigmask(SIG_SETMASK, &before_, nullptr); }

bool StopSignal::asked() noexcept {
  const timespec now{};
  while (sigtimedwait(&watched_, nullptr, &now) > 0) asked_ = true;
  return asked_;
}

}  // namespace touchstone::hil
