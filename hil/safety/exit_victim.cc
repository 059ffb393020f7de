// A program that pushes with an emulated device and then ends in the way it is told: what exits_test kills.
// usage: exit_victim FILE WAY GUARD   (guard: guardian, scope, none)
#include <poll.h>
#include <sys/resource.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <memory>
#include <stdexcept>
#include <string>

#include "emulators/haptic_emulator.h"
#include "safety/force_supervisor.h"
#include "safety/guardian.h"
#include "safety/stop_signal.h"

namespace {

using namespace touchstone;
using namespace touchstone::hil;

void end(const std::string& way) {
  if (way == "exception" || way == "uncaught exception") throw std::runtime_error(way);
  if (way == "exit") std::exit(0);
  if (way == "abort") std::abort();
  if (way == "SEGV") std::signal(SIGSEGV, SIG_DFL), std::raise(SIGSEGV);
  if (way == "SIGKILL") std::raise(SIGKILL);
  if (way == "hung loop") {
    for (volatile bool forever = true; forever;) {
    }
  }
}

GuardOptions guard_options(const std::string& way) {
  GuardOptions options;
  options.limits.force_N = 2.0;
  options.limits.workspace_W_m = Box3(Vec3::Constant(-0.1), Vec3::Constant(0.1));
  // A busy machine is not what is tried here: only the hung loop is to be noticed by its silence.
  options.limits.stale_s = way == "hung loop" ? 0.02 : 1.0;
  options.driver_timeout_s = options.idle_timeout_s = options.watchdog_s = 1.0;
  return options;
}

void push(HapticDevice& device, const std::string& way, bool guarded) {
  std::unique_ptr<ForceGuard> guard;
  if (guarded) guard = std::make_unique<ForceGuard>(device);
  std::unique_ptr<StopSignal> stop;
  if (guarded) stop = std::make_unique<StopSignal>();
  SafetyLimits limits;
  limits.force_N = 2.0;
  limits.workspace_W_m = Box3(Vec3::Constant(-0.1), Vec3::Constant(0.1));
  limits.stale_s = 10.0;  // a busy machine is not what is tried here
  ForceSupervisor supervisor(limits);
  MonotonicClock clock;
  ForceSupervisor::Input input;
  input.calibrated = input.dead_man_held = true;
  input.wanted_W_N = Vec3(0, 0, 1);
  input.state.t_s = clock.now_s();
  // Until the test has seen it push and says so on standard input; where it ends by a signal, until that comes.
  const bool waits_for_signal = way == "SIGINT" || way == "SIGTERM";
  pollfd told{STDIN_FILENO, POLLIN, 0};
  for (double t = clock.now_s(); waits_for_signal || ::poll(&told, 1, 0) == 0; t += 1e-3) {
    if (stop && stop->asked()) return;
    input.now_s = clock.now_s();
    input.state = device.exchange(supervisor.allow(input), clock.now_s() + 5.0);
    clock.sleep_until(t + 1e-3);
  }
  end(way);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 4) return 2;
  const rlimit no_core{0, 0};
  setrlimit(RLIMIT_CORE, &no_core);
  const std::string file = argv[1], way = argv[2], guard = argv[3];
  // Outlives main's frames where the guard is only the scope's: leaked on purpose, so that no destructor helps.
  HapticDevice* const device =
      guard == "guardian" ? open_guarded([&] { return open_emulated_haptic(file); }, guard_options(way)).release()
                          : open_emulated_haptic(file).release();
  if (way == "uncaught exception") {
    push(*device, way, guard != "none");
    return 0;
  }
  try {
    push(*device, way, guard != "none");
  } catch (const std::runtime_error&) {
    return 1;
  }
  return 0;
}
