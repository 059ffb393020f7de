// A library with comedilib's functions and a card behind it that measures what the environment says:
//   TOUCHSTONE_STUB_COMEDI_VOLTS  six voltages, present from 0.4 s after the start on (before: zero)
//   TOUCHSTONE_STUB_COMEDI_FAULT  absent, forbidden, busy, no-range, overrun, unplug, silent
// It encodes our reading of comedilib; it is not comedilib and there is no card.
#include <comedilib.h>
#include <fcntl.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cmath>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <sstream>
#include <string>
#include <thread>

struct comedi_t_struct {
  int ends[2] = {-1, -1};
  std::atomic<bool> stop{false};
  std::thread thread;
  double period_s = 2e-4;
};

namespace {

int last_error = 0;
comedi_range range_10V{-10.0, 10.0, UNIT_volt};

std::string fault() {
  const char* const text = std::getenv("TOUCHSTONE_STUB_COMEDI_FAULT");
  return text != nullptr ? text : "";
}

void stream(comedi_t* card) {
  double volts[6] = {};
  if (const char* const text = std::getenv("TOUCHSTONE_STUB_COMEDI_VOLTS")) {
    std::istringstream in(text);
    for (double& v : volts) in >> v;
  }
  timespec next{};
  clock_gettime(CLOCK_MONOTONIC, &next);
  for (long n = 0; !card->stop; ++n) {
    if (fault() == "silent") return;
    if (fault() == "unplug" && n > 3000) break;
    sampl_t counts[6];
    for (int k = 0; k < 6; ++k) {
      const double v = static_cast<double>(n) * card->period_s > 0.4 ? volts[k] : 0.0;
      counts[k] = static_cast<sampl_t>(std::lround((v + 10.0) / 20.0 * 65535.0));
    }
    if (::write(card->ends[1], counts, sizeof counts) < 0) break;
    next.tv_nsec += static_cast<long>(card->period_s * 1e9);
    while (next.tv_nsec >= 1000000000) next.tv_nsec -= 1000000000, ++next.tv_sec;
    if (n % 16 == 0) clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &next, nullptr);
  }
  ::close(card->ends[1]);
  card->ends[1] = -1;
}

}  // namespace

extern "C" {  // parameters as comedilib.h names them
comedi_t* comedi_open(const char*) {
  const auto f = fault();
  last_error = f == "absent" ? ENOENT : f == "forbidden" ? EACCES : f == "busy" ? EBUSY : 0;
  return last_error == 0 ? new comedi_t : nullptr;
}
int comedi_cancel(comedi_t* it, unsigned) {
  it->stop = true;
  if (it->ends[0] >= 0) ::close(it->ends[0]);
  it->ends[0] = -1;
  if (it->thread.joinable()) it->thread.join();
  return 0;
}
int comedi_close(comedi_t* it) {
  comedi_cancel(it, 0);
  delete it;
  return 0;
}
int comedi_errno(void) { return last_error; }
const char* comedi_strerror(int errnum) { return std::strerror(errnum); }
const char* comedi_get_board_name(comedi_t*) { return "stub card (emulated)"; }
int comedi_get_read_subdevice(comedi_t*) { return 0; }
lsampl_t comedi_get_maxdata(comedi_t*, unsigned, unsigned) { return 65535; }
int comedi_find_range(comedi_t*, unsigned, unsigned, unsigned, double, double) {
  return fault() == "no-range" ? -1 : 0;
}
comedi_range* comedi_get_range(comedi_t*, unsigned, unsigned, unsigned) { return &range_10V; }
double comedi_to_phys(lsampl_t data, comedi_range* rng, lsampl_t maxdata) {
  return rng->min + (rng->max - rng->min) * data / maxdata;
}
int comedi_get_subdevice_flags(comedi_t*, unsigned) { return 0; }
int comedi_get_cmd_generic_timed(comedi_t* dev, unsigned, comedi_cmd*, unsigned, unsigned period_ns) {
  dev->period_s = 1e-9 * period_ns;
  return 0;
}
int comedi_command_test(comedi_t*, comedi_cmd*) { return 0; }
int comedi_command(comedi_t* it, comedi_cmd*) {
  if (::pipe2(it->ends, O_CLOEXEC) != 0) return -1;
  ::signal(SIGPIPE, SIG_IGN);
  it->stop = false;
  it->thread = std::thread(stream, it);
  return 0;
}
int comedi_fileno(comedi_t* it) { return it->ends[0]; }
}
