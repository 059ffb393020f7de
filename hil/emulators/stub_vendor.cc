// A library with the functions of Force Dimension's libdhd and 3D Systems' libHD that the drivers call, and a device
// behind both: it stands at (10, 20, 30) mm and remembers the force. touchstone_stub_fault() sets what is wrong with
// it. It encodes our reading of the vendors' documentation and proves nothing about their devices.
#include <atomic>
#include <chrono>
#include <thread>

namespace {

enum Fault { none, absent, fails, uncalibrated, out_of_inkwell };
std::atomic<int> fault{none};  // the servo thread reads it while a test sets it
std::atomic<double> force[3], set[3];
std::atomic<int> watchdog_periods{0}, forces_on{0}, reset_done{1};
std::atomic<bool> scheduling{false};
std::thread scheduler;
std::atomic<unsigned (*)(void*)> job{nullptr};
std::atomic<void*> job_data{nullptr};

struct HdError {
  unsigned code;
  int internal;
  unsigned device;
};

}  // namespace

extern "C" {
int dhdOpen() { return fault == absent ? -1 : 0; }
int dhdClose(char) { return 0; }
int dhdGetSerialNumber(unsigned short* number, char) {
  *number = 4711;
  return 0;
}
int dhdEnableForce(unsigned char on, char) {
  forces_on = on;
  return 0;
}
int dhdSetForce(double x, double y, double z, char) {
  if (fault == fails) return -1;
  force[0] = x, force[1] = y, force[2] = z;
  return 0;
}
int dhdGetPosition(double* x, double* y, double* z, char) {
  *x = 0.01, *y = 0.02, *z = 0.03;
  return 0;
}
int dhdGetLinearVelocity(double* x, double* y, double* z, char) {
  *x = 0.1, *y = 0.0, *z = 0.0;
  return 0;
}
int dhdGetButton(int, char) { return 1; }
int dhdSetWatchdog(unsigned char periods, char) {
  watchdog_periods = periods;
  return 0;
}
// dhdc.h: DHD_STATUS_POWER 0, CONNECTED 1, STARTED 2, RESET 3, ..., ERROR 9; DHD_MAX_STATUS 17 in version 3.14.
int dhdGetStatus(int* status, char) {
  for (int i = 0; i < 17; ++i) status[i] = 0;
  status[0] = status[1] = status[2] = 1;
  status[3] = reset_done;
  return 0;
}
const char* dhdErrorGetLastStr() { return "stub error"; }

unsigned hdInitDevice(const char*) { return 1; }
void hdDisableDevice(unsigned) {}
void hdEnable(unsigned) { forces_on = 1; }
void hdDisable(unsigned) { forces_on = 0; }
void hdStartScheduler() {
  scheduling = true;
  scheduler = std::thread([] {
    while (scheduling) {
      if (const auto now = job.load(); now != nullptr && fault != fails) now(job_data);
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
  });
}
void hdStopScheduler() {
  scheduling = false;
  if (scheduler.joinable()) scheduler.join();
}
unsigned long hdScheduleAsynchronous(unsigned (*callback)(void*), void* data, unsigned short) {
  job_data = data, job = callback;
  return 1;
}
void hdUnschedule(unsigned long) { job = nullptr; }
void hdBeginFrame(unsigned) {}
// HDAPI: what hdSetDoublev set reaches the motors when the frame ends.
void hdEndFrame(unsigned) {
  for (int k = 0; k < 3; ++k) force[k] = set[k].load();
}
void hdGetDoublev(unsigned what, double* v) {
  const bool position = what == 0x2050;
  v[0] = position ? 10 : 100, v[1] = position ? 20 : 0, v[2] = position ? 30 : 0;
}
void hdGetIntegerv(unsigned what, int* v) { *v = what == 0x2555 ? 4 : 3; }  // inkwell; both buttons
void hdSetDoublev(unsigned, const double* v) {
  for (int k = 0; k < 3; ++k) set[k] = v[k];
}
const char* hdGetString(unsigned) { return "STUB-4712"; }
HdError hdGetError() { return {fault == absent ? 0x0301U : 0U, 0, 1}; }
// hdDefines.h: OK 0x5000, NEEDS_UPDATE 0x5001, NEEDS_MANUAL_INPUT 0x5002 (its value as C# and Python bindings repeat
// it; phantom_omni and others then ask for the stylus in the inkwell). The public drivers call hdUpdateCalibration() in
// the servo callback while it needs an update (OpenHaptics' Calibration example; phantom_omni of ROS).
unsigned hdCheckCalibration() { return fault == uncalibrated ? 0x5001 : fault == out_of_inkwell ? 0x5002 : 0x5000; }
void hdUpdateCalibration(unsigned style) {
  if (style == 4 && fault == uncalibrated) fault = none;
}

// For the tests: "absent", "fails" (the servo thread stops), "uncalibrated", "out of inkwell", or "" for a sound
// device; and what it applies.
void touchstone_stub_fault(const char* name) {
  fault = name[0] == 'a'   ? absent
          : name[0] == 'f' ? fails
          : name[0] == 'u' ? uncalibrated
          : name[0] == 'o' ? out_of_inkwell
                           : none;
}
int touchstone_stub_forces_on() { return forces_on; }
void touchstone_stub_force(double* f) {
  for (int k = 0; k < 3; ++k) f[k] = force[k];
}
void touchstone_stub_reset_done(int done) { reset_done = done; }
int touchstone_stub_watchdog_periods() { return watchdog_periods; }
}
