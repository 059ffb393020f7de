// A library with comedilib's functions and a card behind it that measures what the environment says:
//   TOUCHSTONE_STUB_COMEDI_VOLTS  six voltages, present from 0.4 s after the start on (before: zero)
//   TOUCHSTONE_STUB_COMEDI_SOFTCAL  the card calibrates in software, by this file: its measured line is
//     volts = -9.7 + 19.6 counts / 65535, as M series boards are off by per cents before it. The functions follow
//     comedilib.h and comedilib's lib/calib.c and lib/range.c: a polynomial about an origin, the ideal line for a card
//     that calibrates in hardware.
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

const char* softcal() { return std::getenv("TOUCHSTONE_STUB_COMEDI_SOFTCAL"); }

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
      const double share = softcal() != nullptr ? (v + 9.7) / 19.6 : (v + 10.0) / 20.0;
      counts[k] = static_cast<sampl_t>(std::lround(share * 65535.0));
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
char* comedi_get_default_calibration_path(comedi_t*) { return ::strdup(softcal()); }
comedi_calibration_t* comedi_parse_calibration_file(const char* cal_file_path) {
  return ::access(cal_file_path, R_OK) == 0 ? new comedi_calibration_t{} : nullptr;
}
void comedi_cleanup_calibration(comedi_calibration_t* calibration) { delete calibration; }
int comedi_get_softcal_converter(unsigned, unsigned, unsigned, comedi_conversion_direction, const comedi_calibration_t*,
                                 comedi_polynomial_t* polynomial) {
  *polynomial = {{-9.7 + 19.6 * 100.0 / 65535.0, 19.6 / 65535.0, 0, 0}, 100.0, 1};
  return 0;
}
int comedi_get_hardcal_converter(comedi_t*, unsigned, unsigned, unsigned, comedi_conversion_direction,
                                 comedi_polynomial_t* polynomial) {
  *polynomial = {{-10.0, 20.0 / 65535.0, 0, 0}, 0.0, 1};
  return 0;
}
double comedi_to_physical(lsampl_t data, const comedi_polynomial_t* conversion_polynomial) {
  double value = 0.0, power = 1.0;
  for (unsigned i = 0; i <= conversion_polynomial->order; ++i) {
    value += conversion_polynomial->coefficients[i] * power;
    power *= data - conversion_polynomial->expansion_origin;
  }
  return value;
}
int comedi_get_subdevice_flags(comedi_t*, unsigned) { return softcal() != nullptr ? SDF_SOFT_CALIBRATED : 0; }
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
