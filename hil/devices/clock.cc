#include <cerrno>
#include <cmath>
#include <ctime>

#include "devices/interfaces.h"

namespace touchstone::hil {

double MonotonicClock::now_s() const {
  timespec t{};
  clock_gettime(CLOCK_BOOTTIME, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

void MonotonicClock::sleep_until(double t_s) {
  timespec t{};
  t.tv_sec = static_cast<time_t>(std::floor(t_s));
  t.tv_nsec = static_cast<long>((t_s - std::floor(t_s)) * 1e9);
  while (clock_nanosleep(CLOCK_BOOTTIME, TIMER_ABSTIME, &t, nullptr) == EINTR) {
  }
}

}  // namespace touchstone::hil
